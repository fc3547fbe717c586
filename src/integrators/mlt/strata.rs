//! Raster positions that many chains share evenly.
//!
//! At its τ-th request every chain of a round gets one of as many strata, by a permutation of its own for each τ. A chain
//! alone sees independent uniform positions, so its proposals do not depend on its past; all chains together cover the
//! image evenly (mlt.md §3.9: a list that one chain works through would shift what it converges to).

use ajar_render::rng::{mix, splitmix};

/// A chain's place among the chains of its round.
#[derive(Clone, Copy, Debug, Default)]
pub struct Strata {
    /// Number of the chain.
    pub chain: u32,
    /// Chains in all.
    pub chains: u32,
    /// What tells rounds apart.
    pub key: u64,
    /// Requests so far.
    asked: u64,
}

impl Strata {
    /// Those of a chain.
    pub fn new(chain: u32, chains: u32, key: u64) -> Self {
        Self { chain, chains: chains.max(1), key, asked: 0 }
    }

    /// A point of the unit square; `u` says where in its stratum.
    pub fn next(&mut self, u: [f64; 2]) -> [f64; 2] {
        let mut seeds = mix(self.key ^ mix(self.asked));
        self.asked += 1;
        let chains = self.chains.max(1);
        let stratum = permute(self.chain, chains, splitmix(&mut seeds) as u32);
        // Rows by the stratum, columns by van der Corput's sequence, shifted: Hammersley's points.
        let column = (stratum.reverse_bits() ^ splitmix(&mut seeds) as u32) as f64 / 4_294_967_296.0;
        let row = (f64::from(stratum) + u[1]) / f64::from(chains);
        [(column + u[0] / f64::from(chains)).fract(), row.min(1.0 - f64::EPSILON)]
    }
}

/// The place of `i` in a random permutation of `0..n` (Kensler 2013, "Correlated Multi-Jittered Sampling").
fn permute(mut i: u32, n: u32, key: u32) -> u32 {
    let mask = n.next_power_of_two() - 1;
    loop {
        i ^= key;
        i = i.wrapping_mul(0xE170_893D);
        i ^= key >> 16;
        i ^= (i & mask) >> 4;
        i ^= key >> 8;
        i = i.wrapping_mul(0x0929_EB3F);
        i ^= key >> 23;
        i ^= (i & mask) >> 1;
        i = i.wrapping_mul(1 | key >> 27);
        i = i.wrapping_mul(0x6935_FA69);
        i ^= (i & mask) >> 11;
        i = i.wrapping_mul(0x74DC_B303);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0x9E50_1CC3);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0xC860_A3DF);
        i &= mask;
        i ^= i >> 5;
        if i < n {
            return i.wrapping_add(key) % n;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_take_every_place_once() {
        for n in [1, 2, 7, 64, 1000] {
            let mut seen = vec![false; n as usize];
            for i in 0..n {
                assert!(!std::mem::replace(&mut seen[permute(i, n, 0x1234_5678) as usize], true), "{n}");
            }
        }
    }

    #[test]
    fn one_chain_sees_uniform_positions_and_all_chains_cover_the_image() {
        let mut strata: Vec<Strata> = (0..256).map(|chain| Strata::new(chain, 256, 5)).collect();
        let mut cells = [0u32; 64];
        for _ in 0..200 {
            let mut rows = [false; 256];
            for (chain, strata) in strata.iter_mut().enumerate() {
                let [x, y] = strata.next([0.5; 2]);
                assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
                assert!(!std::mem::replace(&mut rows[(y * 256.0) as usize], true));
                if chain == 3 {
                    cells[(x * 8.0) as usize * 8 + (y * 8.0) as usize] += 1;
                }
            }
        }
        // χ² with 63 degrees of freedom stays below 120 with probability 0.99998.
        let chi: f64 = cells.iter().map(|&c| (f64::from(c) - 3.125).powi(2) / 3.125).sum();
        assert!(chi < 120.0, "{chi}");
    }
}
