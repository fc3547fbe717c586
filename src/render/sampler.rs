//! Low-discrepancy numbers for the samples of a pixel.
//!
//! Every pixel has one Sobol' sequence, Owen-scrambled by hashing, which all rounds share: round after round takes the
//! next samples of it, so that together they spread as evenly as one round of as many samples. A round alone is as
//! unbiased as ever, but what its neighbours leave out it covers: rounds are negatively correlated, and an error that is
//! estimated from the spread of rounds is too large rather than too small.
//!
//! Dimensions come in sets of four: the first four of Sobol's sequence (direction numbers of Joe & Kuo 2008), with a
//! shuffle of the samples and a scramble of the values for every set (Burley 2020, "Practical Hash-based Owen
//! Scrambling"; the hash is Vegdahl's improvement of Laine and Karras' 2011). Evenness in many dimensions gains nothing:
//! after the first sets, numbers are random.

use crate::rng::{Purpose, Rng, mix, splitmix};

/// Sets that are evenly spread: pixel and lens, then those of the first scattering events.
const EVEN_SETS: u64 = 9;
/// Samples of a scramble; after them a new one begins.
const SAMPLE_BITS: u32 = 16;
/// Weyl steps that keep streams of samples, sets and scrambles apart.
const SCRAMBLES: u64 = 0xD1B5_4A32_D192_ED03;
const SAMPLES: u64 = 0x8CB9_2BA7_2F3D_8DD7;
const SETS: u64 = 0xAEF1_7502_108E_F2D9;

/// The samples of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    key: u64,
}

impl Sequence {
    /// The samples of `pixel`; `stream` tells apart what uses them.
    pub fn new(seed: u64, stream: u32, pixel: u64) -> Self {
        let mut rng = Rng::new(seed, Purpose::Sobol, stream, pixel);
        Self { key: u64::from(rng.next_u32()) << 32 | u64::from(rng.next_u32()) }
    }

    /// Sample number `sample`. The samples of every aligned power of two up to 2¹⁶ are a net.
    pub fn sample(&self, sample: u64) -> Sobol {
        let scramble = mix(self.key.wrapping_add((sample >> SAMPLE_BITS).wrapping_mul(SCRAMBLES)));
        Sobol {
            scramble,
            index: (sample as u32) << (32 - SAMPLE_BITS) >> (32 - SAMPLE_BITS),
            sets: 0,
            next: 4,
            set: [0.0; 4],
            random: mix(scramble ^ sample.wrapping_mul(SAMPLES)),
        }
    }
}

/// The numbers of one sample of one pixel, dimension after dimension.
#[derive(Clone, Debug)]
pub struct Sobol {
    scramble: u64,
    index: u32,
    /// Sets begun.
    sets: u64,
    /// The last set begun, and how much of it is used.
    set: [f64; 4],
    next: usize,
    random: u64,
}

impl Sobol {
    /// Uniform in [0, 1) with at least 48 bits.
    #[inline]
    pub fn next_1d(&mut self) -> f64 {
        if self.next > 3 {
            self.begin();
        }
        self.next += 1;
        self.set[self.next - 1]
    }

    /// Two numbers in [0, 1) that are evenly spread as a pair: both from one set of four dimensions.
    #[inline]
    pub fn next_2d(&mut self) -> [f64; 2] {
        if self.next > 2 {
            self.begin();
        }
        self.next += 2;
        [self.set[self.next - 2], self.set[self.next - 1]]
    }

    /// A whole set: four numbers in [0, 1) that are evenly spread together, the first two best.
    #[inline]
    pub fn next_4d(&mut self) -> [f64; 4] {
        self.begin();
        self.next = 4;
        self.set
    }

    /// A number in [0, 1) that is random from sample to sample: for what gains nothing by even spread.
    #[inline]
    pub fn random(&mut self) -> f64 {
        fraction(splitmix(&mut self.random) >> 12)
    }

    #[inline]
    fn begin(&mut self) {
        if self.sets < EVEN_SETS {
            self.spread_evenly();
        } else {
            self.set = [self.random(), self.random(), self.random(), self.random()];
        }
        self.sets += 1;
        self.next = 0;
    }

    #[inline]
    fn spread_evenly(&mut self) {
        let mut seeds = self.scramble ^ self.sets.wrapping_mul(SETS);
        let (ab, cd, order) = (splitmix(&mut seeds), splitmix(&mut seeds), splitmix(&mut seeds) as u32);
        let index = owen(self.index.reverse_bits(), order) >> (32 - SAMPLE_BITS);
        let scrambles = [ab as u32, (ab >> 32) as u32, cd as u32, (cd >> 32) as u32];
        // Bits below those of Sobol' and scramble keep values from tying.
        let low = splitmix(&mut self.random);
        let mut point = sobol(index);
        for k in 0..4 {
            point[k] = owen(point[k], scrambles[k]).reverse_bits();
        }
        for k in 0..4 {
            self.set[k] = fraction(u64::from(point[k]) << 20 | low >> (16 * k) & 0xFFFF);
        }
    }
}

/// The number in [0, 1) with these 52 bits: the mantissa of one in [1, 2).
#[inline]
fn fraction(bits: u64) -> f64 {
    f64::from_bits(1f64.to_bits() | bits) - 1.0
}

/// Owen scrambling of numbers whose bits are in reverse order: a bit changes with those below it.
#[inline]
fn owen(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^ x.wrapping_mul(0x53A2_2864)
}

/// Point number `index` of the sequence, bits of `index` and of the point in reverse order.
#[inline]
fn sobol(index: u32) -> [u32; 4] {
    let mut point = [0; 4];
    for (digit, table) in POINTS.iter().enumerate() {
        let part = &table[(index >> (4 * digit) & 15) as usize];
        for k in 0..4 {
            point[k] ^= part[k];
        }
    }
    point
}

/// What each value of each hexadecimal digit of a reversed index contributes to the reversed point.
static POINTS: [[[u32; 4]; 16]; 4] = {
    let directions = [
        directions(0, 0, &[]),
        directions(1, 0, &[1]),
        directions(2, 1, &[1, 3]),
        directions(3, 1, &[1, 3, 1]),
    ];
    let mut points = [[[0; 4]; 16]; 4];
    let mut i = 0;
    while i < 4 * 16 * 4 * 4 {
        let (digit, value, dimension, bit) = (i >> 8, i >> 4 & 15, i >> 2 & 3, i & 3);
        if value >> bit & 1 == 1 {
            points[digit][value][dimension] ^= directions[dimension][15 - (4 * digit + bit)].reverse_bits();
        }
        i += 1;
    }
    points
};

/// The first direction numbers of a dimension with primitive polynomial of `degree` and inner coefficients `polynomial`.
const fn directions(degree: usize, polynomial: u32, first: &[u32]) -> [u32; 16] {
    let mut v = [0; 16];
    let mut i = 0;
    while i < 16 {
        v[i] = if degree == 0 {
            1 << (31 - i)
        } else if i < degree {
            first[i] << (31 - i)
        } else {
            let mut x = v[i - degree] ^ (v[i - degree] >> degree);
            let mut j = 1;
            while j < degree {
                x ^= v[i - j] * (polynomial >> (degree - 1 - j) & 1);
                j += 1;
            }
            x
        };
        i += 1;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVEN: usize = 4 * EVEN_SETS as usize;

    fn points(samples: std::ops::Range<u64>) -> Vec<Vec<f64>> {
        let sequence = Sequence::new(11, 3, 7);
        let point = |i| {
            let mut sobol = sequence.sample(i);
            (0..EVEN).map(|_| sobol.next_1d()).collect()
        };
        samples.map(point).collect()
    }

    /// Asserts that every box of 2^-shape[k] in dimension `first + k` holds as many of the points as any other.
    fn assert_even(points: &[Vec<f64>], first: usize, shape: &[u32]) {
        let boxes = 1 << shape.iter().sum::<u32>();
        let mut counts = vec![0; boxes];
        for p in points {
            let cell = |cell, (k, &bits): (usize, &u32)| {
                cell << bits | (p[first + k] * f64::from(1u32 << bits)) as usize
            };
            counts[shape.iter().enumerate().fold(0, cell)] += 1;
        }
        assert!(counts.iter().all(|&n| n == points.len() / boxes), "{shape:?} from dimension {first}");
    }

    #[test]
    fn every_interval_of_every_even_dimension_holds_one_sample() {
        for k in [0, 4, 10, 16] {
            let points = points(0..1 << k);
            (0..EVEN).for_each(|dimension| assert_even(&points, dimension, &[k]));
        }
    }

    #[test]
    fn the_first_pair_of_each_set_is_a_net_and_the_whole_set_almost() {
        let points = points(0..256);
        for first in (0..EVEN).step_by(4) {
            (0..=8).for_each(|shape| assert_even(&points, first, &[shape, 8 - shape]));
            // The polynomials have degrees 0, 1, 2 and 3, so that boxes of 2³ samples are exact (Niederreiter 1987).
            for shape in [[2, 1, 1, 1], [1, 2, 1, 1], [1, 1, 2, 1], [1, 1, 1, 2], [0, 0, 2, 3], [0, 2, 0, 3]]
            {
                assert_even(&points, first, &shape);
            }
        }
    }

    #[test]
    fn rounds_alone_and_together_are_nets() {
        let rounds: Vec<_> = (0..16).map(|round| points(round * 16..(round + 1) * 16)).collect();
        for first in (0..EVEN).step_by(4) {
            for round in &rounds {
                (0..=4).for_each(|shape| assert_even(round, first, &[shape, 4 - shape]));
            }
            (0..=8).for_each(|shape| assert_even(&rounds.concat(), first, &[shape, 8 - shape]));
            (0..=7).for_each(|shape| assert_even(&rounds[8..].concat(), first, &[shape, 7 - shape]));
        }
    }

    #[test]
    fn pairs_stay_inside_one_set_and_long_paths_go_on() {
        let (mut a, mut b) = (Sequence::new(1, 0, 9).sample(5), Sequence::new(1, 0, 9).sample(5));
        (0..3).for_each(|_| _ = (a.next_1d(), b.next_1d()));
        b.next_1d();
        let set = b.next_4d();
        assert_eq!(a.next_2d(), [set[0], set[1]]);
        assert_eq!(a.next_2d(), [set[2], set[3]]);
        let mut sum = 0.0;
        for _ in 0..2000 {
            let x = a.next_1d();
            assert!((0.0..1.0).contains(&x));
            sum += x;
        }
        assert!((sum / 2000.0 - 0.5).abs() < 0.03);
    }

    fn correlation(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - 0.5) * (b - 0.5)).sum::<f64>() / a.len() as f64 * 12.0
    }

    #[test]
    fn pixels_streams_and_seeds_are_uncorrelated_and_reproducible() {
        let column = |seed, stream, pixel| -> Vec<f64> {
            (0..4096).map(|i| Sequence::new(seed, stream, pixel).sample(i).next_1d()).collect()
        };
        let base = column(1, 1, 1);
        assert_eq!(base, column(1, 1, 1));
        for other in [column(2, 1, 1), column(1, 2, 1), column(1, 1, 2), column(1, 1, 1 << 20)] {
            // Standard deviation is 1/64.
            assert!(correlation(&base, &other).abs() < 0.08);
            let means = (base.iter().sum::<f64>() - other.iter().sum::<f64>()).abs() / 4096.0;
            assert!(means < 1e-3);
        }
    }

    #[test]
    fn dimensions_even_and_random_are_uncorrelated() {
        let columns: Vec<Vec<f64>> = (0..EVEN + 8)
            .map(|dimension| {
                let value = |i| {
                    let mut sobol = Sequence::new(4, 0, 2).sample(i);
                    (0..dimension).for_each(|_| _ = sobol.next_1d());
                    sobol.next_1d()
                };
                (0..4096).map(value).collect()
            })
            .collect();
        for i in 0..columns.len() {
            for j in 0..i {
                // Standard deviation is 1/64; the largest of 946.
                let found = correlation(&columns[i], &columns[j]);
                assert!(found.abs() < 5.0 / 64.0, "{i} {j}: {found}");
            }
        }
    }

    #[test]
    fn a_single_sample_is_uniform_over_pixels_in_all_bits() {
        // χ² with 63 degrees of freedom stays below 120 with probability 0.99998.
        for shift in [0, 17, 26, 40] {
            let mut counts = [0u32; 64];
            for pixel in 0..20_000 {
                let sample = Sequence::new(3, 0, pixel).sample(2).next_2d()[1];
                let bits = (sample * (1u64 << 52) as f64) as u64;
                counts[(bits << 12 << shift >> 58) as usize] += 1;
            }
            let chi: f64 = counts.iter().map(|&c| (f64::from(c) - 312.5).powi(2) / 312.5).sum();
            assert!(chi < 120.0, "bits from {shift}: {chi}");
        }
    }

    #[test]
    fn more_than_a_table_of_samples_begins_a_new_scramble() {
        let value = |sample| Sequence::new(1, 0, 1).sample(sample).next_1d();
        for block in [1, 2, 1 << 33] {
            assert_ne!(value(5), value(5 + (block << 16)));
            let mean = (block << 16..(block << 16) + 1024).map(value).sum::<f64>() / 1024.0;
            assert!((mean - 0.5).abs() < 1e-3);
        }
    }
}
