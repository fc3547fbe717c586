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
    /// Subpaths that are offered to Markov chains.
    LensSubpath = 8,
    /// Tests.
    Test = 99,
}

/// SplitMix (Steele, Lea & Flood 2014, "Fast Splittable Pseudorandom Number Generators"): the n-th number is a hash of
/// n steps beyond a start that seed, purpose, round and index make.
#[derive(Clone, Debug)]
pub struct Rng {
    state: u64,
}

impl Rng {
    /// The stream of (`seed`, `purpose`, `round`, `index`).
    #[inline]
    pub fn new(seed: u64, purpose: Purpose, round: u32, index: u64) -> Self {
        let what = u64::from(purpose as u32) << 32 | u64::from(round);
        let state = [what, index]
            .into_iter()
            .fold(mix(seed ^ STEP), |state, word| mix(state.wrapping_add(STEP) ^ word));
        Self { state }
    }

    /// 64 random bits.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        splitmix(&mut self.state)
    }

    /// 32 random bits.
    #[inline]
    pub fn next_u32(&mut self) -> u32 {
        (self.next_u64() >> 32) as u32
    }

    /// Uniform in [0, 1) with 53 bits.
    #[inline]
    pub fn f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Two uniform numbers in [0, 1).
    #[inline]
    pub fn pair(&mut self) -> [f64; 2] {
        [self.f64(), self.f64()]
    }

    /// Uniform integer in `0..n`, for n far below 2⁵³.
    #[inline]
    pub fn below(&mut self, n: usize) -> usize {
        ((self.f64() * n as f64) as usize).min(n - 1)
    }
}

/// 2⁶⁴ over the golden ratio: what counters advance by.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// The next number of a cheap stream whose whole state is a seed (Steele, Lea & Flood 2014, "Fast Splittable Pseudorandom
/// Number Generators").
#[inline]
pub fn splitmix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(STEP);
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
    fn the_stream_gives_the_published_known_answers() {
        let mut state = 1_234_567;
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!([0; 5].map(|_| splitmix(&mut state)), expected);
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
