//! The brightness that the film counts in, found before the first round.

use ajar_render::{World, math::scalar, sampler::Sequence};
use glam::DVec2;
use rayon::prelude::*;

use crate::path::radiance;

/// Eye paths of the pilot.
const SAMPLES: u32 = 4096;
/// Its stream of samples, which no image uses.
const STREAM: u32 = u32::MAX;

/// Rough mean brightness of the image, from a few thousand eye paths; 1 if they find no light. It only sets the unit of
/// the film's integers, so that it matters for rounding alone.
pub fn brightness(world: &World, max_depth: usize) -> f64 {
    let (width, height) = (f64::from(world.camera.width), f64::from(world.camera.height));
    let sequence = Sequence::new(0, STREAM, 0);
    let found: Vec<f64> = (0..SAMPLES)
        .into_par_iter()
        .map(|sample| {
            let mut sampler = sequence.sample(sample.into());
            let [u, v] = sampler.next_2d();
            scalar(radiance(world, max_depth, DVec2::new(u * width, v * height), &mut sampler))
        })
        .collect();
    let finite = found.iter().copied().filter(|b| b.is_finite() && *b > 0.0);
    let mean = finite.sum::<f64>() / f64::from(SAMPLES);
    if mean > 0.0 { mean } else { 1.0 }
}
