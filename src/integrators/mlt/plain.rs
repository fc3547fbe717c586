//! The integrator `mlt`: Metropolis light transport as Veach & Guibas published it, in independent rounds.

use std::sync::{Mutex, PoisonError};

use ajar_render::{
    film::RoundFilm,
    rng::{Purpose, Rng},
};

use super::{
    Mutation,
    chain::Kernel,
    chains::{Chains, Totals},
    choice::{Choice, Table},
    direct, first_look,
    mutations::mutations,
    path::{Path, Space},
    seeds::{Bootstrap, Candidate, Pool, resample},
    target::{Aim, Plain, Relative, Target},
};
use crate::{Context, Integrator, Report, Rounds, bdpt::MAX_VERTICES};

/// Mutations for each bidirectional sample of the bootstrap, which costs some fifteen times as much as one: a third of the
/// time and more goes into seeds. A rare path that few samples find is the start of many chains, and a firefly.
const MUTATIONS_PER_SAMPLE: u64 = 24;
/// Fewest samples of a bootstrap, and most that are tried to find light at all.
const LEAST_SAMPLES: u32 = 1 << 12;
const MOST_SAMPLES: u32 = 1 << 20;
/// Paths that a bootstrap should find.
const FEW_CANDIDATES: u64 = 256;
/// Weight of a candidate, relative to the brightness of the image, below which it is not always looked at: a chain begins at
/// one that weighs some twenty times the brightness.
const DIM: f64 = 0.25;
/// Round number of the pilot that learns.
const LEARNING_ROUND: u32 = u32::MAX - 3;

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
        let mut chains = PlainChains::new(cx);
        chains.takes = first_look::efforts(&chains.space, cx.settings);
        chains.least = DIM * chains.brightness;
        Box::new(MltRounds { chains, totals: Mutex::default() })
    }
}

/// What chains are to do in a round.
#[derive(Clone, Copy, Debug)]
pub struct Run<'b> {
    /// The round; pilots have numbers of their own.
    pub round: u32,
    /// Mutations of all chains, about.
    pub mutations: u64,
    /// Mutations for each bidirectional sample that looks for seeds.
    pub mutations_per_sample: u64,
    /// Mutations of each chain.
    pub length: u32,
    /// If given, paths are visited in proportion to their contributions relative to this brightness of each pixel.
    pub relative_to: Option<&'b [f64]>,
    /// Whether to learn which mutations serve which paths.
    pub learning: bool,
}

/// Chains that visit paths in proportion to their contribution.
pub struct PlainChains<'a> {
    /// Settings and the request to stop.
    pub cx: Context<'a>,
    /// Where paths live.
    pub space: Space<'a>,
    /// What they do, and how often.
    pub mutations: Vec<&'static dyn Mutation>,
    /// How often.
    pub table: Table,
    /// Takes of the bidirectional samples at each pixel, as [`Bootstrap`] has them.
    takes: Vec<u32>,
    /// Weight from which on candidates are always looked at.
    least: f64,
    /// About the mean brightness of the image, without what may be fireflies; 0 if it is dark.
    brightness: f64,
    /// Fewest bidirectional samples of a round.
    least_samples: u32,
    /// Bidirectional samples that found no light, if the search for it was given up.
    pub dark_after: Option<u32>,
}

impl<'a> PlainChains<'a> {
    /// All mutations with the weights that the settings ask for.
    pub fn new(cx: Context<'a>) -> Self {
        let space = Space::of(&cx);
        let (mutations, usual) = mutations(&cx.settings.metropolis.weights);
        let choice = cx.settings.metropolis.choice;
        let table = if choice == Choice::Fixed { usual.clone() } else { usual.equal() };
        let (takes, least_samples) = (Vec::new(), LEAST_SAMPLES);
        let mut chains = Self {
            cx,
            space,
            mutations,
            table,
            takes,
            least: 0.0,
            brightness: 0.0,
            least_samples,
            dark_after: None,
        };
        chains.look_for_light();
        if choice == Choice::Learned {
            let count = (space.window.pixels() as u64).clamp(1 << 17, 1 << 21);
            let learned = chains
                .render(&Run { learning: true, ..chains.run(LEARNING_ROUND, count) }, |_, _, _, _| ())
                .learned;
            chains.table = learned.map_or_else(|| usual.clone(), |learner| learner.table(&usual));
        }
        chains
    }

    /// Finds how many bidirectional samples it takes to find a few paths that carry light, and about how much. It depends on
    /// world, settings and seed alone, so that rounds stay unbiased.
    fn look_for_light(&mut self) {
        let found = |samples| {
            let candidates = self.bootstrap(LEARNING_ROUND, samples).candidates();
            Pool::of(candidates.iter().map(|c| c.weight))
        };
        let mut samples = LEAST_SAMPLES;
        let mut pool = found(samples);
        while pool.size < FEW_CANDIDATES && samples < MOST_SAMPLES {
            samples *= 4;
            pool = found(samples);
        }
        let dark = pool.size == 0 && !self.cx.cancelled();
        (self.least_samples, self.dark_after) = (samples, dark.then_some(samples));
        self.brightness = (pool.total - pool.heaviest) / f64::from(samples);
    }

    /// A usual run of chains as long as the settings say.
    pub fn run(&self, round: u32, mutations: u64) -> Run<'static> {
        let length = self.cx.settings.metropolis.chain_length;
        let mutations_per_sample = MUTATIONS_PER_SAMPLE;
        Run { round, mutations, mutations_per_sample, length, relative_to: None, learning: false }
    }

    fn bootstrap(&self, round: u32, samples: u32) -> Bootstrap<'_> {
        let usual = Bootstrap::new(self.space, (self.cx.settings.seed, round), samples);
        Bootstrap { takes: &self.takes, least: self.least, ..usual }
    }

    /// One round. `record` takes what the chain began from, a path, its aim, and how much of the window's mean brightness its
    /// steps stand for.
    pub fn render(&self, run: &Run<'_>, record: impl Fn(&Candidate, &Path, &Aim, f64) + Sync) -> Totals {
        let Run { round, mutations, mutations_per_sample, length, relative_to, learning } = *run;
        let relative = relative_to.map(|brightness| Relative { space: self.space, brightness });
        let target: &dyn Target = relative.as_ref().map_or(&Plain, |relative| relative);
        let count = mutations.div_ceil(length.into()).max(1) as usize;
        let samples = (mutations / mutations_per_sample).max(self.least_samples.into()) as u32;
        let bootstrap = self.bootstrap(round, samples);
        let mut candidates = bootstrap.candidates();
        for candidate in &mut candidates {
            candidate.weight /= relative_to.map_or(1.0, |brightness| brightness[candidate.pixel as usize]);
        }
        if candidates.is_empty() {
            return Totals { empty_rounds: 1, samples_in_vain: samples.into(), ..Totals::default() };
        }
        let pool = Pool::of(candidates.iter().map(|c| c.weight));
        let brightness = candidates.iter().map(|c| c.weight).sum::<f64>() / f64::from(samples);
        let mut rng = Rng::new(self.cx.settings.seed, Purpose::Resampling, round, 0);
        let seeds = resample(&mut candidates, count, &mut rng);
        let step = brightness / (count as f64 * f64::from(length));
        let (mutations, table) = (self.mutations.as_slice(), &self.table);
        let kernel = Kernel { space: self.space, mutations, table, target };
        let start = |index: usize| &candidates[seeds[index] as usize];
        let totals = Chains { cx: self.cx, kernel, round, length, learning }.run(
            count,
            || bootstrap.tracer(),
            |index, tracer, path| bootstrap.replay(start(index), tracer, path),
            |index, path, aim, steps| record(start(index), path, aim, steps * step),
        );
        Totals { pool, ..totals }
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
        let totals = self.chains.render(&self.chains.run(round, mutations), |_, path, aim, share| {
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
