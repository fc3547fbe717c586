//! All randomness: a counter-based generator, so that a number depends on what it is for and never on who drew it.

/// What random numbers are for. Streams of different purposes never meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Purpose {
    /// Eye paths of the path tracer and the base.
    Eye = 1,
    /// Samples of bidirectional path tracing.
    Bidirectional = 2,
    /// Scrambles and low bits of low-discrepancy points.
    Sobol = 3,
    /// Bidirectional samples that seed Markov chains.
    Bootstrap = 4,
    /// Which candidates become seeds.
    Resampling = 5,
    /// Markov chains.
    Chain = 6,
    /// Light seen directly.
    Direct = 7,
    /// Strata of Markov chains.
    Strata = 8,
    /// Tests.
    Test = 99,
}

/// Philox4x32-10 (Salmon et al. 2011, "Parallel Random Numbers: As Easy as 1, 2, 3"). The key is the user's seed and the
/// purpose, the counter holds round and index and counts the draws.
#[derive(Clone, Debug)]
pub struct Rng {
    key: [u32; 2],
    counter: [u32; 4],
    block: [u32; 4],
    used: usize,
}

impl Rng {
    /// The stream of (`seed`, `purpose`, `round`, `index`); streams hold 2³² blocks of 128 bits.
    pub fn new(seed: u64, purpose: Purpose, round: u32, index: u64) -> Self {
        let folded = (seed ^ (seed >> 32)) as u32;
        let counter = [0, round ^ ((seed >> 32) as u32), index as u32, (index >> 32) as u32];
        Self { key: [folded, purpose as u32], counter, block: [0; 4], used: 4 }
    }

    /// 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        if self.used == 4 {
            self.block = philox(self.counter, self.key);
            self.counter[0] = self.counter[0].wrapping_add(1);
            self.used = 0;
        }
        self.used += 1;
        self.block[self.used - 1]
    }

    /// Uniform in [0, 1) with 52 bits.
    pub fn f64(&mut self) -> f64 {
        let (high, low) = (u64::from(self.next_u32()), u64::from(self.next_u32()));
        ((high << 20) ^ (low >> 12)) as f64 * (1.0 / (1u64 << 52) as f64)
    }

    /// Two uniform numbers in [0, 1).
    pub fn pair(&mut self) -> [f64; 2] {
        [self.f64(), self.f64()]
    }

    /// Uniform integer in `0..n`, for n far below 2⁵².
    pub fn below(&mut self, n: usize) -> usize {
        ((self.f64() * n as f64) as usize).min(n - 1)
    }
}

fn philox(mut c: [u32; 4], mut k: [u32; 2]) -> [u32; 4] {
    for _ in 0..10 {
        let a = u64::from(c[0]) * 0xD251_1F53;
        let b = u64::from(c[2]) * 0xCD9E_8D57;
        c = [(b >> 32) as u32 ^ c[1] ^ k[0], b as u32, (a >> 32) as u32 ^ c[3] ^ k[1], a as u32];
        k = [k[0].wrapping_add(0x9E37_79B9), k[1].wrapping_add(0xBB67_AE85)];
    }
    c
}

/// The next number of a cheap stream whose whole state is a seed (Steele, Lea & Flood 2014, "Fast Splittable Pseudorandom
/// Number Generators").
#[inline]
pub fn splitmix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    mix(*state)
}

/// A permutation of 64 bits in which each depends on all (Stafford's variant 13 of MurmurHash3's finalizer).
#[inline]
pub fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn philox_gives_the_published_known_answers() {
        assert_eq!(philox([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(
            philox([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
    }

    #[test]
    fn streams_differ_in_every_key() {
        let first = |seed, purpose, round, index| Rng::new(seed, purpose, round, index).f64();
        let base = first(1, Purpose::Eye, 1, 1);
        assert_eq!(base, first(1, Purpose::Eye, 1, 1));
        for other in [
            first(2, Purpose::Eye, 1, 1),
            first(1 << 32 | 1, Purpose::Eye, 1, 1),
            first(1, Purpose::Bidirectional, 1, 1),
            first(1, Purpose::Eye, 2, 1),
            first(1, Purpose::Eye, 1, 2),
        ] {
            assert_ne!(base, other);
        }
    }

    #[test]
    fn numbers_stay_below_one_with_the_right_moments() {
        let mut rng = Rng::new(7, Purpose::Test, 0, 0);
        let xs: Vec<f64> = (0..100_000).map(|_| rng.f64()).collect();
        assert!(xs.iter().all(|x| (0.0..1.0).contains(x)));
        let mean = xs.iter().sum::<f64>() / xs.len() as f64;
        let variance = xs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / xs.len() as f64;
        assert!((mean - 0.5).abs() < 0.004 && (variance - 1.0 / 12.0).abs() < 0.002);
    }
}
