//! The film: integers, so that sums do not depend on their order.
//!
//! A round deposits into [`RoundFilm`] from any number of threads; integer addition commutes, so the bits are the same
//! on one thread and on 64. [`Film`] adds finished rounds: the sum and the sum of squares of their pixel values, from
//! which mean and variance follow (mlt.md §6–7 of the design: rounds are copies of one estimate, Veach & Guibas 1997 §3.4).
//! The variance takes rounds as independent. Those that share a low-discrepancy sequence ([`crate::sampler`]) are better:
//! each fills the gaps of the others, so the mean is closer to the truth than their spread says.

mod blocks;
mod state;

pub use blocks::BLOCK_SIDES;
pub use state::FilmState;

use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};

use rayon::prelude::*;

use crate::math::Rgb;
use blocks::Blocks;

/// Fraction bits of one deposit, in multiples of the film's unit.
const DEPOSIT_BITS: i32 = 32;
/// Fraction bits of round values and their squares.
const SUM_BITS: i32 = 56;
/// Largest value of one round's pixel, in units: its square and thousands of rounds of it fit an `i128`.
const LIMIT: f64 = (1u64 << 29) as f64;
/// Fewest values that are worth a thread.
const GRAIN: usize = 1 << 12;

/// What one round deposits.
#[derive(Debug)]
pub struct RoundFilm {
    values: Vec<AtomicI64>,
    scale: f64,
    rejected: AtomicU64,
}

impl RoundFilm {
    /// An empty film. `unit` is the brightness that counts as 1: a power of two near the image's mean, so that deposits
    /// keep some 32 bits below it and 31 above.
    pub fn new(pixels: usize, unit: f64) -> Self {
        let values = std::iter::repeat_with(|| AtomicI64::new(0)).take(pixels * 3).collect();
        Self { values, scale: f64::from(2f32.powi(DEPOSIT_BITS)) / unit, rejected: AtomicU64::new(0) }
    }

    /// Adds `value` to a pixel. Values that are not finite or negative are counted and left out.
    pub fn add(&self, pixel: usize, value: Rgb) {
        if !value.is_finite() || value.min_element() < 0.0 {
            self.rejected.fetch_add(1, Ordering::Relaxed);
            return;
        }
        for (channel, x) in value.to_array().into_iter().enumerate() {
            if x > 0.0 {
                let fixed = (x * self.scale).round() as i64;
                let add = |sum: i64| Some(sum.saturating_add(fixed));
                // Sums of what is not negative saturate alike in any order.
                let _ =
                    self.values[pixel * 3 + channel].fetch_update(Ordering::Relaxed, Ordering::Relaxed, add);
            }
        }
    }

    /// Number of deposits left out because they were negative or not finite.
    pub fn rejected(&self) -> u64 {
        self.rejected.load(Ordering::Relaxed)
    }
}

/// The sum of finished rounds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    sum: Vec<i128>,
    squares: Vec<i128>,
    blocks: Option<Blocks>,
    rounds: u64,
    rejected: u64,
    unit_bits: i32,
}

impl Film {
    /// An empty film whose unit is the power of two nearest to `brightness`.
    pub fn new(pixels: usize, brightness: f64) -> Self {
        let unit_bits = if brightness > 0.0 { brightness.log2().round() as i32 } else { 0 };
        // Zeros that are asked for as such cost nothing until they are written to.
        let [sum, squares] = [(); 2].map(|()| vec![0; pixels * 3]);
        Self { sum, squares, blocks: None, rounds: 0, rejected: 0, unit_bits }
    }

    /// The same empty film, `width` pixels wide, that keeps the variance of blocks too.
    pub fn with_blocks(self, width: usize) -> Self {
        Self { blocks: Some(Blocks::new(width, self.pixels() / width)), ..self }
    }

    /// The brightness that counts as 1.
    pub fn unit(&self) -> f64 {
        2f64.powi(self.unit_bits)
    }

    /// An empty film for one round.
    pub fn round(&self) -> RoundFilm {
        RoundFilm::new(self.sum.len() / 3, self.unit())
    }

    /// Adds a round whose deposits count `scale` each: the round's pixel value is `scale` times their sum.
    pub fn merge(&mut self, round: &RoundFilm, scale: f64) {
        let one = 2f64.powi(SUM_BITS);
        let scale = scale * 2f64.powi(-DEPOSIT_BITS);
        let value = |deposits: &AtomicI64| (deposits.load(Ordering::Relaxed) as f64 * scale).min(LIMIT);
        let values: Vec<f64> = round.values.par_iter().map(value).collect();
        let sums = self.sum.par_iter_mut().zip(&mut self.squares).with_min_len(GRAIN);
        sums.zip(&values).for_each(|((sum, square), v)| {
            *sum += (v * one).round() as i128;
            *square += (v * v * one).round() as i128;
        });
        if let Some(blocks) = &mut self.blocks {
            blocks.add(&values, one);
        }
        self.rounds += 1;
        self.rejected += round.rejected();
    }

    /// Number of rounds.
    pub fn rounds(&self) -> u64 {
        self.rounds
    }

    /// Deposits left out because they were negative or not finite.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.sum.len() / 3
    }

    /// Mean of a pixel over the rounds.
    pub fn mean(&self, pixel: usize) -> Rgb {
        let scale = self.unit() / (2f64.powi(SUM_BITS) * self.rounds.max(1) as f64);
        Rgb::from_array(std::array::from_fn(|c| self.sum[pixel * 3 + c] as f64 * scale))
    }

    /// Estimated variance of [`Film::mean`] at a pixel, a bound from above where rounds share a sequence; infinite below
    /// two rounds.
    pub fn variance_of_mean(&self, pixel: usize) -> Rgb {
        if self.rounds < 2 {
            return Rgb::INFINITY;
        }
        let (n, one, unit) = (self.rounds as f64, 2f64.powi(SUM_BITS), self.unit());
        Rgb::from_array(std::array::from_fn(|c| {
            let mean = self.sum[pixel * 3 + c] as f64 / (one * n);
            let square = self.squares[pixel * 3 + c] as f64 / (one * n);
            ((square - mean * mean) / (n - 1.0)).max(0.0) * unit * unit
        }))
    }

    /// Estimated variances of the means of the blocks of side [`BLOCK_SIDES`]`[level]`, and for the level behind those of
    /// the whole film's mean; rows from the top. `None` below two rounds and for films that do not keep them.
    pub fn block_variances(&self, level: usize) -> Option<Vec<Rgb>> {
        let blocks = self.blocks.as_ref().filter(|_| self.rounds >= 2)?;
        let (n, one, unit) = (self.rounds as f64, 2f64.powi(SUM_BITS), self.unit());
        let means: Vec<f64> = self.sum.par_iter().map(|sum| *sum as f64 / (one * n)).collect();
        let variances = blocks.variances(level, &means, n, one);
        Some(variances.into_iter().map(|v| v * unit * unit).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_variance_are_those_of_the_rounds() {
        let mut film = Film::new(1, 0.7);
        for v in [1.0, 2.0, 6.0] {
            let round = film.round();
            round.add(0, Rgb::new(v, 0.5 * v, 0.0));
            round.add(0, Rgb::new(v, 0.5 * v, 0.0));
            film.merge(&round, 0.5);
        }
        assert!((film.mean(0) - Rgb::new(3.0, 1.5, 0.0)).length() < 1e-8);
        assert!((film.variance_of_mean(0) - Rgb::new(7.0 / 3.0, 7.0 / 12.0, 0.0)).length() < 1e-8);
    }

    #[test]
    fn order_does_not_matter() {
        let values: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.37).sin().abs() * 1e-3).collect();
        let total = |values: &mut dyn Iterator<Item = &f64>| {
            let film = RoundFilm::new(1, 1.0);
            values.for_each(|&v| film.add(0, Rgb::splat(v)));
            film.values[0].load(Ordering::Relaxed)
        };
        assert_eq!(total(&mut values.iter()), total(&mut values.iter().rev()));
    }

    #[test]
    fn what_is_not_light_is_counted_and_left_out() {
        let mut film = Film::new(1, 1.0);
        let round = film.round();
        round.add(0, Rgb::new(f64::NAN, 0.0, 0.0));
        round.add(0, Rgb::new(f64::INFINITY, 0.0, 0.0));
        round.add(0, Rgb::new(-1.0, 0.0, 0.0));
        film.merge(&round, 1.0);
        assert_eq!((film.rejected(), film.mean(0)), (3, Rgb::ZERO));
    }

    #[test]
    fn sums_too_large_stay_the_largest() {
        let mut film = Film::new(1, 1.0);
        let round = film.round();
        [1e9, 1e9, 1e9, 1.0, 1e300].into_iter().for_each(|v| round.add(0, Rgb::splat(v)));
        film.merge(&round, 1.0);
        assert!((film.mean(0).x / LIMIT - 1.0).abs() < 1e-9);
    }

    #[test]
    fn rounding_is_far_below_any_noise() {
        let mut film = Film::new(1, 3e-7);
        for _ in 0..64 {
            let round = film.round();
            (0..1000).for_each(|_| round.add(0, Rgb::splat(1e-7 / 3.0)));
            film.merge(&round, 1e-3);
        }
        assert!((film.mean(0).x / (1e-7 / 3.0) - 1.0).abs() < 1e-7);
    }
}
