//! Every bidirectional technique alone estimates the same light (mlt.md §2.4 a), and the weights sum to one.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use ajar_integrators::bdpt::{Connector, Contribution};
use ajar_render::{
    World,
    math::scalar,
    path::Subpath,
    rng::{Purpose, Rng},
};
use ajar_scene::{Id, Input, LightKind, Material, Projection};
use common::{
    Builder, pinhole,
    scenes::{plaster, sky},
    shapes, sized,
};
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

const MAX_EDGES: usize = 5;
const BATCHES: usize = 64;
const SAMPLES: u64 = 16_000;
/// Relative standard error that a technique may have, by the number of edges: four of them are the faults that show.
const LARGEST_ERROR: [f64; MAX_EDGES + 1] = [0.0, 0.0, 0.01, 0.03, 0.06, 0.1];

/// Sums per number of edges and technique: alone, and weighted.
#[derive(Clone, Default)]
struct Sums {
    alone: [[f64; MAX_EDGES + 1]; MAX_EDGES + 1],
    weighted: [f64; MAX_EDGES + 1],
}

impl Sums {
    fn add(&mut self, s: usize, t: usize, found: Contribution) {
        let k = s + t - 1;
        self.alone[k][s] += scalar(found.value) / SAMPLES as f64;
        self.weighted[k] += scalar(found.weighted()) / SAMPLES as f64;
    }
}

fn batch(world: &World, batch: u64) -> Sums {
    let mut sums = Sums::default();
    let (mut eye, mut light, mut connector) =
        (Subpath::default(), Subpath::default(), Connector::new(world, 1.0));
    for sample in 0..SAMPLES {
        let mut rng = Rng::new(3, Purpose::Test, batch as u32, sample);
        let size = f64::from(world.camera.width);
        let ray = world.camera.ray(DVec2::new(rng.f64(), rng.f64()) * size, rng.pair());
        eye.trace_eye(world, world.lens_vertex(ray.origin), ray.direction, MAX_EDGES + 1, &mut rng);
        light.trace_light(world, MAX_EDGES, &mut rng);
        for t in 2..=eye.len() {
            sums.add(0, t, connector.hit(&eye, t));
            if t > MAX_EDGES {
                continue;
            }
            let (x0, density) = world.lights.sample(rng.f64(), rng.pair()).unwrap();
            sums.add(1, t, connector.next_event((&x0, density), (&eye, t), &mut rng));
            for s in 2..=light.len().min(MAX_EDGES + 1 - t) {
                sums.add(s, t, connector.connect((&light, s), (&eye, t), &mut rng));
            }
        }
        for s in 2..=light.len() {
            if let Some(splat) = connector.splat((&light, s), &mut rng) {
                sums.add(s, 1, splat.found);
            }
        }
    }
    sums
}

/// Mean over the batches and its standard error.
fn estimate(batches: &[Sums], value: impl Fn(&Sums) -> f64) -> (f64, f64) {
    let n = batches.len() as f64;
    let mean = batches.iter().map(&value).sum::<f64>() / n;
    let variance = batches.iter().map(|b| (value(b) - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Asserts that all techniques from s = `first` on find the same light, as far as can be told.
fn assert_same(name: &str, b: Builder, first: usize) {
    let world = b.world(16);
    let batches: Vec<Sums> = (0..sized(BATCHES) as u64).into_par_iter().map(|i| batch(&world, i)).collect();
    for (k, largest) in LARGEST_ERROR.into_iter().enumerate().skip(2) {
        let (reference, error) = estimate(&batches, |b| b.weighted[k]);
        assert!(reference > 0.0, "{name}, {k} edges");
        for s in 0..=k {
            let (mean, own_error) = estimate(&batches, |b| b.alone[k][s]);
            let what = format!("{name}, {k} edges, technique {s}");
            if s < first {
                assert_eq!(mean, 0.0, "{what} finds lights without extent");
                continue;
            }
            let z = (mean - reference) / error.hypot(own_error);
            println!("{what}: {mean:.5} ± {own_error:.5}, weighted {reference:.5} ± {error:.5}, z {z:.2}");
            // Of about 120 techniques, 4.5 standard errors are met by chance once in a thousand runs.
            assert!(z.abs() < 4.5, "{what}");
            assert!(own_error < largest * mean, "{what}: too noisy to tell");
        }
    }
}

/// A floor, two walls and a ball. Nothing touches: in corners 1/r² would give single techniques infinite variance.
fn stage() -> Builder {
    let mut b = Builder::default();
    let white = b.diffuse(Vec3::splat(0.7));
    walls(&mut b, white);
    b
}

fn walls(b: &mut Builder, material: Id<Material>) {
    let metal = b.material(Material {
        metallic: Input::constant(1.0),
        roughness: Input::constant(0.7),
        ..Material::default()
    });
    b.mesh(shapes::board(Vec3::new(-1.0, -1.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0), material);
    b.mesh(shapes::board(Vec3::new(-1.0, -0.5, -1.5), Vec3::X * 2.0, Vec3::Y * 1.5), material);
    b.mesh(shapes::board(Vec3::new(-1.5, -0.5, -1.0), Vec3::Y * 1.5, Vec3::Z * 2.0), material);
    b.mesh(shapes::sphere(Vec3::new(0.3, -0.2, 0.0), 0.4, 8, true), metal);
    b.camera(pinhole(0.9), DVec3::new(0.2, 0.1, 4.0), DVec3::ZERO);
}

fn lamp(b: &mut Builder) {
    let lamp = b.emitter(Vec3::splat(5.0));
    b.mesh(shapes::quad(Vec3::new(-0.8, 1.4, -0.8), Vec3::X * 1.6, Vec3::Z * 1.6), lamp);
}

#[test]
fn under_a_lamp() {
    let mut b = stage();
    lamp(&mut b);
    assert_same("lamp", b, 0);
}

#[test]
fn through_a_thin_lens() {
    let mut b = stage();
    lamp(&mut b);
    let lens =
        Projection::Perspective { yfov: 0.9, lens_radius: 0.2, focus_distance: 3.0, shift: [0.1, -0.05] };
    b.camera(lens, DVec3::new(0.2, 0.1, 4.0), DVec3::ZERO);
    assert_same("thin lens", b, 0);
}

#[test]
fn with_textures_and_normal_maps() {
    let mut b = Builder::default();
    let plaster = plaster(&mut b);
    walls(&mut b, plaster);
    lamp(&mut b);
    assert_same("normal maps", b, 0);
}

#[test]
fn under_the_sky() {
    for painted in [false, true] {
        let mut b = stage();
        let texture = painted.then(|| sky(&mut b));
        b.light(LightKind::Environment { radiance: 2.0, texture }, DVec3::ZERO, DVec3::NEG_Z);
        assert_same(if painted { "painted sky" } else { "even sky" }, b, 0);
    }
}

#[test]
fn under_a_wide_sun() {
    let mut b = stage();
    let (from, to) = (DVec3::new(0.5, 1.6, 1.4), DVec3::new(0.0, -0.5, -0.3));
    b.light(LightKind::Directional { illuminance: 5.0, angle: 0.9 }, from, to);
    assert_same("wide sun", b, 0);
}

#[test]
fn under_lights_without_extent() {
    let (from, to) = (DVec3::new(0.5, 1.6, 1.4), DVec3::new(0.0, -0.5, -0.3));
    for (name, kind) in [
        ("point light", LightKind::Point { intensity: 5.0 }),
        ("sun without extent", LightKind::Directional { illuminance: 5.0, angle: 0.0 }),
    ] {
        let mut b = stage();
        b.light(kind, from, to);
        assert_same(name, b, 1);
    }
}
