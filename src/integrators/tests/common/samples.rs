//! Paths drawn exactly from a target, by way of bidirectional samples.

use ajar_integrators::{
    Settings,
    mlt::{
        path::{Path, Space},
        seeds::{Bootstrap, Candidate, resample},
        target::Target,
    },
};
use ajar_render::rng::{Purpose, Rng};
use rayon::prelude::*;

/// Equally weighted paths, in groups of which each comes from one bidirectional sample: what is independent are the
/// groups, for copies of a heavy path are not.
pub struct Samples<'w> {
    pub bootstrap: Bootstrap<'w>,
    candidates: Vec<Candidate>,
    /// Sample, number of the path, and its candidate; sorted.
    chosen: Vec<(u32, usize, u32)>,
}

impl<'w> Samples<'w> {
    /// `count` paths of a round of its own.
    pub fn draw(
        space: Space<'w>,
        settings: &Settings,
        target: &dyn Target,
        (round, count): (u32, usize),
    ) -> Self {
        let bootstrap = Bootstrap::new(space, (settings.seed, round), count as u32);
        let mut candidates = bootstrap.candidates();
        weigh(&bootstrap, &mut candidates, target);
        let seeds = resample(&mut candidates, count, &mut Rng::new(settings.seed, Purpose::Test, 0, 1));
        let mut chosen: Vec<_> =
            seeds.iter().enumerate().map(|(i, &seed)| (candidates[seed as usize].sample, i, seed)).collect();
        chosen.sort_unstable();
        Self { bootstrap, candidates, chosen }
    }

    /// The groups of one of `blocks` parts: numbers of paths and their candidates.
    pub fn groups(
        &self,
        block: usize,
        blocks: usize,
    ) -> impl Iterator<Item = impl Iterator<Item = (usize, &Candidate)>> {
        self.chosen
            .chunk_by(|a, b| a.0 == b.0)
            .filter(move |group| group[0].0 as usize % blocks == block)
            .map(|group| group.iter().map(|&(_, i, seed)| (i, &self.candidates[seed as usize])))
    }
}

/// Makes the weights of candidates those of the target.
fn weigh(bootstrap: &Bootstrap<'_>, candidates: &mut [Candidate], target: &dyn Target) {
    candidates.par_iter_mut().for_each_init(
        || (bootstrap.tracer(), Path::with_capacity()),
        |(tracer, path), candidate| {
            let found = bootstrap.replay(candidate, tracer, path);
            candidate.weight *= found.map_or(0.0, |()| target.aim(path).weight);
        },
    );
}
