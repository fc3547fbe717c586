//! Seeds of Markov chains without start-up bias (Veach & Guibas 1997 §3.2; mlt.md §3.1 of the design).
//!
//! Bidirectional samples give candidates with weights whose mean is the image's brightness; systematic resampling makes
//! equally weighted seeds of them. Expectations over seeds are then exactly those of f*, whatever the chains do later.

use ajar_render::{
    math::scalar,
    rng::{Purpose, Rng},
};
use glam::DVec2;
use rayon::prelude::*;

use super::path::{Node, Path, Space};
use crate::bdpt::{Found, Tracer, Wanted};

/// A path that a bidirectional sample found; small, since it can be found again.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Number of the sample.
    pub sample: u32,
    /// Which of its takes.
    take: u16,
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
    /// Takes of the samples that fall into each pixel of the window, 1 to 65 535: pairs of an eye and a light path, whose mean
    /// counts. One everywhere if empty.
    pub takes: &'w [u32],
    /// Weight, should nothing be in the way, from which on Russian roulette spares a connection for certain; 0 spares all.
    pub least: f64,
}

/// Samples that a thread takes at a time.
const BLOCK: u32 = 64;

impl<'w> Bootstrap<'w> {
    /// Samples of one take each, all of whose connections are looked at.
    pub fn new(space: Space<'w>, (seed, round): (u64, u32), samples: u32) -> Self {
        Self { space, seed, round, samples, takes: &[], least: 0.0 }
    }

    /// What runs its samples.
    pub fn tracer(&self) -> Tracer<'w> {
        Tracer::new(self.space.world, self.space.max_depth, 1.0 / self.space.film_ratio)
            .with_roulette_below(self.least)
    }

    /// All candidates, in the order of the samples.
    pub fn candidates(&self) -> Vec<Candidate> {
        self.collect(|| (self.tracer(), ()), |(), candidate, _| Some(candidate))
    }

    /// Those that `weigh` finds worth something, their weights multiplied by what it says of their paths.
    pub fn candidates_worth<'a>(
        &self,
        wanted: Wanted<'a>,
        weigh: impl Fn(&Path) -> f64 + Sync,
    ) -> Vec<Candidate>
    where
        'w: 'a,
    {
        let memory = || (self.tracer().only(wanted), Path::with_capacity());
        self.collect(memory, |path, candidate, found| {
            self.build(path, found)?;
            let weight = candidate.weight * weigh(path);
            (weight > 0.0).then_some(Candidate { weight, ..candidate })
        })
    }

    fn collect<'a, T>(
        &self,
        memory: impl Fn() -> (Tracer<'a>, T) + Sync + Send,
        keep: impl Fn(&mut T, Candidate, &Found<'_>) -> Option<Candidate> + Sync,
    ) -> Vec<Candidate> {
        let blocks: Vec<Vec<Candidate>> = (0..self.samples.div_ceil(BLOCK))
            .into_par_iter()
            .map_init(memory, |(tracer, memory), block| {
                let mut kept = Vec::new();
                if self.space.cancelled() {
                    return kept;
                }
                for i in block * BLOCK..((block + 1) * BLOCK).min(self.samples) {
                    let takes = self.takes(self.place(i));
                    for take in 0..takes as u16 {
                        self.visit(tracer, (i, take), |found| {
                            let candidate = self.candidate((i, take), found, 1.0 / f64::from(takes));
                            kept.extend(candidate.and_then(|c| keep(memory, c, found)));
                        });
                    }
                }
                kept
            })
            .collect();
        blocks.concat()
    }

    /// Builds the path that a technique found; `None` if rounding lost it.
    fn build(&self, path: &mut Path, found: &Found<'_>) -> Option<()> {
        path.nodes.clear();
        found.vertices(|vertex| path.nodes.push(Node::new(vertex)));
        (path.raster, path.lens) = (found.raster, found.lens);
        path.measure(&self.space, (0, path.edges()), found.s.checked_sub(1)).ok()
    }

    fn rng(&self, index: u64) -> Rng {
        Rng::new(self.seed, Purpose::Bootstrap, self.round, index)
    }

    /// Raster position of sample `index`, in pixels: Hammersley's points, shifted. Rows are evenly spread, columns follow van
    /// der Corput's sequence.
    fn place(&self, index: u32) -> DVec2 {
        let mut rng = self.rng(index.into());
        let shift = self.rng(u64::MAX).next_u32();
        let column = f64::from(index.reverse_bits() ^ shift) * (1.0 / 4_294_967_296.0);
        let row = (f64::from(index) + rng.f64()) / f64::from(self.samples);
        let column = (column + rng.f64() / f64::from(self.samples)).fract();
        self.space.raster([column, row])
    }

    /// Takes of a sample at `raster`.
    fn takes(&self, raster: DVec2) -> u32 {
        self.space.pixel(raster).and_then(|pixel| self.takes.get(pixel)).map_or(1, |takes| *takes)
    }

    /// Runs a take of sample `index`; paths of a single edge are not for chains.
    fn visit(&self, tracer: &mut Tracer<'_>, (index, take): (u32, u16), mut visit: impl FnMut(&Found<'_>)) {
        let mut rng = self.rng(u64::from(index) | (u64::from(take) + 1) << 32);
        let mut raster = self.place(index);
        if self.takes(raster) > 1 {
            raster = raster.floor() + DVec2::from(rng.pair());
        }
        let lens = rng.pair();
        tracer.sample(raster, lens, &mut rng, |found| {
            if found.s + found.t > 2 {
                visit(found);
            }
        });
    }

    fn candidate(&self, (sample, take): (u32, u16), found: &Found<'_>, share: f64) -> Option<Candidate> {
        let ratio = if found.t == 1 { self.space.film_ratio } else { 1.0 };
        let weight = scalar(found.contribution.weighted()) * ratio * share;
        let pixel = self.space.pixel(found.raster)? as u32;
        (weight > 0.0 && weight.is_finite()).then(|| Candidate {
            sample,
            take,
            pixel,
            technique: [found.s as u8, found.t as u8],
            order: (found.s + found.t) as u64 >> 1 << 32 | u64::from(morton(found.raster)),
            weight,
        })
    }

    /// Builds the path of a candidate into `path`; `None` if rounding lost it.
    pub fn replay(&self, candidate: &Candidate, tracer: &mut Tracer<'_>, path: &mut Path) -> Option<()> {
        let [s, t] = candidate.technique.map(usize::from);
        let mut built = None;
        self.visit(tracer, (candidate.sample, candidate.take), |found| {
            if (found.s, found.t) == (s, t) {
                built = self.build(path, found);
            }
        });
        built
    }
}

/// Raster positions along a curve that keeps neighbours together (Morton 1966).
fn morton(raster: DVec2) -> u32 {
    let spread = |x: u32| {
        let x = (x | x << 8) & 0x00FF_00FF;
        let x = (x | x << 4) & 0x0F0F_0F0F;
        let x = (x | x << 2) & 0x3333_3333;
        (x | x << 1) & 0x5555_5555
    };
    spread(raster.x as u32 & 0xFFFF) | spread(raster.y as u32 & 0xFFFF) << 1
}

/// How evenly the places that chains may start from share what they carry: a few heavy ones make a noisy round.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pool {
    /// Paths of bidirectional samples, and pixels of the base that left something to chains.
    pub size: u64,
    /// What all of them carry.
    pub total: f64,
    /// What the heaviest thousandth of them, at least one, carries.
    pub heaviest: f64,
}

impl Pool {
    /// Of the weights of all of them.
    pub fn of(weights: impl Iterator<Item = f64>) -> Self {
        let mut weights: Vec<f64> = weights.filter(|weight| *weight > 0.0).collect();
        let heavy = weights.len().div_ceil(1000);
        if heavy < weights.len() {
            weights.select_nth_unstable_by(heavy, |a, b| b.total_cmp(a));
        }
        Self {
            size: weights.len() as u64,
            total: weights.iter().sum(),
            heaviest: weights[..heavy].iter().sum(),
        }
    }

    /// Adds those of another round.
    pub fn add(&mut self, other: &Self) {
        self.size += other.size;
        self.total += other.total;
        self.heaviest += other.heaviest;
    }

    /// The share that the heaviest thousandth carries.
    pub fn heavy_share(&self) -> f64 {
        if self.total > 0.0 { self.heaviest / self.total } else { 0.0 }
    }
}

/// Draws `count` seeds in proportion to their weights, at even steps through all candidates, sorted by length and place
/// so that the seeds spread over both. Sorts `candidates`; returns indices into them.
pub fn resample(candidates: &mut [Candidate], count: usize, rng: &mut Rng) -> Vec<u32> {
    candidates.par_sort_unstable_by_key(|c| (c.order, c.sample, c.take, c.technique));
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
