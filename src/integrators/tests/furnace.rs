//! Scenes whose radiance is known exactly.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use ajar_integrators::{Integrator, integrators};
use ajar_render::math::Rgb;
use ajar_scene::{Input, LightKind, Material};
use common::{Builder, diffuse, pinhole, render, settings, shapes};
use glam::{DVec3, Vec3};

/// Mean of the whole image and its standard error.
fn mean(film: &ajar_render::film::Film) -> (Rgb, Rgb) {
    let n = film.pixels() as f64;
    let (mut mean, mut variance) = (Rgb::ZERO, Rgb::ZERO);
    for p in 0..film.pixels() {
        mean += film.mean(p) / n;
        variance += film.variance_of_mean(p) / (n * n);
    }
    (mean, variance.powf(0.5))
}

fn assert_mean(name: &str, integrator: &dyn Integrator, film: &ajar_render::film::Film, expected: f64) {
    let (found, error) = mean(film);
    println!("{name}, {}: {found} ± {error}, expected {expected}", integrator.name());
    let worst = ((found - expected).abs() / (4.0 * error + 1e-4 * expected)).max_element();
    assert!(worst < 1.0, "{name}, {}: {found} ± {error}, expected {expected}", integrator.name());
}

/// A closed box of albedo ρ that shines E everywhere: after k edges the radiance is E (1 + ρ + … + ρ^{k−1}).
#[test]
fn closed_box_that_shines() {
    let (albedo, depth) = (0.6, 7);
    let mut b = Builder::default();
    let wall =
        b.material(Material { emission: Input::constant(Vec3::ONE), ..diffuse(Vec3::splat(albedo as f32)) });
    b.mesh(shapes::cuboid(Vec3::splat(-1.0), Vec3::splat(1.0), true), wall);
    b.camera(pinhole(1.2), DVec3::new(0.1, -0.2, 0.3), DVec3::new(1.0, 0.4, -0.2));
    let world = b.world(16);
    let expected = (1.0 - f64::powi(albedo, depth)) / (1.0 - albedo);
    for integrator in integrators() {
        let film = render(&world, *integrator, &settings(&world, 1, depth as usize, 32), 16);
        assert_mean("box", *integrator, &film, expected);
    }
}

/// Lossless objects under a uniform sky are invisible, whatever they are made of.
#[test]
fn lossless_objects_vanish_under_a_uniform_sky() {
    let glass = |roughness: f32, thin_walled| Material {
        base_color: Input::constant(Vec3::ONE),
        transmission: Input::constant(1.0),
        roughness: Input::constant(roughness),
        thin_walled,
        ..Material::default()
    };
    let metal = |roughness: f32| Material {
        base_color: Input::constant(Vec3::ONE),
        metallic: Input::constant(1.0),
        roughness: Input::constant(roughness),
        ..Material::default()
    };
    let materials = [
        ("white diffuse", diffuse(Vec3::ONE)),
        ("mirror", metal(0.0)),
        ("rough metal", metal(0.6)),
        ("smooth glass", glass(0.0, false)),
        ("rough glass", glass(0.5, false)),
        ("bubble", glass(0.0, true)),
        ("white plastic", Material { base_color: Input::constant(Vec3::ONE), ..Material::default() }),
    ];
    for (name, material) in materials {
        let mut b = Builder::default();
        let m = b.material(material);
        b.mesh(shapes::sphere(Vec3::new(-0.6, 0.0, 0.0), 0.5, 12, true), m);
        b.mesh(shapes::sphere(Vec3::new(0.6, 0.1, 0.2), 0.4, 12, false), m);
        b.light(LightKind::Environment { radiance: 1.0, texture: None }, DVec3::ZERO, DVec3::NEG_Z);
        b.camera(pinhole(0.8), DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO);
        let world = b.world(16);
        for integrator in integrators() {
            let film = render(&world, *integrator, &settings(&world, 1, 48, 16), 16);
            let (found, error) = mean(&film);
            println!("{name}, {}: {found} ± {error}", integrator.name());
            // Compensation tables conserve energy to half a percent; smooth normals on coarse spheres lose some at the
            // silhouette, where shading and geometric normal disagree.
            let worst = ((found - 1.0).abs() - 4.0 * error).max_element();
            assert!(worst < 0.01, "{name}, {}: {found} ± {error}", integrator.name());
        }
    }
}
