//! Who cancels a render does not wait for it.

mod common;

use std::sync::atomic::AtomicBool;

use ajar_integrators::{Context, Settings, Window, integrators};
use ajar_render::{film::Film, math::Rgb};
use common::{Builder, pinhole, shapes};
use glam::{DVec3, Vec3};

/// Pixels on a side: a round that is not cancelled takes minutes.
const SIDE: u32 = 2048;

#[test]
fn nothing_is_rendered_once_it_is_cancelled() {
    let mut b = Builder::default();
    let (white, lamp) = (b.diffuse(Vec3::splat(0.7)), b.emitter(Vec3::splat(5.0)));
    b.mesh(shapes::cuboid(Vec3::splat(-1.0), Vec3::splat(1.0), true), white);
    b.mesh(shapes::quad(Vec3::new(-0.3, 0.9, -0.3), Vec3::X * 0.6, Vec3::Z * 0.6), lamp);
    b.camera(pinhole(1.2), DVec3::new(0.0, 0.1, 0.95), DVec3::ZERO);
    let world = b.world(SIDE);
    let window = Window { x0: 0, y0: 0, x1: SIDE, y1: SIDE };
    let settings =
        Settings { seed: 1, max_depth: 8, samples_per_round: 256, window, metropolis: Default::default() };
    let cancel = AtomicBool::new(true);
    for integrator in integrators() {
        let rounds = integrator.prepare(Context { world: &world, settings: &settings, cancel: &cancel });
        let mut film = Film::new(window.pixels(), 1.0);
        let round = film.round();
        rounds.render(0, &round);
        film.merge(&round, rounds.scale());
        let lit = (0..film.pixels()).filter(|&pixel| film.mean(pixel) != Rgb::ZERO).count();
        assert_eq!(lit, 0, "{}", integrator.name());
    }
}
