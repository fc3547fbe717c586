//! Eye subpaths E S* D that lens subpath mutations offer to chains (Veach & Guibas 1997 §4.3.4): evenly spread over the
//! image, each offered several times.
//!
//! What a chain is offered must not depend on the chain's past, or it shifts what the chain converges to (mlt.md §3.9 of
//! the design). [`Spread::AcrossChains`] keeps to that: at its τ-th request every group of chains gets one of as many
//! strata as there are groups, by a permutation of its own for each τ, and the chains of a group share the subpath. A
//! chain alone sees independent uniform positions. [`Spread::List`] is what the seed paper describes, a list of pixels in
//! random order that a chain works through, each subpath offered to the same chain again and again.

use ajar_render::{
    bsdf::{Mode, Side},
    path::{Kind, Vertex},
    rng::{Purpose, Rng, mix, splitmix},
};
use glam::DVec2;

use super::path::Space;

/// How often a subpath is offered.
pub const REUSE: usize = 4;

/// How subpaths spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spread {
    /// Evenly over all chains of a round, each offered once to each of [`REUSE`] chains: exact.
    #[default]
    AcrossChains,
    /// Evenly over the steps of each chain, each offered [`REUSE`] times in a row: converges to a slightly different image.
    List,
}

impl Spread {
    /// Its name in settings.
    pub fn name(self) -> &'static str {
        match self {
            Self::AcrossChains => "across-chains",
            Self::List => "list",
        }
    }

    /// All of them.
    pub const ALL: [Self; 2] = [Self::AcrossChains, Self::List];
}

/// A subpath from the lens to the first vertex that scatters smoothly.
#[derive(Clone, Debug, Default)]
pub struct EyeSubpath {
    /// The lens first; empty if it got lost.
    pub vertices: Vec<Vertex>,
    /// Raster position, pixels.
    pub raster: DVec2,
    /// Point of the lens.
    pub lens: [f64; 2],
    /// Rays cast for it.
    pub rays: u64,
}

/// The subpaths that a chain is offered, one after the other.
#[derive(Clone, Debug)]
pub struct LensSubpaths {
    spread: Spread,
    seed: u64,
    round: u32,
    /// Which of how many groups, or chains.
    group: u32,
    groups: u32,
    asked: usize,
    made: Vec<EyeSubpath>,
}

impl Default for LensSubpaths {
    fn default() -> Self {
        Self::new(Spread::AcrossChains, (0, 0), 0, 1)
    }
}

impl LensSubpaths {
    /// Those of group number `group` of `groups` in a round.
    pub fn new(spread: Spread, (seed, round): (u64, u32), group: u32, groups: u32) -> Self {
        Self { spread, seed, round, group, groups: groups.max(1), asked: 0, made: Vec::new() }
    }

    /// The next chain of the group begins.
    pub fn next_chain(&mut self) {
        self.asked = 0;
    }

    /// The next subpath to offer.
    pub fn next(&mut self, space: &Space<'_>) -> &EyeSubpath {
        let asked = self.asked;
        self.asked += 1;
        let slot = match self.spread {
            Spread::AcrossChains => asked,
            Spread::List => {
                if asked.is_multiple_of(REUSE) {
                    self.made.clear();
                }
                0
            }
        };
        if slot < self.made.len() {
            self.made[slot].rays = 0;
        } else {
            let number = if self.spread == Spread::List { asked / REUSE } else { asked };
            let made = self.make(space, number as u32);
            self.made.push(made);
        }
        &self.made[slot]
    }

    fn make(&self, space: &Space<'_>, number: u32) -> EyeSubpath {
        let index = (u64::from(self.group) + 1) << 32 | u64::from(number);
        let mut rng = Rng::new(self.seed, Purpose::LensSubpath, self.round, index);
        let square = match self.spread {
            Spread::AcrossChains => self.stratum(number, rng.pair()),
            Spread::List => self.listed(space, number, rng.pair()),
        };
        trace(space, space.raster(square), &mut rng)
    }

    /// A point of the group's stratum at request `number`; `u` says where in it.
    fn stratum(&self, number: u32, u: [f64; 2]) -> [f64; 2] {
        // The same for all groups, which share the strata out.
        let mut seeds = Rng::new(self.seed, Purpose::LensSubpath, self.round, number.into()).next_u64();
        let stratum = permute(self.group, self.groups, splitmix(&mut seeds) as u32);
        // Rows by the stratum, columns by van der Corput's sequence, shifted: Hammersley's points.
        let column = f64::from(stratum.reverse_bits() ^ splitmix(&mut seeds) as u32) / 4_294_967_296.0;
        let n = f64::from(self.groups);
        [(column + u[0] / n).fract(), ((f64::from(stratum) + u[1]) / n).min(1.0 - f64::EPSILON)]
    }

    /// A point of entry `number` of a list of all pixels in random order.
    fn listed(&self, space: &Space<'_>, number: u32, u: [f64; 2]) -> [f64; 2] {
        let (width, pixels) = (space.window.width(), space.window.pixels() as u32);
        let key = mix(self.seed ^ mix(u64::from(self.round) << 32 | u64::from(self.group)));
        let pixel = permute(number % pixels, pixels, key as u32);
        let (x, y) = (pixel % width, pixel / width);
        [(f64::from(x) + u[0]) / f64::from(width), (f64::from(y) + u[1]) / f64::from(space.window.height())]
    }
}

/// The Dirac event that `u` picks by its chance, in the order of [`Mode::DIRAC`]; what the chances leave is smooth.
fn choose(chances: [f64; 4], mut u: f64) -> Mode {
    for (mode, chance) in Mode::DIRAC.into_iter().zip(chances) {
        if u < chance {
            return mode;
        }
        u -= chance;
    }
    Mode::Smooth
}

/// Follows mirrors and lenses as chance has it, up to a vertex that scatters smoothly.
fn trace(space: &Space<'_>, raster: DVec2, rng: &mut Rng) -> EyeSubpath {
    let lens = rng.pair();
    let ray = space.world.camera.ray(raster, lens);
    let mut made = EyeSubpath { vertices: Vec::new(), raster, lens, rays: 0 };
    let mut walked = vec![space.world.lens_vertex(ray.origin)];
    let (mut origin, mut direction) = (ray.origin, ray.direction);
    while walked.len() <= space.max_depth {
        let seed = if space.world.has_alpha() { rng.next_u32() } else { 0 };
        made.rays += 1;
        let Some(mut vertex) = space.world.trace(origin, direction, walked.len() == 1, seed) else { break };
        let known = vertex.frame.to_local(-direction);
        vertex.mode = choose(vertex.bsdf.dirac_chances(Side::TowardLight, known), rng.f64());
        if vertex.mode == Mode::Smooth {
            if vertex.bsdf.has_smooth() {
                walked.push(vertex);
                made.vertices = walked;
            }
            break;
        }
        let Some(step) = vertex.dirac_step(Side::TowardLight, -direction, vertex.mode) else { break };
        direction = step.direction;
        origin = vertex.leave(direction);
        walked.push(vertex);
    }
    debug_assert!(made.vertices.first().is_none_or(|lens| lens.kind == Kind::Lens));
    made
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
    fn one_chain_sees_uniform_positions_and_all_groups_cover_the_image() {
        let groups: Vec<LensSubpaths> =
            (0..256).map(|group| LensSubpaths::new(Spread::AcrossChains, (5, 1), group, 256)).collect();
        let mut cells = [0u32; 64];
        for number in 0..200 {
            let mut rows = [false; 256];
            for (i, group) in groups.iter().enumerate() {
                let [x, y] = group.stratum(number, [0.5; 2]);
                assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
                assert!(!std::mem::replace(&mut rows[(y * 256.0) as usize], true));
                if i == 3 {
                    cells[(x * 8.0) as usize * 8 + (y * 8.0) as usize] += 1;
                }
            }
        }
        // χ² with 63 degrees of freedom stays below 120 with probability 0.99998.
        let chi: f64 = cells.iter().map(|&c| (f64::from(c) - 3.125).powi(2) / 3.125).sum();
        assert!(chi < 120.0, "{chi}");
    }
}
