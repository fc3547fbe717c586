//! The integrator `mlt`: Metropolis light transport as Veach & Guibas published it, in independent rounds.

use std::sync::Mutex;

use ajar_render::{
    film::RoundFilm,
    rng::{Purpose, Rng},
};
use rayon::prelude::*;

use super::{
    Mutation,
    chain::{Chain, Kernel},
    choice::Table,
    direct,
    mutations::{Bidirectional, Caustic, Lens, MultiChain, Technique, Window},
    path::{Path, Space},
    seeds::{Bootstrap, Candidate, resample},
    stats::ChainStats,
    target::Plain,
};
use crate::{Context, Integrator, Report, Rounds, bdpt::MAX_VERTICES};

/// Steps of a chain.
const STEPS: u32 = 4096;
/// Mutations for each bidirectional sample of the bootstrap, which costs some ten times as much as one.
const MUTATIONS_PER_SAMPLE: u64 = 128;
/// Fewest samples of a bootstrap.
const LEAST_SAMPLES: u64 = 4096;

/// All mutations with their weights where nothing is known about the path.
pub fn mutations() -> [(&'static dyn Mutation, f64); 6] {
    [
        (&Bidirectional, 0.25),
        (&Lens, 0.4),
        (&Caustic, 0.1),
        (&MultiChain, 0.4),
        (&Window, 0.2),
        (&Technique, 0.05),
    ]
}

/// Metropolis light transport.
#[derive(Clone, Copy, Debug)]
pub struct Mlt;

impl Integrator for Mlt {
    fn name(&self) -> &'static str {
        "mlt"
    }

    fn description(&self) -> &'static str {
        "Metropolis light transport: light that takes hard ways"
    }

    fn max_depth(&self) -> usize {
        MAX_VERTICES - 2
    }

    fn prepare<'a>(&self, cx: Context<'a>) -> Box<dyn Rounds + 'a> {
        let space = Space::new(cx.world, cx.settings.window, cx.settings.max_depth);
        let (mutations, weights): (Vec<_>, Vec<_>) = mutations().into_iter().unzip();
        let table = Table::uniform(&weights);
        Box::new(MltRounds { cx, space, mutations, table, stats: Mutex::default() })
    }
}

struct MltRounds<'a> {
    cx: Context<'a>,
    space: Space<'a>,
    mutations: Vec<&'static dyn Mutation>,
    table: Table,
    stats: Mutex<Totals>,
}

#[derive(Default)]
struct Totals {
    chains: ChainStats,
    chain_count: u64,
    lost_seeds: u64,
    empty_rounds: u64,
}

impl Rounds for MltRounds<'_> {
    fn scale(&self) -> f64 {
        1.0
    }

    fn render(&self, round: u32, film: &RoundFilm) {
        let settings = self.cx.settings;
        let steps = u64::from(settings.samples_per_round) * self.space.window.pixels() as u64;
        let chains = steps.div_ceil(STEPS.into()).max(1) as usize;
        let samples = (steps / MUTATIONS_PER_SAMPLE).max(LEAST_SAMPLES) as u32;
        let bootstrap = Bootstrap { space: self.space, seed: settings.seed, round, samples };
        let mut candidates = bootstrap.candidates();
        direct::render(&self.space, (settings.seed, round), (settings.samples_per_round / 8).max(1), film);
        let brightness = candidates.iter().map(|c| c.weight).sum::<f64>() / f64::from(samples);
        if candidates.is_empty() {
            self.totals(|totals| totals.empty_rounds += 1);
            return;
        }
        let mut rng = Rng::new(settings.seed, Purpose::Resampling, round, 0);
        let seeds = resample(&mut candidates, chains, &mut rng);
        let value = brightness * self.space.window.pixels() as f64 / (chains as f64 * f64::from(STEPS));
        self.run_chains(&bootstrap, &candidates, &seeds, value, film);
    }

    fn report(&self) -> Report {
        let mut report = Report::default();
        self.totals(|totals| {
            for (mutation, stats) in self.mutations.iter().zip(&totals.chains.mutations) {
                if stats.tried > 0 {
                    let rate = stats.acceptance / stats.tried as f64;
                    report.numbers.push((format!("acceptance.{}", mutation.name()), rate));
                    report.numbers.push((format!("tried.{}", mutation.name()), stats.tried as f64));
                }
            }
            let steps = totals.chains.steps().max(1) as f64;
            report.numbers.push(("mutations".into(), steps));
            report.numbers.push(("rays_per_mutation".into(), totals.chains.rays as f64 / steps));
            report.numbers.push(("lost_seeds".into(), totals.lost_seeds as f64));
            report.numbers.push(("chains".into(), totals.chain_count as f64));
            report.numbers.push(("longest_wait".into(), totals.chains.longest_wait.into()));
            if totals.empty_rounds > 0 {
                report
                    .warnings
                    .push(format!("{} rounds found no path that carries light", totals.empty_rounds));
            }
        });
        report
    }
}

impl MltRounds<'_> {
    fn totals(&self, change: impl FnOnce(&mut Totals)) {
        // Counts stay true even if a thread panicked while it held the lock.
        change(&mut self.stats.lock().unwrap_or_else(std::sync::PoisonError::into_inner));
    }

    fn run_chains(
        &self,
        bootstrap: &Bootstrap<'_>,
        candidates: &[Candidate],
        seeds: &[u32],
        value: f64,
        film: &RoundFilm,
    ) {
        let kernel =
            Kernel { space: self.space, mutations: &self.mutations, table: &self.table, target: &Plain };
        let stream =
            |index: usize| Rng::new(self.cx.settings.seed, Purpose::Chain, bootstrap.round, index as u64);
        seeds.par_iter().enumerate().with_max_len(1).for_each_init(
            || (bootstrap.tracer(), Path::with_capacity(), Chain::new(kernel, stream(0))),
            |(tracer, path, chain), (index, &seed)| {
                if self.cx.cancelled() {
                    return;
                }
                chain.stats = ChainStats::default();
                let replayed = bootstrap.replay(&candidates[seed as usize], tracer, path);
                if replayed.is_some() {
                    chain.start(path, stream(index));
                    chain.run(STEPS, |path, aim, steps| {
                        if let Some(pixel) = self.space.pixel(path.raster) {
                            film.add(pixel, aim.deposit * (steps * value));
                        }
                    });
                }
                self.totals(|totals| {
                    totals.chains.add(&chain.stats);
                    totals.chain_count += 1;
                    totals.lost_seeds += u64::from(replayed.is_none());
                });
            },
        );
    }
}
