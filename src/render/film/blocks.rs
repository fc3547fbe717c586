//! Moments of block means, from which the error of an area follows.
//!
//! Neighbouring pixels are not independent: a Markov chain lights several of them, a light path of BDPT splats anywhere.
//! So the variance of a block's mean is not a sum of pixel variances; it is estimated like that of a pixel, from the
//! spread of the rounds (Veach & Guibas 1997 §3.4). One square a block, level and channel is all that needs keeping.

use rayon::prelude::*;

use crate::math::Rgb;

/// Sides of the blocks, pixels. The grids start at the film's top left; blocks at its right and bottom may be smaller.
pub const BLOCK_SIDES: [usize; 3] = [8, 16, 64];

/// Sums over the rounds of squared block means, in the film's fixed point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Blocks {
    pub(super) width: usize,
    /// One list a side, three entries a block, rows from the top; last that of the whole film.
    pub(super) squares: [Vec<i128>; BLOCK_SIDES.len() + 1],
}

impl Blocks {
    pub(super) fn new(width: usize, height: usize) -> Self {
        let count = |side: usize| width.div_ceil(side) * height.div_ceil(side) * 3;
        let [small, middle, large] = BLOCK_SIDES.map(count);
        Self { width, squares: [small, middle, large, 3].map(|n| vec![0; n]) }
    }

    /// Adds a round, `values` being those of its pixels, three each; `one` is 1 in fixed point.
    pub(super) fn add(&mut self, values: &[f64], one: f64) {
        let width = self.width;
        self.squares.par_iter_mut().enumerate().for_each(|(level, squares)| {
            for (square, mean) in squares.iter_mut().zip(means(width, level, values)) {
                *square += (mean * mean * one).round() as i128;
            }
        });
    }

    /// Variance of the mean over `rounds` of the blocks of `level`, `means` being the pixels' means; units as there.
    pub(super) fn variances(&self, level: usize, means: &[f64], rounds: f64, one: f64) -> Vec<Rgb> {
        let variance = |(square, mean): (&i128, f64)| {
            ((*square as f64 / (one * rounds) - mean * mean) / (rounds - 1.0)).max(0.0)
        };
        let means = self::means(self.width, level, means);
        let flat: Vec<f64> = self.squares[level].iter().zip(means).map(variance).collect();
        flat.chunks_exact(3).map(Rgb::from_slice).collect()
    }
}

/// Means over the blocks of `level`, three each, summed in the order of the pixels, three values each.
fn means(width: usize, level: usize, values: &[f64]) -> Vec<f64> {
    let height = values.len() / 3 / width;
    let side = BLOCK_SIDES.get(level).copied().unwrap_or(width.max(height));
    let band = |rows: &[f64]| {
        let mut sums = vec![[0.0; 3]; width.div_ceil(side)];
        for row in rows.chunks(width * 3) {
            for (sum, pixels) in sums.iter_mut().zip(row.chunks(side * 3)) {
                for pixel in pixels.chunks_exact(3) {
                    sum.iter_mut().zip(pixel).for_each(|(sum, v)| *sum += v);
                }
            }
        }
        let rows = rows.len() / 3 / width;
        let count = move |column: usize| (side.min(width - column * side) * rows) as f64;
        sums.into_iter().enumerate().flat_map(move |(column, sum)| sum.map(|s| s / count(column)))
    };
    values.par_chunks(side * width * 3).flat_map_iter(band).collect()
}

#[cfg(test)]
mod tests {
    use crate::{
        film::Film,
        math::Rgb,
        rng::{Purpose, Rng},
    };

    const WIDTH: usize = 70;
    const HEIGHT: usize = 20;

    /// Rounds in which all pixels share a part of their noise.
    fn film(rounds: u32) -> Film {
        let mut film = Film::new(WIDTH * HEIGHT, 1.0).with_blocks(WIDTH);
        for index in 0..rounds {
            let round = film.round();
            let mut rng = Rng::new(7, Purpose::Test, index, 0);
            let shared = rng.f64();
            for pixel in 0..WIDTH * HEIGHT {
                round.add(pixel, Rgb::new(1.0 + rng.f64(), 1.0 + shared, 2.0));
            }
            film.merge(&round, 1.0);
        }
        film
    }

    #[test]
    fn independent_pixels_average_out_and_shared_noise_does_not() {
        let film = film(400);
        let uniform = 1.0 / 12.0 / 400.0;
        for (level, columns, rows, pixels) in
            [(0, 9, 3, 64.0), (1, 5, 2, 256.0), (2, 2, 1, 1280.0), (3, 1, 1, 1400.0)]
        {
            let variances = film.block_variances(level).expect("two rounds or more");
            assert_eq!(variances.len(), columns * rows);
            let first = variances[0];
            assert!((first.x * pixels / uniform - 1.0).abs() < 0.3, "level {level}: {first}");
            assert!((first.y / uniform - 1.0).abs() < 0.3, "level {level}: {first}");
            assert!(first.z < 1e-15, "level {level}: {first}");
        }
        let corner = film.block_variances(0).expect("two rounds or more")[26].x;
        assert!(
            (corner * 6.0 * 4.0 / uniform - 1.0).abs() < 0.3,
            "the smaller block at the corner: {corner}"
        );
    }

    #[test]
    fn one_round_says_nothing_about_its_error() {
        assert_eq!(film(1).block_variances(0), None);
    }
}
