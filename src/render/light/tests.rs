//! Light ends and directions of emission against their densities, and powers against what is emitted.

#![allow(clippy::unwrap_used, reason = "a failing test panics")]

use std::f64::consts::{FRAC_1_PI, PI};

use super::*;
use crate::{
    chi2::{DISC_CELLS, TRIANGLE_CELLS, cell, disc_cell, integrals, p_value, p_value_of_even, triangle_cell},
    math::scalar,
    rng::{Purpose, Rng},
};

const POINT: usize = 0;
const SPOT: usize = 1;
const DIRECTIONAL: usize = 2;
const SURROUNDINGS: usize = 3;
const ONE_SIDED: usize = 4;
const TWO_SIDED: usize = 5;
const SAMPLES: u32 = 200_000;
const RADIUS: f64 = 3.0;

fn direction(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z).normalize()
}

fn triangle(vertices: [DVec3; 3], both_sides: bool, brightness: f64) -> TriangleLight {
    let cross = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]);
    let (normal, area) = (cross.normalize(), 0.5 * cross.length());
    TriangleLight { instance: 0, triangle: 0, vertices, normal, area, rounding: 0.0, both_sides, brightness }
}

/// One emitter of each kind, all of similar power.
fn lights() -> Lights {
    let spot = DiracLight::Spot {
        position: DVec3::ONE,
        frame: Frame::from_z(direction(1.0, -2.0, 0.5)),
        intensity: Rgb::new(60.0, 20.0, 40.0),
        inner: 0.9,
        outer: 0.4,
    };
    let dirac = vec![
        DiracLight::Point { position: DVec3::X, intensity: Rgb::splat(8.0) },
        spot,
        DiracLight::Directional { to_light: direction(-1.0, 3.0, 0.2), illuminance: Rgb::new(1.0, 2.0, 3.0) },
    ];
    let mut environment = Environment::default();
    environment.add_uniform(Rgb::splat(0.5));
    environment.add_sun(direction(0.2, 0.5, -1.0), 1.5, Rgb::splat(1.0));
    let triangles = vec![
        triangle([DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 3.0], false, 5.0),
        triangle([DVec3::ZERO, DVec3::new(0.5, 1.0, 2.0), DVec3::Z], true, 20.0),
    ];
    Lights::new(dirac, Some(environment.into()), triangles, (DVec3::new(0.5, 0.5, 0.0), RADIUS))
}

fn rng(seed: u64) -> Rng {
    Rng::new(seed, Purpose::Test, 0, 0)
}

/// Barycentric weights of a point of the triangle, by the areas that it cuts off.
fn weights(triangle: &TriangleLight, p: DVec3) -> [f64; 2] {
    let [a, b, c] = triangle.vertices;
    let twice = |u: DVec3, v: DVec3| u.cross(v).dot(triangle.normal);
    [twice(p - a, c - a), twice(b - a, p - a)].map(|area| area / (2.0 * triangle.area))
}

/// A light end of this emitter.
fn end(lights: &Lights, emitter: usize, rng: &mut Rng) -> Vertex {
    loop {
        let (vertex, _) = lights.sample(rng.f64(), rng.pair()).unwrap();
        if vertex.emitter == emitter as u32 {
            return vertex;
        }
    }
}

#[test]
fn light_ends_follow_their_density() {
    let lights = lights();
    let n = f64::from(SAMPLES);
    let places = [1, 1, 1, integrals(&|_| 0.0).len(), TRIANGLE_CELLS, TRIANGLE_CELLS];
    let mut counts = places.map(|cells| vec![0.0; cells]);
    let mut rng = rng(1);
    for _ in 0..SAMPLES {
        let (x0, density) = lights.sample(rng.f64(), rng.pair()).unwrap();
        assert!((lights.density(&x0) / density - 1.0).abs() < 1e-9);
        let place = match x0.kind {
            Kind::Environment => cell(x0.p),
            Kind::Surface => triangle_cell(weights(lights.triangle(x0.emitter).unwrap(), x0.p)),
            _ => 0,
        };
        counts[x0.emitter as usize][place] += 1.0;
    }
    let dome = integrals(&|direction| {
        let at = lights.surroundings(direction).unwrap();
        lights.density(&at)
    });
    let mut expected: Vec<Vec<f64>> = vec![Vec::new(); counts.len()];
    for emitter in [POINT, SPOT, DIRECTIONAL] {
        expected[emitter] = vec![lights.density(&end(&lights, emitter, &mut rng))];
    }
    expected[SURROUNDINGS] = dome;
    for emitter in [ONE_SIDED, TWO_SIDED] {
        let x0 = end(&lights, emitter, &mut rng);
        let area = lights.triangle(x0.emitter).unwrap().area;
        expected[emitter] = vec![lights.density(&x0) * area / TRIANGLE_CELLS as f64; TRIANGLE_CELLS];
    }
    let total: f64 = expected.iter().flatten().sum();
    assert!((total - 1.0).abs() < 1e-3, "{total}");
    let p = p_value(expected.concat().into_iter().map(|p| p * n).zip(counts.concat()));
    assert!(p > 1e-4, "{p}");
    let sums = |cells: &[Vec<f64>]| cells.iter().map(|cells| cells.iter().sum()).collect::<Vec<f64>>();
    let choices = sums(&expected).into_iter().map(|p| p * n).zip(sums(&counts));
    let p = p_value(choices.clone());
    assert!(p > 1e-4, "{p}");
    // Teeth: one light 5 % too likely.
    let wrong = choices.enumerate().map(|(i, (e, c))| (if i == SPOT { 1.05 * e } else { e }, c));
    assert!(p_value(wrong) < 1e-4);
    // Teeth: a triangle whose first corner gets a little too much.
    for emitter in [ONE_SIDED, TWO_SIDED] {
        let p = p_value_of_even(TRIANGLE_CELLS, SAMPLES / 10, || {
            let x0 = end(&lights, emitter, &mut rng);
            triangle_cell(weights(lights.triangle(x0.emitter).unwrap(), x0.p).map(|b| b.powf(1.1)))
        });
        assert!(p < 1e-4, "{emitter}: {p}");
    }
}

/// p-value of directions of emission from an end, against a density.
fn directions(lights: &Lights, x0: &Vertex, density: &dyn Fn(DVec3) -> f64) -> f64 {
    let mut rng = rng(2);
    let expected = integrals(density);
    let total: f64 = expected.iter().sum();
    assert!((total - 1.0).abs() < 2e-3, "{total}");
    let mut counts = vec![0.0; expected.len()];
    for _ in 0..SAMPLES {
        let emission = lights.emit(x0, rng.pair(), rng.f64()).unwrap();
        assert!((lights.emit_density(x0, emission.direction) / emission.density - 1.0).abs() < 1e-9);
        assert_eq!(emission.origin, x0.p);
        counts[cell(emission.direction)] += 1.0;
    }
    p_value(expected.into_iter().map(|p| p * f64::from(SAMPLES)).zip(counts))
}

#[test]
fn directions_of_emission_follow_their_density() {
    let lights = lights();
    for emitter in [POINT, SPOT, ONE_SIDED, TWO_SIDED] {
        let x0 = end(&lights, emitter, &mut rng(3));
        let p = directions(&lights, &x0, &|w| lights.emit_density(&x0, w));
        assert!(p > 1e-4, "{emitter}: {p}");
    }
    // Teeth: a lobe slightly too narrow.
    let x0 = end(&lights, ONE_SIDED, &mut rng(3));
    let narrow = |w: DVec3| x0.ng.dot(w).max(0.0).powf(1.1) * 1.05 * FRAC_1_PI;
    assert!(directions(&lights, &x0, &narrow) < 1e-4);
}

#[test]
fn distant_light_falls_evenly_through_a_disc() {
    let lights = lights();
    for emitter in [DIRECTIONAL, SURROUNDINGS] {
        let mut rng = rng(4);
        let x0 = end(&lights, emitter, &mut rng);
        let frame = Frame::from_z(x0.p);
        let mut on_disc = || {
            let emission = lights.emit(&x0, rng.pair(), rng.f64()).unwrap();
            let from_centre = frame.to_local(emission.origin - lights.centre);
            // Outside the sphere around the scene, towards it, within its silhouette.
            assert!(from_centre.z > RADIUS && emission.direction == -x0.p);
            let on_disc = from_centre.truncate() / RADIUS;
            assert!(on_disc.length() < 1.0 + 1e-12);
            assert!((emission.density * PI * RADIUS * RADIUS - 1.0).abs() < 1e-12);
            on_disc
        };
        let p = p_value_of_even(DISC_CELLS, SAMPLES, || disc_cell(on_disc()));
        assert!(p > 1e-4, "{emitter}: {p}");
        // Teeth: a little too much light in the middle.
        let p = p_value_of_even(DISC_CELLS, SAMPLES, || {
            let p = on_disc();
            disc_cell(p * p.length().powf(0.05))
        });
        assert!(p < 1e-4, "{emitter}: {p}");
    }
}

#[test]
fn emitters_are_chosen_by_the_light_they_emit() {
    let lights = lights();
    let intensity =
        |emitter: usize| integrals(&|w| scalar(lights.dirac[emitter].emission(w))).iter().sum::<f64>();
    let disc = PI * RADIUS * RADIUS;
    let environment = lights.environment().unwrap();
    let flux = [
        intensity(POINT),
        intensity(SPOT),
        2.0 * disc,
        integrals(&|w| scalar(environment.radiance(w))).iter().sum::<f64>() * disc,
        PI * 5.0 * 3.0,
        PI * 20.0 * lights.triangles[1].area * 2.0,
    ];
    let total: f64 = flux.iter().sum();
    for (emitter, flux) in flux.into_iter().enumerate() {
        let chance = lights.choice.pmf(emitter);
        assert!((chance / (flux / total) - 1.0).abs() < 2e-3, "{emitter}: {chance}, flux {flux} of {total}");
    }
}
