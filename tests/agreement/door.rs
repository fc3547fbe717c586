//! How much of the lamp's light the door of `scenes/door-ajar` lets into the camera's room, by light paths.

use ajar_render::{
    World,
    math::scalar,
    path::Subpath,
    rng::{Purpose, Rng},
};
use glam::DVec3;
use rayon::prelude::*;

const BATCHES: u32 = 64;
const PATHS: u64 = 4000;
/// Roulette ends paths long before.
const MAX_VERTICES: usize = 1000;
/// What the scene's comment says.
const SHARE: f64 = 0.001;

/// Whether a point lies in the camera's room: before the wall, and not between it and the leaf (`generate.py`).
fn is_in_room(p: DVec3) -> bool {
    let behind_leaf = p.x > 0.45 && p.x < 1.31 && p.y < 2.05 && p.z < -2.05;
    p.z > -2.199 && !behind_leaf
}

/// Flux of light that comes into the room, for the first time, over that of the lamp, by some light paths.
fn share(world: &World, batch: u32) -> f64 {
    let mut path = Subpath::default();
    let flux = |sample| {
        path.trace_light(world, MAX_VERTICES, &mut Rng::new(1, Purpose::Test, batch, sample));
        path.stops.iter().find(|stop| is_in_room(stop.vertex.p)).map_or(0.0, |stop| scalar(stop.throughput))
    };
    (0..PATHS).map(flux).sum::<f64>() / (PATHS as f64 * world.lights.power())
}

#[test]
fn the_door_lets_in_as_much_light_as_its_scene_says() {
    let world = super::world("door-ajar");
    let shares: Vec<f64> = (0..BATCHES).into_par_iter().map(|batch| share(&world, batch)).collect();
    let n = f64::from(BATCHES);
    let mean = shares.iter().sum::<f64>() / n;
    let error = (shares.iter().map(|share| (share - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
    println!("{:.3} ± {:.3} % of the lamp's light come in", mean * 100.0, error * 100.0);
    assert!((mean / SHARE - 1.0).abs() < 0.1, "{mean} ± {error}");
}
