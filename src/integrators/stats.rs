//! Error of an image, estimated from the spread of its rounds (mlt.md §7; Veach & Guibas 1997 §3.4).
//!
//! Rounds of eye paths take consecutive samples of one sequence a pixel (`ajar_render::sampler`): what is smooth in a
//! pixel cancels between them, while the estimate takes them as independent. It is then too high, never too low in the
//! mean, so that a render which stops at a noise limit has kept it.

use ajar_render::{film::Film, math::scalar};
use rayon::prelude::*;

use crate::Window;

/// Fewest rounds from which noise is estimated.
pub const MIN_ROUNDS: u64 = 8;
/// Side of the tiles whose worst is reported, pixels.
const TILE: usize = 64;
/// The share of a tile's pixels that must have noise for the tile to count: one in so many.
const SPARSE: usize = 16;

/// Relative standard errors, 0.02 for 2 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Of the median of the pixels that have noise.
    pub typical: f64,
    /// Of the typical pixel in the worst 64-pixel tile.
    pub worst_tile: f64,
}

impl Noise {
    /// The one number that limits are held against: the typical pixel's, or a third of the worst tile's where that is more.
    pub fn counted(self) -> f64 {
        self.typical.max(self.worst_tile / 3.0)
    }
}

/// Estimates the noise of a film of `window`; `None` before [`MIN_ROUNDS`] or while the film is black.
///
/// Pixels that are the same in all rounds, an even background, do not count: an image is not less noisy for having many
/// of them. A pixel's relative variance is its variance of the mean over `mean² + (1 % of the image's mean)²`, both averaged over
/// 3 × 3 pixels since single variances are themselves noisy.
pub fn noise(film: &Film, window: Window) -> Option<Noise> {
    if film.rounds() < MIN_ROUNDS {
        return None;
    }
    let (width, height) = (window.width() as usize, window.height() as usize);
    let means: Vec<f64> = (0..film.pixels()).into_par_iter().map(|p| scalar(film.mean(p))).collect();
    let variance = |p| scalar(film.variance_of_mean(p));
    let variances: Vec<f64> = (0..film.pixels()).into_par_iter().map(variance).collect();
    let image_mean = means.iter().sum::<f64>() / means.len() as f64;
    if image_mean <= 0.0 {
        return None;
    }
    let has_noise: Vec<bool> = variances.iter().map(|&variance| variance > 0.0).collect();
    let floor = (0.01 * image_mean).powi(2);
    let (variances, squares) = (smooth(&variances, width, height), {
        let squares: Vec<f64> = means.iter().map(|m| m * m).collect();
        smooth(&squares, width, height)
    });
    let relative = variances.iter().zip(&squares).map(|(v, s)| v / (s + floor));
    let relative: Vec<Option<f64>> = relative.zip(has_noise).map(|(r, noisy)| noisy.then_some(r)).collect();
    let enough = |tile: &Vec<Option<f64>>| tile.iter().flatten().count() * SPARSE >= tile.len();
    let worst = tiles(&relative, width).filter(enough).map(median).reduce(|| 0.0, f64::max);
    let typical = median(relative);
    Some(Noise { typical: typical.sqrt(), worst_tile: worst.max(typical).sqrt() })
}

/// Mean over each pixel's 3 × 3 neighbourhood inside the image.
fn smooth(values: &[f64], width: usize, height: usize) -> Vec<f64> {
    let span = |i: usize, n: usize| i.saturating_sub(1)..(i + 2).min(n);
    (0..values.len())
        .into_par_iter()
        .map(|i| {
            let (columns, rows) = (span(i % width, width), span(i / width, height));
            let count = columns.len() * rows.len();
            let sum: f64 =
                rows.flat_map(|y| &values[y * width + columns.start..y * width + columns.end]).sum();
            sum / count as f64
        })
        .collect()
}

/// The values of each tile, rows of tiles from the top.
fn tiles<T: Copy + Send + Sync>(values: &[T], width: usize) -> impl ParallelIterator<Item = Vec<T>> {
    let (columns, height) = (width.div_ceil(TILE), values.len() / width);
    (0..columns * height.div_ceil(TILE)).into_par_iter().map(move |tile| {
        let (x, y) = (tile % columns * TILE, tile / columns * TILE);
        let row = |y: usize| &values[y * width + x..y * width + (x + TILE).min(width)];
        (y..(y + TILE).min(height)).flat_map(row).copied().collect()
    })
}

/// Of those that there are; 0 where there are none.
fn median(values: Vec<Option<f64>>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().flatten().collect();
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ajar_render::{
        math::Rgb,
        rng::{Purpose, Rng},
    };

    const WINDOW: Window = Window { x0: 0, y0: 0, x1: 130, y1: 70 };

    fn film(rounds: u32, sigma: impl Fn(usize) -> f64) -> Film {
        let mut film = Film::new(WINDOW.pixels(), 1.0);
        for round in 0..rounds {
            let deposits = film.round();
            let mut rng = Rng::new(1, Purpose::Test, round, 0);
            for pixel in 0..WINDOW.pixels() {
                // Uniform of mean 2 and standard deviation sigma.
                let value = 2.0 + sigma(pixel) * (rng.f64() - 0.5) * 12f64.sqrt();
                deposits.add(pixel, Rgb::splat(value));
            }
            film.merge(&deposits, 1.0);
        }
        film
    }

    #[test]
    fn noise_is_the_relative_standard_error() {
        let found = noise(&film(64, |_| 0.4), WINDOW).expect("enough rounds");
        assert!((found.typical / (0.4 / 2.0 / 8.0) - 1.0).abs() < 0.05, "{found:?}");
    }

    #[test]
    fn the_worst_tile_shows() {
        let found =
            noise(&film(64, |p| if p % 130 >= 64 { 1.0 } else { 0.1 }), WINDOW).expect("enough rounds");
        assert!(found.worst_tile / (1.0 / 2.0 / 8.0) > 0.9, "{found:?}");
    }

    #[test]
    fn pixels_without_noise_do_not_count() {
        // Four columns in five are background.
        let found =
            noise(&film(64, |p| if p % 130 >= 104 { 0.4 } else { 0.0 }), WINDOW).expect("enough rounds");
        let expected = 0.4 / 2.0 / 8.0;
        assert!((found.typical / expected - 1.0).abs() < 0.1, "{found:?}");
        assert!((found.worst_tile / expected - 1.0).abs() < 0.1, "{found:?}");
        assert_eq!(noise(&film(64, |_| 0.0), WINDOW), Some(Noise { typical: 0.0, worst_tile: 0.0 }));
    }

    #[test]
    fn too_few_rounds_say_nothing() {
        assert_eq!(noise(&film(7, |_| 0.1), WINDOW), None);
    }
}
