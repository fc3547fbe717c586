//! Seeds of Markov chains without start-up bias (Veach & Guibas 1997 §3.2; mlt.md §3.1 of the design).
//!
//! Bidirectional samples give candidates with weights whose mean is the image's brightness; systematic resampling makes
//! equally weighted seeds of them. Expectations over seeds are then exactly those of f*, whatever the chains do later.

use ajar_render::{
    math::scalar,
    path::Kind,
    rng::{Purpose, Rng},
};
use rayon::prelude::*;

use super::path::{Node, Path, Space};
use crate::bdpt::{Found, Tracer};

/// A path that a bidirectional sample found; small, since it can be found again.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Number of the sample.
    pub sample: u32,
    /// Technique.
    technique: [u8; 2],
    /// Place in the order in which seeds are spread.
    order: u64,
    /// Pixel of the window.
    pub pixel: u32,
    /// f*/p times the weight of its technique.
    pub weight: f64,
}

impl Candidate {
    /// Edges of the path.
    pub fn edges(&self) -> usize {
        usize::from(self.technique[0]) + usize::from(self.technique[1]) - 1
    }
}

/// The bidirectional samples of a round.
#[derive(Clone, Copy, Debug)]
pub struct Bootstrap<'w> {
    /// Where paths live.
    pub space: Space<'w>,
    /// Seed of all randomness.
    pub seed: u64,
    /// The round.
    pub round: u32,
    /// Number of samples.
    pub samples: u32,
}

/// Samples that a thread takes at a time.
const BLOCK: u32 = 64;

impl<'w> Bootstrap<'w> {
    /// What runs its samples.
    pub fn tracer(&self) -> Tracer<'w> {
        Tracer::new(self.space.world, self.space.max_depth, 1.0 / self.space.film_ratio)
    }

    /// All candidates, in the order of the samples.
    pub fn candidates(&self) -> Vec<Candidate> {
        self.candidates_where(|_, _| true)
    }

    /// Those for which `wanted` holds, of the kind of x_0 and whether x_1 is connectable.
    pub fn candidates_where(&self, wanted: impl Fn(Kind, bool) -> bool + Sync) -> Vec<Candidate> {
        let blocks: Vec<Vec<Candidate>> = (0..self.samples.div_ceil(BLOCK))
            .into_par_iter()
            .map_init(
                || self.tracer(),
                |tracer, block| {
                    let mut found = Vec::new();
                    if self.space.cancelled() {
                        return found;
                    }
                    let samples = block * BLOCK..((block + 1) * BLOCK).min(self.samples);
                    samples.for_each(|i| {
                        self.visit(tracer, i, |f| {
                            if wanted(f.light_kind(), f.second_is_connectable()) {
                                found.extend(self.candidate(i, f));
                            }
                        });
                    });
                    found
                },
            )
            .collect();
        blocks.concat()
    }

    /// Runs sample `index`; paths of a single edge are not for chains.
    fn visit(&self, tracer: &mut Tracer<'_>, index: u32, mut visit: impl FnMut(&Found<'_>)) {
        let mut rng = Rng::new(self.seed, Purpose::Bootstrap, self.round, index.into());
        // Hammersley's points, shifted: rows evenly spread, columns by van der Corput's sequence.
        let shift = Rng::new(self.seed, Purpose::Bootstrap, self.round, u64::MAX).next_u32();
        let column = f64::from(index.reverse_bits() ^ shift) * (1.0 / 4_294_967_296.0);
        let row = (f64::from(index) + rng.f64()) / f64::from(self.samples);
        let column = (column + rng.f64() / f64::from(self.samples)).fract();
        let raster = self.space.raster([column, row]);
        let lens = rng.pair();
        tracer.sample(raster, lens, &mut rng, |found| {
            if found.s + found.t > 2 {
                visit(found);
            }
        });
    }

    fn candidate(&self, sample: u32, found: &Found<'_>) -> Option<Candidate> {
        let ratio = if found.t == 1 { self.space.film_ratio } else { 1.0 };
        let weight = scalar(found.contribution.weighted()) * ratio;
        let pixel = self.space.pixel(found.raster)? as u32;
        (weight > 0.0 && weight.is_finite()).then(|| Candidate {
            sample,
            pixel,
            technique: [found.s as u8, found.t as u8],
            order: (found.s + found.t) as u64 >> 1 << 32 | u64::from(morton(found.raster)),
            weight,
        })
    }

    /// Builds the path of a candidate into `path`; `None` if rounding lost it.
    pub fn replay(&self, candidate: &Candidate, tracer: &mut Tracer<'_>, path: &mut Path) -> Option<()> {
        let [s, t] = candidate.technique.map(usize::from);
        path.nodes.clear();
        self.visit(tracer, candidate.sample, |found| {
            if (found.s, found.t) == (s, t) {
                found.vertices(|vertex| path.nodes.push(Node::new(vertex)));
                (path.raster, path.lens) = (found.raster, found.lens);
            }
        });
        if path.nodes.is_empty() {
            return None;
        }
        path.measure(&self.space, (0, path.edges()), s.checked_sub(1)).ok()
    }
}

/// Raster positions along a curve that keeps neighbours together (Morton 1966).
fn morton(raster: glam::DVec2) -> u32 {
    let spread = |x: u32| {
        let x = (x | x << 8) & 0x00FF_00FF;
        let x = (x | x << 4) & 0x0F0F_0F0F;
        let x = (x | x << 2) & 0x3333_3333;
        (x | x << 1) & 0x5555_5555
    };
    spread(raster.x as u32 & 0xFFFF) | spread(raster.y as u32 & 0xFFFF) << 1
}

/// Draws `count` seeds in proportion to their weights, at even steps through all candidates, sorted by length and place
/// so that the seeds spread over both. Sorts `candidates`; returns indices into them.
pub fn resample(candidates: &mut [Candidate], count: usize, rng: &mut Rng) -> Vec<u32> {
    candidates.sort_by_key(|c| (c.order, c.sample, c.technique));
    let total: f64 = candidates.iter().map(|c| c.weight).sum();
    let step = total / count as f64;
    let mut next = rng.f64() * step;
    let (mut sum, mut seeds) = (0.0, Vec::with_capacity(count));
    for (i, candidate) in candidates.iter().enumerate() {
        sum += candidate.weight;
        while next < sum && seeds.len() < count {
            seeds.push(i as u32);
            next += step;
        }
    }
    // Rounding may leave the last step just beyond the end.
    while seeds.len() < count {
        seeds.push(candidates.len() as u32 - 1);
    }
    seeds
}
