//! Symmetric kernels that perturbations draw from.

use std::f64::consts::{PI, TAU};

use ajar_render::{math::Frame, rng::Rng};
use glam::{DVec2, DVec3};

use super::path::Space;

/// Least raster offset r₁, pixels (Veach & Guibas 1997 §4.3.1).
const LEAST_PIXELS: f64 = 0.1;
/// The largest one, r₂, as the radius of a disc of this part of the image.
const LARGEST_AREA: f64 = 0.05;
/// Range of direction offsets θ₁ … θ₂, radians (Veach & Guibas 1997 §4.3.2).
const ANGLES: [f64; 2] = [1e-4, 0.1];
/// Range of offsets in the unit square of a sampler (Kelemen et al. 2002).
const UNIT: [f64; 2] = [1.0 / 1024.0, 1.0 / 64.0];

/// A number whose logarithm is uniform between those of the bounds.
fn log_uniform([least, largest]: [f64; 2], u: f64) -> f64 {
    largest * (-(largest / least).ln() * u).exp()
}

/// Offset of a raster position, pixels; the density depends on the distance alone.
pub fn raster_offset(space: &Space<'_>, rng: &mut Rng) -> DVec2 {
    let largest = (LARGEST_AREA * space.window.pixels() as f64 / PI).sqrt().max(2.0 * LEAST_PIXELS);
    offset_within(largest, rng)
}

fn offset_within(largest: f64, rng: &mut Rng) -> DVec2 {
    let r = log_uniform([LEAST_PIXELS, largest], rng.f64());
    DVec2::from_angle(TAU * rng.f64()) * r
}

/// `direction` turned by a random angle; the density depends on the angle alone.
pub fn turn(direction: DVec3, rng: &mut Rng) -> DVec3 {
    let (sin, cos) = log_uniform(ANGLES, rng.f64()).sin_cos();
    let (s, c) = (TAU * rng.f64()).sin_cos();
    Frame::from_z(direction).to_world(DVec3::new(sin * c, sin * s, cos)).normalize()
}

/// A point of the unit torus near `u`; the density depends on the offset's size alone.
pub fn unit_offset(u: [f64; 2], rng: &mut Rng) -> [f64; 2] {
    u.map(|x| {
        let size = log_uniform(UNIT, rng.f64());
        let moved = if rng.f64() < 0.5 { x + size } else { x - size };
        let wrapped = moved - moved.floor();
        if wrapped < 1.0 { wrapped } else { 0.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ajar_render::rng::Purpose;
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    const DRAWS: usize = 200_000;

    /// Fails unless `counts` look like equal chances: at a level of 10⁻⁵.
    fn assert_uniform(what: &str, counts: &[f64]) {
        let expected = DRAWS as f64 / counts.len() as f64;
        let chi: f64 = counts.iter().map(|c| (c - expected).powi(2) / expected).sum();
        let p = 1.0 - ChiSquared::new(counts.len() as f64 - 1.0).expect("positive").cdf(chi);
        assert!(p > 1e-5, "{what}: χ² {chi} for {} cells", counts.len());
    }

    /// Counts of pairs of numbers in [0, 1) in a grid of 8 × 16 cells.
    fn grid(mut draw: impl FnMut(&mut Rng) -> [f64; 2]) -> Vec<f64> {
        let mut rng = Rng::new(1, Purpose::Test, 0, 0);
        let mut counts = vec![0.0; 128];
        for _ in 0..DRAWS {
            let [a, b] = draw(&mut rng);
            assert!((0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b), "{a} {b}");
            counts[((a * 8.0) as usize).min(7) * 16 + ((b * 16.0) as usize).min(15)] += 1.0;
        }
        counts
    }

    /// Where the logarithm of `x` lies between those of the bounds.
    fn place([least, largest]: [f64; 2], x: f64) -> f64 {
        ((x / least).ln() / (largest / least).ln()).clamp(0.0, 1.0)
    }

    fn turns(angle: f64) -> f64 {
        (angle / TAU).rem_euclid(1.0)
    }

    #[test]
    fn offsets_in_the_image_have_log_uniform_lengths_and_any_direction() {
        let bounds = [LEAST_PIXELS, 9.0];
        let counts = grid(|rng| {
            let offset = offset_within(9.0, rng);
            [place(bounds, offset.length()), turns(offset.to_angle())]
        });
        assert_uniform("raster", &counts);
    }

    #[test]
    fn turned_directions_have_log_uniform_angles_all_around() {
        let w = DVec3::new(0.6, -0.48, 0.64);
        let frame = Frame::from_z(w);
        let counts = grid(|rng| {
            let local = frame.to_local(turn(w, rng));
            let angle = local.truncate().length().atan2(local.z);
            [place(ANGLES, angle), turns(local.y.atan2(local.x))]
        });
        assert_uniform("turn", &counts);
    }

    #[test]
    fn offsets_in_the_unit_square_are_symmetric_with_log_uniform_sizes() {
        let counts = grid(|rng| {
            let [x, _] = unit_offset([0.99, 0.5], rng);
            let offset = (x - 0.99 + 0.5).rem_euclid(1.0) - 0.5;
            [place(UNIT, offset.abs()), if offset < 0.0 { 0.25 } else { 0.75 }]
        });
        let halves: Vec<f64> =
            counts.chunks(16).flat_map(|row| [row[..8].iter().sum::<f64>(), row[8..].iter().sum()]).collect();
        assert_uniform("unit square", &halves);
    }
}
