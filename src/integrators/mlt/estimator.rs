//! The integrator `ajar`: path tracing, and Metropolis light transport for what path tracing is bad at.

use std::sync::{Mutex, PoisonError};

use ajar_render::{
    film::RoundFilm,
    rng::{Purpose, Rng},
};

use super::{
    Mutation,
    base::{self, Split},
    chain::Kernel,
    chains::{Chains, Totals},
    choice::Table,
    path::Space,
    pilot::{Plan, plan},
    plain::PlainChains,
    seeds::{Bootstrap, Candidate, Pool},
};
use crate::{Context, Integrator, Report, Rounds, bdpt::MAX_VERTICES, path::PathTracer};

/// The estimator that needs no expertise.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ajar {
    /// Run chains even where they do not pay.
    pub always: bool,
}

impl Integrator for Ajar {
    fn name(&self) -> &'static str {
        "ajar"
    }

    fn description(&self) -> &'static str {
        "path tracing, with Metropolis light transport for what it is bad at: the default"
    }

    fn max_depth(&self) -> usize {
        MAX_VERTICES - 2
    }

    fn samples_per_round(&self) -> u32 {
        4
    }

    fn prepare<'a>(&self, cx: Context<'a>) -> Box<dyn Rounds + 'a> {
        if cx.world.instances().is_empty() {
            // There is nothing that light could come by to the camera.
            return PathTracer.prepare(cx);
        }
        let chains = PlainChains::new(cx);
        let Some(plan) = plan(&chains, self.always) else {
            return Box::new(PathsAlone { paths: PathTracer.prepare(cx), dark_after: chains.dark_after });
        };
        let (space, mutations, table) = (chains.space, chains.mutations, chains.table);
        Box::new(AjarRounds { cx, space, plan, mutations, table, totals: Mutex::default() })
    }
}

/// Path tracing where chains would not pay.
struct PathsAlone<'a> {
    paths: Box<dyn Rounds + 'a>,
    /// Bidirectional samples that looked for light in vain.
    dark_after: Option<u32>,
}

impl Rounds for PathsAlone<'_> {
    fn scale(&self) -> f64 {
        self.paths.scale()
    }

    fn render(&self, round: u32, film: &RoundFilm) {
        self.paths.render(round, film);
    }

    fn report(&self) -> Report {
        let mut report = self.paths.report();
        match self.dark_after {
            Some(samples) => report.numbers.push(("samples_in_vain".into(), samples.into())),
            None => report.lines.push("path tracing alone: chains would not pay here".into()),
        }
        report
    }
}

struct AjarRounds<'a> {
    cx: Context<'a>,
    space: Space<'a>,
    plan: Plan,
    mutations: Vec<&'static dyn Mutation>,
    table: Table,
    totals: Mutex<Totals>,
}

impl AjarRounds<'_> {
    fn note(&self, totals: &Totals) {
        self.totals.lock().unwrap_or_else(PoisonError::into_inner).add(totals);
    }
}

/// Where a chain begins.
#[derive(Clone, Copy)]
enum Seed {
    /// A pixel of the base, and how far through what it left.
    Base(usize, f64),
    /// A bidirectional sample of what path tracing seldom finds.
    Bidirectional(Candidate),
}

impl Rounds for AjarRounds<'_> {
    fn scale(&self) -> f64 {
        1.0
    }

    fn render(&self, round: u32, film: &RoundFilm) {
        let (settings, pixels) = (self.cx.settings, self.space.window.pixels());
        let samples = f64::from(settings.samples_per_round) * pixels as f64;
        let beside = (self.plan.beside * samples).ceil() as u32;
        let split = Split {
            space: self.space,
            brightness: &self.plan.brightness,
            effort: &self.plan.effort,
            clamp: self.plan.clamp,
            beside: f64::from(beside) / samples,
        };
        let left = base::render(&split, settings, round, |pixel, value| film.add(pixel, value));
        let bootstrap = Bootstrap::new(self.space, (settings.seed, round), beside);
        let found = bootstrap.candidates_worth(&|raster, alone| split.is_sought_beside(raster, alone), |x| {
            split.seed_beside(x)
        });
        if self.cx.cancelled() {
            return;
        }
        let of_base = left.iter().map(|left| left / samples);
        let pool = Pool::of(of_base.chain(found.iter().map(|c| c.weight / f64::from(beside))));
        if pool.total <= 0.0 {
            let samples_in_vain = samples as u64 + u64::from(beside);
            self.note(&Totals { empty_rounds: 1, samples_in_vain, ..Totals::default() });
            return;
        }
        let mutations = self.plan.mutations_per_sample * samples;
        let length = settings.metropolis.chain_length;
        let count = (mutations / f64::from(length)).ceil() as usize;
        let u = Rng::new(settings.seed, Purpose::Resampling, round, 0).f64();
        let step = pool.total / count as f64;
        let seeds = spread((&left, 1.0 / samples), (&found, 1.0 / f64::from(beside)), step, u);
        let step = pool.total * pixels as f64 / (seeds.len() as f64 * f64::from(length));
        let (mutations, table) = (self.mutations.as_slice(), &self.table);
        let kernel = Kernel { space: self.space, mutations, table, target: &split };
        let totals = Chains { cx: self.cx, kernel, round, length, learning: false }.run(
            seeds.len(),
            || bootstrap.tracer(),
            |index, tracer, path| match seeds[index] {
                Seed::Base(pixel, rest) => base::replay(&split, settings, round, (pixel, rest), path),
                Seed::Bidirectional(candidate) => bootstrap.replay(&candidate, tracer, path),
            },
            |_, path, aim, steps| {
                if let Some(pixel) = self.space.pixel(path.raster) {
                    film.add(pixel, aim.deposit * (steps * step));
                }
            },
        );
        self.note(&Totals { pool, ..totals });
    }

    fn report(&self) -> Report {
        let totals = self.totals.lock().unwrap_or_else(PoisonError::into_inner);
        let mut report = totals.report(self.mutations.iter().map(|m| m.name()));
        report.numbers.push(("clamp".into(), self.plan.clamp));
        report.numbers.push(("residual".into(), self.plan.residual));
        report.numbers.push(("advantage".into(), self.plan.advantage));
        report.numbers.push(("mutations_per_sample".into(), self.plan.mutations_per_sample));
        report
    }
}

/// Seeds at even steps through what the pixels of the base left and what bidirectional samples found, each with a scale.
fn spread(
    (left, left_scale): (&[f64], f64),
    (found, found_scale): (&[Candidate], f64),
    step: f64,
    u: f64,
) -> Vec<Seed> {
    let mut seeds = Vec::new();
    let (mut sum, mut next) = (0.0, u * step);
    for (pixel, left) in left.iter().map(|left| left * left_scale).enumerate() {
        while next < sum + left {
            seeds.push(Seed::Base(pixel, (next - sum) / left_scale));
            next += step;
        }
        sum += left;
    }
    for candidate in found {
        sum += candidate.weight * found_scale;
        while next < sum {
            seeds.push(Seed::Bidirectional(*candidate));
            next += step;
        }
    }
    seeds
}
