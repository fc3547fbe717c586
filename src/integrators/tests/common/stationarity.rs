//! "Getting it right" (Geweke 2004; mlt.md §8 V5): chains that start from exact samples of the target must not leave it.
//!
//! Each seed is compared with what its own chain becomes, so that the noise of the seeds cancels. What is independent are
//! the samples that gave the seeds: all chains from paths of one sample, copies of a heavy path among them, count as one.

use ajar_integrators::{
    Settings,
    mlt::{
        Mutation,
        chain::{Chain, Kernel},
        choice::{CLASSES, Table, class},
        lens_subpaths::{LensSubpaths, Spread},
        path::{Path, Space},
        target::Target,
    },
};
use ajar_render::{
    World,
    rng::{Purpose, Rng},
};
use rayon::prelude::*;

use super::samples::Samples;

const TILES: usize = 4;
const LENGTHS: usize = 8;
const COUNT: usize = TILES * TILES * LENGTHS + CLASSES + TILES * TILES + LENGTHS + 6;

/// Indices of the test functions that are 1 at a path.
fn features(path: &Path, world: &World) -> [usize; 6] {
    let tile = |x: f64, n: u32| ((x / f64::from(n) * TILES as f64) as usize).min(TILES - 1);
    let tile = tile(path.raster.y, world.camera.height) * TILES + tile(path.raster.x, world.camera.width);
    let length = path.edges().min(LENGTHS - 1);
    let red = ((path.f.x / (3.0 * path.scalar()) * 3.0) as usize).min(2);
    let far = path.nodes[path.edges() - 1].edge.length;
    let depth = if far < 3.5 {
        0
    } else if far < 4.3 {
        1
    } else {
        2
    };
    let (a, b, c) = (TILES * TILES * LENGTHS, CLASSES, TILES * TILES);
    [
        tile * LENGTHS + length,
        a + class(&path.signature),
        a + b + tile,
        a + b + c + length,
        a + b + c + LENGTHS + red,
        a + b + c + LENGTHS + 3 + depth,
    ]
}

/// How far a kernel moves the distribution, over test functions that have at least 1 % of the energy: the largest |z|,
/// and the mean of z² in standard deviations above what it is by chance.
#[derive(Clone, Copy, Debug)]
pub struct Drift {
    pub largest_z: f64,
    pub excess: f64,
    pub acceptance: f64,
}

impl Drift {
    pub fn is_none(&self) -> bool {
        self.largest_z < 4.5 && self.excess < 5.0
    }
}

/// Blocks of seeds, whose signs are as good as random where there is no drift.
const BLOCKS: usize = 64;
const FLIPS: u32 = 400;

/// Mean of the squares of sums over blocks with given signs. `z` holds each block's part of each z.
fn mean_square(z: &[[f64; BLOCKS]], sign: impl Fn(usize) -> f64) -> f64 {
    let square = |parts: &[f64; BLOCKS]| {
        parts.iter().enumerate().map(|(block, part)| sign(block) * part).sum::<f64>().powi(2)
    };
    z.iter().map(square).sum::<f64>() / z.len().max(1) as f64
}

/// The mean of z² against what random signs of the blocks make of it: test functions overlap, so that no table tells.
fn excess(z: &[[f64; BLOCKS]]) -> f64 {
    let flipped: Vec<f64> = (0..FLIPS)
        .map(|flip| {
            let mut rng = Rng::new(0, Purpose::Test, flip, 0);
            let bits = u64::from(rng.next_u32()) << 32 | u64::from(rng.next_u32());
            mean_square(z, |block| if bits >> block & 1 == 1 { 1.0 } else { -1.0 })
        })
        .collect();
    let n = f64::from(FLIPS);
    let mean = flipped.iter().sum::<f64>() / n;
    let variance = flipped.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    (mean_square(z, |_| 1.0) - mean) / variance.sqrt().max(1e-12)
}

/// Runs `mutations`, chosen by `table`, for `steps` steps from each of `seeds` seeds.
pub fn drift(
    world: &World,
    settings: &Settings,
    (mutations, table): (&[&dyn Mutation], &Table),
    target: &dyn Target,
    steps: u32,
    seeds: usize,
) -> Drift {
    let space = Space::new(world, settings.window, settings.max_depth);
    let samples = Samples::draw(space, settings, target, (steps, seeds));
    let kernel = Kernel { space, mutations, table, target };
    let stream = |i: usize| Rng::new(settings.seed, Purpose::Chain, steps, i as u64);
    let blocks: Vec<_> = (0..BLOCKS)
        .into_par_iter()
        .map(|block| {
            let (mut tracer, mut path) = (samples.bootstrap.tracer(), Path::with_capacity());
            let mut chain = Chain::new(kernel, stream(0));
            let mut sums = [[0.0; 3]; COUNT];
            for group in samples.groups(block, BLOCKS) {
                let mut change = Vec::<(usize, f64)>::new();
                for (i, candidate) in group {
                    if samples.bootstrap.replay(candidate, &mut tracer, &mut path).is_none() {
                        continue;
                    }
                    chain.share(LensSubpaths::new(
                        Spread::AcrossChains,
                        (settings.seed, steps),
                        i as u32,
                        seeds as u32,
                    ));
                    chain.start(&path, stream(i));
                    for q in features(&path, world) {
                        change.push((q, -1.0));
                        sums[q][2] += 1.0;
                    }
                    chain.run(steps, |path, _, weight| {
                        change.extend(features(path, world).map(|q| (q, weight / f64::from(steps))));
                    });
                }
                change.sort_by_key(|c| c.0);
                for run in change.chunk_by(|a, b| a.0 == b.0) {
                    let d: f64 = run.iter().map(|c| c.1).sum();
                    sums[run[0].0][0] += d;
                    sums[run[0].0][1] += d * d;
                }
            }
            (sums, chain.stats)
        })
        .collect();
    let n = seeds as f64;
    let (mut largest_z, mut parts) = (0f64, Vec::new());
    for q in 0..COUNT {
        let [sum, squares, share] =
            std::array::from_fn(|j| blocks.iter().map(|(sums, _)| sums[q][j]).sum::<f64>());
        let variance = squares / n - (sum / n).powi(2);
        // What hardly ever changes tells nothing: rare large changes are far from normal.
        if share < 0.01 * n || variance < 1e-4 * share / n {
            continue;
        }
        let error = (variance * n).sqrt();
        largest_z = largest_z.max((sum / error).abs());
        parts
            .push(std::array::from_fn(|block| blocks.get(block).map_or(0.0, |(sums, _)| sums[q][0] / error)));
    }
    let tried: u64 = blocks.iter().map(|(_, s)| s.steps()).sum();
    let accepted: f64 = blocks.iter().flat_map(|(_, s)| s.mutations.iter().map(|m| m.acceptance)).sum();
    Drift {
        largest_z,
        excess: if parts.is_empty() { 0.0 } else { excess(&parts) },
        acceptance: accepted / tried.max(1) as f64,
    }
}
