//! Low-discrepancy numbers for the samples of a pixel.
//!
//! Sobol' points with hash-based Owen scrambling (Burley 2020, "Practical Hash-based Owen Scrambling"), a scramble of
//! its own for every pixel and round. Light paths longer than the tables go on with the counter-based generator.

use crate::rng::{Purpose, Rng};

/// Marks the streams that scrambles come from; those of samples have it clear.
const SCRAMBLE: u64 = 1 << 63;
const SAMPLE_BITS: u32 = 16;

/// The numbers of one sample of one pixel, dimension after dimension.
#[derive(Clone, Debug)]
pub struct Sobol {
    scramble: u32,
    sample: u32,
    dimension: u32,
    /// The four dimensions around `dimension`.
    set: [f32; 4],
    /// State of the stream of low bits.
    low: u32,
    rng: Rng,
}

impl Sobol {
    /// Sample number `sample` of `pixel` (below 2³¹) in `round`. The samples of one (seed, round, pixel) are evenly
    /// spread; after every 2¹⁶ of them a new scramble begins.
    pub fn new(seed: u64, round: u32, pixel: u64, sample: u32) -> Self {
        let scrambles = SCRAMBLE | u64::from(sample >> SAMPLE_BITS) << 31 | pixel;
        let mut rng = Rng::new(seed, Purpose::Sobol, round, pixel << 32 | u64::from(sample));
        Self {
            low: rng.next_u32(),
            scramble: Rng::new(seed, Purpose::Sobol, round, scrambles).next_u32(),
            sample: sample & ((1 << SAMPLE_BITS) - 1),
            dimension: 0,
            set: [0.0; 4],
            rng,
        }
    }

    /// Uniform in [0, 1) with 52 bits.
    pub fn next_1d(&mut self) -> f64 {
        let dimension = self.dimension;
        if dimension >= sobol_burley::NUM_DIMENSIONS {
            return self.rng.f64();
        }
        if dimension.is_multiple_of(4) {
            self.set = sobol_burley::sample_4d(self.sample, dimension / 4, self.scramble);
        }
        self.dimension += 1;
        // The tables give 23 bits; 29 random ones follow, so that no two values tie and none lies on a cell's corner.
        let low = f64::from(self.low_bits() >> 3) * (1.0 / (1u64 << 52) as f64);
        f64::from(self.set[dimension as usize % 4]) + low
    }

    /// A cheap stream for bits below the tables' resolution (O'Neill 2014, PCG-RXS-M-XS 32).
    fn low_bits(&mut self) -> u32 {
        self.low = self.low.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.low >> ((self.low >> 28) + 4)) ^ self.low).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    }

    /// Two numbers in [0, 1) that are evenly spread as a pair: both from one set of four dimensions.
    pub fn next_2d(&mut self) -> [f64; 2] {
        if self.dimension % 4 == 3 {
            self.dimension += 1;
        }
        [self.next_1d(), self.next_1d()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(pixel: u64, count: u32, dimensions: usize) -> Vec<Vec<f64>> {
        let sample = |i| {
            let mut sobol = Sobol::new(11, 3, pixel, i);
            (0..dimensions).map(|_| sobol.next_1d()).collect()
        };
        (0..count).map(sample).collect()
    }

    #[test]
    fn every_elementary_interval_of_every_dimension_holds_one_sample() {
        for k in [0, 4, 10] {
            let points = points(7, 1 << k, 256);
            for dimension in 0..256 {
                let mut hit = vec![false; 1 << k];
                for p in &points {
                    let cell = (p[dimension] * f64::from(1 << k)) as usize;
                    assert!(!std::mem::replace(&mut hit[cell], true), "2^{k}, dimension {dimension}");
                }
            }
        }
    }

    #[test]
    fn first_pair_is_a_net_in_two_dimensions() {
        for shape in 0..=8 {
            let mut hit = [false; 256];
            for i in 0..256 {
                let [x, y] = Sobol::new(5, 0, 1, i).next_2d();
                let (columns, rows) = (1 << shape, 256 >> shape);
                let cell = (x * f64::from(columns)) as usize * rows + (y * rows as f64) as usize;
                assert!(!std::mem::replace(&mut hit[cell], true));
            }
        }
    }

    #[test]
    fn pairs_stay_inside_one_set_and_long_paths_go_on() {
        let (mut a, mut b) = (Sobol::new(1, 0, 9, 5), Sobol::new(1, 0, 9, 5));
        (0..3).for_each(|_| _ = (a.next_1d(), b.next_1d()));
        b.dimension += 1;
        assert_eq!(a.next_2d()[0], b.next_1d());
        let mut sum = 0.0;
        for _ in 0..2000 {
            let x = a.next_1d();
            assert!((0.0..1.0).contains(&x));
            sum += x;
        }
        assert!((sum / 2000.0 - 0.5).abs() < 0.03);
    }

    #[test]
    fn pixels_rounds_and_seeds_are_uncorrelated_and_reproducible() {
        let column = |seed, round, pixel| -> Vec<f64> {
            (0..4096).map(|i| Sobol::new(seed, round, pixel, i).next_1d()).collect()
        };
        let base = column(1, 1, 1);
        assert_eq!(base, column(1, 1, 1));
        for other in [column(2, 1, 1), column(1, 2, 1), column(1, 1, 2), column(1, 1, 1 << 20)] {
            let covariance: f64 = base.iter().zip(&other).map(|(a, b)| (a - 0.5) * (b - 0.5)).sum();
            // Standard deviation of the correlation is 1/64.
            assert!((covariance / 4096.0 * 12.0).abs() < 0.08);
            let means = (base.iter().sum::<f64>() - other.iter().sum::<f64>()).abs() / 4096.0;
            assert!(means < 1e-3);
        }
    }

    #[test]
    fn a_single_sample_is_uniform_over_pixels_in_all_bits() {
        // χ² with 63 degrees of freedom stays below 120 with probability 0.99998.
        for shift in [0, 17, 26, 40] {
            let mut counts = [0u32; 64];
            for pixel in 0..20_000 {
                let bits = (Sobol::new(3, 0, pixel, 2).next_2d()[1] * (1u64 << 52) as f64) as u64;
                counts[(bits << 12 << shift >> 58) as usize] += 1;
            }
            let chi: f64 = counts.iter().map(|&c| (f64::from(c) - 312.5).powi(2) / 312.5).sum();
            assert!(chi < 120.0, "bits from {shift}: {chi}");
        }
    }

    #[test]
    fn more_than_a_table_of_samples_begins_a_new_scramble() {
        let value = |sample| Sobol::new(1, 0, 1, sample).next_1d();
        assert_ne!(value(5), value(5 + (1 << 16)));
        let mean = (1u32 << 16..(1 << 16) + 1024).map(value).sum::<f64>() / 1024.0;
        assert!((mean - 0.5).abs() < 1e-3);
    }
}
