//! The integrator `mlt`: Metropolis light transport as Veach & Guibas published it, in independent rounds.

use std::sync::{Mutex, PoisonError};

use ajar_render::{
    film::RoundFilm,
    rng::{Purpose, Rng},
};

use super::{
    Mutation,
    chain::Kernel,
    chains::{Chains, STEPS, Totals},
    choice::Table,
    direct,
    mutations::mutations,
    path::{Path, Space},
    seeds::{Bootstrap, resample},
    target::{Aim, Plain},
};
use crate::{Context, Integrator, Report, Rounds, bdpt::MAX_VERTICES};

/// Mutations for each bidirectional sample of the bootstrap, which costs some ten times as much as one.
const MUTATIONS_PER_SAMPLE: u64 = 64;
/// Fewest samples of a bootstrap.
const LEAST_SAMPLES: u64 = 4096;

/// Metropolis light transport.
#[derive(Clone, Copy, Debug)]
pub struct Mlt;

impl Integrator for Mlt {
    fn name(&self) -> &'static str {
        "mlt"
    }

    fn description(&self) -> &'static str {
        "Metropolis light transport (Veach & Guibas 1997): light that takes hard ways"
    }

    fn max_depth(&self) -> usize {
        MAX_VERTICES - 2
    }

    fn prepare<'a>(&self, cx: Context<'a>) -> Box<dyn Rounds + 'a> {
        Box::new(MltRounds { chains: PlainChains::new(cx), totals: Mutex::default() })
    }
}

/// Chains that visit paths in proportion to their contribution.
pub struct PlainChains<'a> {
    /// Settings and the request to stop.
    pub cx: Context<'a>,
    /// Where paths live.
    pub space: Space<'a>,
    /// What they do, and how often.
    pub mutations: Vec<&'static dyn Mutation>,
    table: Table,
}

impl<'a> PlainChains<'a> {
    /// All mutations with their default weights.
    pub fn new(cx: Context<'a>) -> Self {
        let space = Space::of(&cx);
        let (mutations, table) = mutations(&cx.settings.mutations);
        Self { cx, space, mutations, table }
    }

    /// One round of about `mutations` mutations. `record` takes a path, its aim, and how much of the window's mean
    /// brightness its steps stand for.
    pub fn render(&self, round: u32, mutations: u64, record: impl Fn(&Path, &Aim, f64) + Sync) -> Totals {
        let seed = self.cx.settings.seed;
        let count = mutations.div_ceil(STEPS.into()).max(1) as usize;
        let samples = (mutations / MUTATIONS_PER_SAMPLE).max(LEAST_SAMPLES) as u32;
        let bootstrap = Bootstrap { space: self.space, seed, round, samples };
        let mut candidates = bootstrap.candidates();
        if candidates.is_empty() {
            return Totals { empty_rounds: 1, ..Totals::default() };
        }
        let brightness = candidates.iter().map(|c| c.weight).sum::<f64>() / f64::from(samples);
        let seeds = resample(&mut candidates, count, &mut Rng::new(seed, Purpose::Resampling, round, 0));
        let step = brightness / (count as f64 * f64::from(STEPS));
        let (mutations, table) = (self.mutations.as_slice(), &self.table);
        let kernel = Kernel { space: self.space, mutations, table, target: &Plain };
        Chains { cx: self.cx, kernel, round }.run(
            count,
            |index, tracer, path| bootstrap.replay(&candidates[seeds[index] as usize], tracer, path),
            |path, aim, steps| record(path, aim, steps * step),
        )
    }
}

struct MltRounds<'a> {
    chains: PlainChains<'a>,
    totals: Mutex<Totals>,
}

impl Rounds for MltRounds<'_> {
    fn scale(&self) -> f64 {
        1.0
    }

    fn render(&self, round: u32, film: &RoundFilm) {
        let (settings, space) = (self.chains.cx.settings, &self.chains.space);
        let pixels = space.window.pixels();
        direct::render(space, (settings.seed, round), (settings.samples_per_round / 8).max(1), film);
        let mutations = u64::from(settings.samples_per_round) * pixels as u64;
        let totals = self.chains.render(round, mutations, |path, aim, share| {
            if let Some(pixel) = space.pixel(path.raster) {
                film.add(pixel, aim.deposit * (share * pixels as f64));
            }
        });
        self.totals.lock().unwrap_or_else(PoisonError::into_inner).add(&totals);
    }

    fn report(&self) -> Report {
        let totals = self.totals.lock().unwrap_or_else(PoisonError::into_inner);
        totals.report(self.chains.mutations.iter().map(|m| m.name()))
    }
}
