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
