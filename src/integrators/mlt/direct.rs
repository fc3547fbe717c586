//! Light that the camera sees directly: paths of one edge, which chains leave out.

use ajar_render::{
    film::RoundFilm,
    math::Rgb,
    path::Vertex,
    rng::{Purpose, Rng},
};
use glam::DVec2;
use rayon::prelude::*;

use super::path::Space;

/// Adds `samples` eye rays a pixel, each counting `scale`/`samples`.
pub fn render(space: &Space<'_>, (seed, round): (u64, u32), samples: u32, film: &RoundFilm) {
    let (window, world) = (space.window, space.world);
    (window.y0..window.y1).into_par_iter().for_each(|y| {
        if space.cancelled() {
            return;
        }
        for x in window.x0..window.x1 {
            let pixel = u64::from(y) * u64::from(world.camera.width) + u64::from(x);
            let mut rng = Rng::new(seed, Purpose::Direct, round, pixel);
            let mut sum = Rgb::ZERO;
            for _ in 0..samples {
                let [dx, dy] = rng.pair();
                sum += seen(space, DVec2::new(f64::from(x) + dx, f64::from(y) + dy), &mut rng);
            }
            if let Some(index) = window.index(x, y).filter(|_| sum != Rgb::ZERO) {
                film.add(index, sum / f64::from(samples));
            }
        }
    });
}

fn seen(space: &Space<'_>, raster: DVec2, rng: &mut Rng) -> Rgb {
    let world = space.world;
    let ray = world.camera.ray(raster, rng.pair());
    let seed = rng.next_u32();
    let seen = world.trace(ray.origin, ray.direction, true, seed);
    let Some(x0) = seen.or_else(|| world.lights.surroundings(ray.direction)) else { return Rgb::ZERO };
    if x0.emitter == Vertex::NO_EMITTER { Rgb::ZERO } else { world.emitted(&x0, -ray.direction) }
}
