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
        let point = sobol(index);
        for (k, (value, (x, scramble))) in
            self.set.iter_mut().zip(point.into_iter().zip(scrambles)).enumerate()
        {
            let x = owen(x, scramble).reverse_bits();
            *value = fraction(u64::from(x) << 20 | low >> (16 * k) & 0xFFFF);
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
mod tests;
