//! A latitude-longitude image around the scene.
//!
//! Pole +Y; seen from inside, the image's centre faces +Z and its left edge is at longitude +π, so that the right half
//! shows −X (UsdLux DomeLight, OpenEXR's latlong).

use std::f64::consts::{PI, TAU};

use ajar_scene::{Filter, Wrap};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::{
    distribution::Grid2d,
    math::{Rgb, scalar},
    texture::Texture,
};

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
/// Fewest cells along a side: inside a cell the density cannot follow sin θ, so coarse images need finer cells.
const FINEST: usize = 128;
/// Most cells along a side, to bound memory (64 MiB). Larger images have several texels a cell.
const COARSEST: [usize; 2] = [4096, 2048];

/// An image of the surroundings and the distribution that follows it.
#[derive(Clone, Debug)]
pub(super) struct Sky {
    texture: Texture,
    radiance: Rgb,
    world_from_light: DMat3,
    grid: Grid2d,
    flux: Rgb,
}

impl Sky {
    /// See [`super::Environment::add_image`]. `None` if the sky is black.
    pub(super) fn new(texture: Texture, radiance: Rgb, world_from_light: DMat3) -> Option<Self> {
        // Around horizontally, no further than the poles vertically.
        let texture = texture.wrapping(Wrap::Repeat, Wrap::Clamp);
        let (size, filter) = ([texture.bitmap().width(), texture.bitmap().height()], texture.filter());
        let [columns, rows] = [0, 1].map(|axis| size[axis].clamp(FINEST, COARSEST[axis]));
        let across = shares(columns, size[0], filter, |i| i.rem_euclid(size[0] as i64) as usize);
        let down = shares(rows, size[1], filter, |i| i.clamp(0, size[1] as i64 - 1) as usize);

        let cells: Vec<Vec<Rgb>> = (0..rows)
            .into_par_iter()
            .map(|row| {
                let angle = cell_solid_angle(row, rows, columns);
                let mut sums = vec![Rgb::ZERO; columns];
                for &(y, height) in &down[row] {
                    let texels: Vec<Rgb> = (0..size[0]).map(|x| color(&texture, x, y)).collect();
                    for (sum, across) in sums.iter_mut().zip(&across) {
                        *sum += across.iter().map(|&(x, width)| texels[x] * width).sum::<Rgb>() * height;
                    }
                }
                sums.into_iter().map(|sum| sum * radiance * angle).collect()
            })
            .collect();

        let weights: Vec<f64> = cells.iter().flatten().map(|&cell| scalar(cell)).collect();
        let flux = cells.into_iter().flatten().sum();
        Some(Self { texture, radiance, world_from_light, grid: Grid2d::new(columns, &weights)?, flux })
    }

    pub(super) fn radiance(&self, direction: DVec3) -> Rgb {
        let color = self.texture.at(self.coordinates(direction));
        positive(color.truncate().as_dvec3()) * self.radiance
    }

    pub(super) fn flux(&self) -> Rgb {
        self.flux
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let ([u, v], _) = self.grid.sample(u);
        let (sin, cos) = (PI * v).sin_cos();
        let (x, z) = (TAU * (0.5 - u)).sin_cos();
        self.world_from_light * DVec3::new(sin * x, cos, sin * z)
    }

    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let local = self.world_from_light.transpose() * direction;
        let sin = local.x.hypot(local.z);
        if sin == 0.0 {
            return 0.0;
        }
        self.grid.pdf(self.coordinates(direction)) / (2.0 * PI * PI * sin)
    }

    pub(super) fn invert(&self, direction: DVec3) -> Option<[f64; 2]> {
        self.grid.invert(self.coordinates(direction))
    }

    /// Where a direction lies in the image, in [0, 1)².
    fn coordinates(&self, direction: DVec3) -> [f64; 2] {
        let local = self.world_from_light.transpose() * direction;
        let polar = local.x.hypot(local.z).atan2(local.y);
        // Longitude atan2(x, z) falls from +π at the left edge, where (−x, −z) is on the axis.
        [turn(local.x, -local.z), (polar / PI).min(BELOW_ONE)]
    }
}

/// Texel colours as the sky shows them: never negative.
fn color(texture: &Texture, x: usize, y: usize) -> Rgb {
    positive(texture.texel(x, y).truncate().as_dvec3())
}

fn positive(color: Rgb) -> Rgb {
    color.max(Rgb::ZERO)
}

/// Angle of (x, y) from the x axis in turns, in [0, 1).
fn turn(y: f64, x: f64) -> f64 {
    let turns = y.atan2(x) / TAU;
    // A tiny negative angle plus 1 rounds to 1.
    (if turns < 0.0 { turns + 1.0 } else { turns }).min(BELOW_ONE)
}

fn cell_solid_angle(row: usize, rows: usize, columns: usize) -> f64 {
    let cos = |row: usize| (PI * row as f64 / rows as f64).cos();
    (cos(row) - cos(row + 1)) * TAU / columns as f64
}

/// For each of `cells` equal parts of an axis of `texels` texels the texels that show in it and their shares of its mean.
/// With the bilinear filter a texel shows a whole texel beyond its centre, so that no lit direction lies in a cell
/// without weight. `wrap` maps texel numbers beyond the edges to real ones.
fn shares(
    cells: usize,
    texels: usize,
    filter: Filter,
    wrap: impl Fn(i64) -> usize,
) -> Vec<Vec<(usize, f64)>> {
    let reach = if filter == Filter::Linear { 1.0 } else { 0.5 };
    // Integral of the filter from far left to `x`, centre at 0.
    let integral = |x: f64| match filter {
        Filter::Linear if x < 0.0 => 0.5 * (1.0 + x.max(-1.0)).powi(2),
        Filter::Linear => 1.0 - 0.5 * (1.0 - x.min(1.0)).powi(2),
        Filter::Nearest => (x + 0.5).clamp(0.0, 1.0),
    };
    let size = texels as f64 / cells as f64;
    let cell = |i: usize| {
        let (start, end) = (i as f64 * size, (i + 1) as f64 * size);
        let (first, last) = ((start - 0.5 - reach).floor() as i64, (end - 0.5 + reach).ceil() as i64);
        let share = |k: i64| {
            let centre = k as f64 + 0.5;
            (wrap(k), (integral(end - centre) - integral(start - centre)) / size)
        };
        (first..=last).map(share).filter(|&(_, share)| share > 0.0).collect()
    };
    (0..cells).map(cell).collect()
}
