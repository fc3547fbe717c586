//! The same bytes, whatever the number of threads and however the film is cut.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use ajar_integrators::{Integrator, Settings, Window, integrators, mlt::Ajar, path::PathTracer};
use ajar_render::World;
use ajar_scene::{Input, Material};
use common::{Builder, pinhole, render, scenes::IMAGES, settings, shapes};
use glam::{DVec3, Vec3};

fn world() -> World {
    let mut b = Builder::default();
    let white = b.diffuse(Vec3::splat(0.7));
    let glass = b.material(Material {
        transmission: Input::constant(1.0),
        roughness: Input::constant(0.0),
        ..Material::default()
    });
    let lamp = b.emitter(Vec3::splat(5.0));
    b.mesh(shapes::cuboid(Vec3::splat(-1.0), Vec3::splat(1.0), true), white);
    b.mesh(shapes::sphere(Vec3::new(0.2, -0.5, -0.1), 0.4, 8, true), glass);
    b.mesh(shapes::quad(Vec3::new(-0.3, 0.9, -0.3), Vec3::X * 0.6, Vec3::Z * 0.6), lamp);
    b.camera(pinhole(1.2), DVec3::new(0.0, 0.1, 0.95), DVec3::ZERO);
    b.world(24)
}

/// All of them, the default also with chains where it would do without.
fn every_integrator() -> impl Iterator<Item = &'static dyn Integrator> {
    integrators().iter().copied().chain([&Ajar { always: true } as &dyn Integrator])
}

#[test]
fn thread_counts_give_the_same_bits() {
    for world in [world(), (IMAGES.world)()] {
        let settings = settings(&world, 7, 8, 4);
        for integrator in every_integrator() {
            let films = [1, 2, 7].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| render(&world, integrator, &settings, 3))
            });
            assert!(films.iter().all(|film| *film == films[0]), "{}", integrator.name());
        }
    }
}

#[test]
fn seeds_and_rounds_differ() {
    let world = world();
    for integrator in every_integrator() {
        let film = |seed, rounds| render(&world, integrator, &settings(&world, seed, 8, 1), rounds);
        assert_ne!(film(1, 1), film(2, 1), "{}", integrator.name());
        let two = film(1, 2);
        let variances: f64 = (0..two.pixels()).map(|p| two.variance_of_mean(p).x).sum();
        assert!(variances > 0.0, "{}: rounds are copies", integrator.name());
    }
}

#[test]
fn a_crop_shows_the_same_pixels() {
    let world = world();
    let whole = settings(&world, 7, 8, 4);
    let part = Settings { window: Window { x0: 5, y0: 3, x1: 17, y1: 20 }, ..whole.clone() };
    let (a, b) = (render(&world, &PathTracer, &whole, 2), render(&world, &PathTracer, &part, 2));
    for y in 3..20 {
        for x in 5..17 {
            let inside = part.window.index(x, y).unwrap();
            assert_eq!(a.mean((y * 24 + x) as usize), b.mean(inside), "{x}, {y}");
        }
    }
}
