//! All chains of a round, in parallel.

use ajar_render::rng::{Purpose, Rng};
use rayon::prelude::*;

use super::{
    chain::{Chain, Kernel},
    choice::Learner,
    lens_subpaths::{LensSubpaths, REUSE, Spread},
    path::Path,
    seeds::Pool,
    stats::ChainStats,
    target::Aim,
};
use crate::{Context, Report, bdpt::Tracer};

/// Chains that share a kernel and a round. Each is a function of seed, round and its index.
#[derive(Clone, Copy)]
pub struct Chains<'a> {
    /// Settings and the request to stop.
    pub cx: Context<'a>,
    /// What they do.
    pub kernel: Kernel<'a>,
    /// The round; pilots have numbers of their own.
    pub round: u32,
    /// Mutations of each chain.
    pub length: u32,
    /// Whether to learn which mutations serve which paths.
    pub learning: bool,
}

/// What one group of chains did: counts of each that had a seed.
struct Group {
    stats: Vec<Option<ChainStats>>,
    learner: Option<Box<Learner>>,
}

impl<'a> Chains<'a> {
    /// Runs `count` chains. `find_seed` builds the first path of each, by a `tracer` for each group of chains; `record` takes
    /// the chain's index, paths, what they aim at and the steps that they stand for.
    pub fn run<'t>(
        &self,
        count: usize,
        tracer: impl Fn() -> Tracer<'t> + Sync + Send,
        find_seed: impl Fn(usize, &mut Tracer<'t>, &mut Path) -> Option<()> + Sync,
        record: impl Fn(usize, &Path, &Aim, f64) + Sync,
    ) -> Totals {
        let (seed, metropolis) = (self.cx.settings.seed, &self.cx.settings.metropolis);
        let stream = |index: usize| Rng::new(seed, Purpose::Chain, self.round, index as u64);
        // Chains of a group are far apart in the order of seeds; those of a list share nothing.
        let size = if metropolis.lens_subpaths == Spread::List { 1 } else { REUSE };
        let groups = count.div_ceil(size);
        let found: Vec<Group> = (0..groups)
            .into_par_iter()
            .with_max_len(1)
            .map_init(
                || (tracer(), Path::with_capacity(), Chain::new(self.kernel, stream(0))),
                |(tracer, path, chain), group| {
                    let keys = (seed, self.round);
                    chain.share(LensSubpaths::new(
                        metropolis.lens_subpaths,
                        keys,
                        group as u32,
                        groups as u32,
                    ));
                    chain.learner = self.learning.then(Box::default);
                    let run = |index: usize| {
                        if self.cx.cancelled() {
                            return None;
                        }
                        find_seed(index, tracer, path)?;
                        chain.start(path, stream(index));
                        chain.run(self.length, |path, aim, steps| record(index, path, aim, steps));
                        Some(std::mem::take(&mut chain.stats))
                    };
                    let stats = (group..count).step_by(groups).map(run).collect();
                    Group { stats, learner: chain.learner.take() }
                },
            )
            .collect();
        let mut totals = Totals { chains: count as u64, ..Totals::default() };
        for Group { stats, learner } in found {
            for stats in stats {
                match stats {
                    Some(stats) => totals.add_chain(&stats, self.length),
                    None => totals.lost_seeds += u64::from(!self.cx.cancelled()),
                }
            }
            if let Some(learner) = learner {
                totals.learned.get_or_insert_default().add(&learner);
            }
        }
        totals
    }
}

/// Share of the heaviest thousandth of candidates that is worth a remark.
const UNEVEN: f64 = 0.3;
/// Share of seeds lost to rounding that may darken the image.
const LOST: f64 = 1e-3;

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
    /// Samples that looked for something in those.
    pub samples_in_vain: u64,
    /// What they began from, where bidirectional samples found it.
    pub pool: Pool,
    /// What chains learned, if they were asked to.
    pub learned: Option<Box<Learner>>,
}

impl Totals {
    fn add_chain(&mut self, stats: &ChainStats, length: u32) {
        self.stuck += u64::from(stats.longest_wait > length / 2);
        self.stats.add(stats);
    }

    /// Adds those of other chains.
    pub fn add(&mut self, other: &Self) {
        self.stats.add(&other.stats);
        self.chains += other.chains;
        self.lost_seeds += other.lost_seeds;
        self.stuck += other.stuck;
        self.empty_rounds += other.empty_rounds;
        self.samples_in_vain += other.samples_in_vain;
        self.pool.add(&other.pool);
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
            ("seed_candidates", self.pool.size as f64),
            ("heaviest_thousandth_of_candidates", self.pool.heavy_share()),
            ("empty_rounds", self.empty_rounds as f64),
            ("samples_in_vain", self.samples_in_vain as f64),
        ] {
            report.numbers.push((name.into(), number));
        }
        if !shown.is_empty() {
            report.lines.push(format!("accepted: {}", shown.join(", ")));
        }
        if self.stuck > 0 {
            report
                .lines
                .push(format!("{} of {} chains were stuck for half their length", self.stuck, self.chains));
        }
        if self.pool.heavy_share() > UNEVEN {
            report.lines.push(format!(
                "a thousandth of the paths that chains start from carry {:.0} % of the light: rounds differ much",
                100.0 * self.pool.heavy_share()
            ));
        }
        if self.empty_rounds > 0 {
            report.warnings.push(format!(
                "{} rounds found no path that carries light to the camera among {} samples; what they would have \
                 shown is black",
                self.empty_rounds, self.samples_in_vain
            ));
        }
        if self.lost_seeds as f64 > LOST * self.chains as f64 {
            report.warnings.push(format!(
                "rounding lost the start of {} of {} chains: what they would have shown is missing",
                self.lost_seeds, self.chains
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
