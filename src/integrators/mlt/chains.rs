//! All chains of a round, in parallel.

use ajar_render::rng::{Purpose, Rng};
use rayon::prelude::*;

use super::{
    chain::{Chain, Kernel},
    path::Path,
    stats::ChainStats,
    strata::Strata,
    target::Aim,
};
use crate::{Context, Report, bdpt::Tracer};

/// Steps of a chain.
pub const STEPS: u32 = 4096;

/// Chains that share a kernel and a round. Each is a function of seed, round and its index.
#[derive(Clone, Copy)]
pub struct Chains<'a> {
    /// Settings and the request to stop.
    pub cx: Context<'a>,
    /// What they do.
    pub kernel: Kernel<'a>,
    /// The round; pilots have numbers of their own.
    pub round: u32,
}

impl<'a> Chains<'a> {
    /// Runs `count` chains of [`STEPS`] steps. `find_seed` builds the first path of each; `record` takes paths, what they
    /// aim at and the steps that they stand for.
    pub fn run(
        &self,
        count: usize,
        find_seed: impl Fn(usize, &mut Tracer<'a>, &mut Path) -> Option<()> + Sync,
        record: impl Fn(&Path, &Aim, f64) + Sync,
    ) -> Totals {
        let space = &self.kernel.space;
        let tracer = || Tracer::new(space.world, space.max_depth, 1.0 / space.film_ratio);
        let seed = self.cx.settings.seed;
        let stream = |index: usize| Rng::new(seed, Purpose::Chain, self.round, index as u64);
        let stats: Vec<Option<ChainStats>> = (0..count)
            .into_par_iter()
            .with_max_len(1)
            .map_init(
                || (tracer(), Path::with_capacity(), Chain::new(self.kernel, stream(0))),
                |(tracer, path, chain), index| {
                    if self.cx.cancelled() {
                        return None;
                    }
                    find_seed(index, tracer, path)?;
                    let key = Rng::new(seed, Purpose::Strata, self.round, 0).next_u32();
                    chain.start(path, stream(index), Strata::new(index as u32, count as u32, key.into()));
                    chain.run(STEPS, &record);
                    Some(std::mem::take(&mut chain.stats))
                },
            )
            .collect();
        let mut totals = Totals { chains: count as u64, ..Totals::default() };
        for stats in &stats {
            match stats {
                Some(stats) => totals.add_chain(stats),
                None => totals.lost_seeds += 1,
            }
        }
        totals
    }
}

/// What chains did.
#[derive(Clone, Debug, Default)]
pub struct Totals {
    /// Sums over all of them.
    pub stats: ChainStats,
    /// Number of chains.
    pub chains: u64,
    /// Seeds that rounding lost between finding and replaying them.
    pub lost_seeds: u64,
    /// Chains that waited for more than half of their steps.
    pub stuck: u64,
    /// Rounds in which nothing was found to begin with.
    pub empty_rounds: u64,
}

impl Totals {
    fn add_chain(&mut self, stats: &ChainStats) {
        self.stuck += u64::from(stats.longest_wait > STEPS / 2);
        self.stats.add(stats);
    }

    /// Adds those of other chains.
    pub fn add(&mut self, other: &Self) {
        self.stats.add(&other.stats);
        self.chains += other.chains;
        self.lost_seeds += other.lost_seeds;
        self.stuck += other.stuck;
        self.empty_rounds += other.empty_rounds;
    }

    /// Rays that a mutation casts on average.
    pub fn rays_per_mutation(&self) -> f64 {
        self.stats.rays as f64 / self.stats.steps().max(1) as f64
    }

    /// For people and programs.
    pub fn report(&self, names: impl Iterator<Item = &'static str>) -> Report {
        let mut report = Report::default();
        let mut shown = Vec::new();
        for (name, stats) in names.zip(&self.stats.mutations).filter(|(_, stats)| stats.tried > 0) {
            let rate = stats.acceptance / stats.tried as f64;
            report.numbers.push((format!("acceptance.{name}"), rate));
            report.numbers.push((format!("tried.{name}"), stats.tried as f64));
            shown.push(format!("{name} {:.0} %", 100.0 * rate));
        }
        let not_finite: u64 = self.stats.mutations.iter().map(|m| m.not_finite).sum();
        for (name, number) in [
            ("mutations", self.stats.steps() as f64),
            ("rays_per_mutation", self.rays_per_mutation()),
            ("chains", self.chains as f64),
            ("stuck_chains", self.stuck as f64),
            ("lost_seeds", self.lost_seeds as f64),
            ("mutations_not_finite", not_finite as f64),
        ] {
            report.numbers.push((name.into(), number));
        }
        if !shown.is_empty() {
            report.lines.push(format!("accepted: {}", shown.join(", ")));
        }
        if self.empty_rounds > 0 {
            report.warnings.push(format!(
                "{} rounds found no path that carries light to the camera; what they would have shown is black",
                self.empty_rounds
            ));
        }
        if not_finite > 0 {
            report
                .warnings
                .push(format!("{not_finite} mutations were dropped: their contribution was not finite"));
        }
        report
    }
}
