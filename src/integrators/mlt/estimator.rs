//! The integrator `ajar`: path tracing, and Metropolis light transport for what path tracing is bad at.

use std::sync::{Mutex, PoisonError};

use ajar_render::{
    film::RoundFilm,
    path::Kind,
    rng::{Purpose, Rng},
};

use super::{
    Mutation,
    base::{self, Split},
    chain::Kernel,
    chains::{Chains, STEPS, Totals},
    choice::Table,
    mutations::mutations,
    path::Space,
    pilot::{Plan, plan},
    seeds::{Bootstrap, Candidate},
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
        let plan = plan(cx, self.always);
        if plan.mutations_per_sample == 0.0 {
            return PathTracer.prepare(cx);
        }
        let space = Space::of(&cx);
        let (mutations, table) = mutations(&cx.settings.mutations);
        Box::new(AjarRounds { cx, space, plan, mutations, table, totals: Mutex::default() })
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

/// Where a chain begins.
#[derive(Clone, Copy)]
enum Seed {
    /// A pixel of the base, and how far through what it left.
    Base(usize, f64),
    /// A bidirectional sample that path tracing cannot make.
    Bidirectional(Candidate),
}

/// Bidirectional samples a pixel and round, where there are lights that only they find behind mirrors and lenses.
const SAMPLES_BESIDE: u32 = 1;

impl Rounds for AjarRounds<'_> {
    fn scale(&self) -> f64 {
        1.0
    }

    fn render(&self, round: u32, film: &RoundFilm) {
        let (settings, pixels) = (self.cx.settings, self.space.window.pixels());
        let split = Split { space: self.space, brightness: &self.plan.brightness };
        let samples = settings.samples_per_round;
        let left = base::render(&split, settings, round, |pixel, value| film.add(pixel, value));
        let bootstrap = Bootstrap {
            space: self.space,
            seed: settings.seed,
            round,
            samples: SAMPLES_BESIDE * pixels as u32,
        };
        let beside = self.beside(&bootstrap);
        let base_total = left.iter().sum::<f64>() / (f64::from(samples) * pixels as f64);
        let total = base_total + beside.iter().map(|c| c.weight).sum::<f64>();
        let mutations = self.plan.mutations_per_sample * f64::from(samples) * pixels as f64;
        let count = (mutations / f64::from(STEPS)).ceil() as usize;
        if total <= 0.0 || self.cx.cancelled() {
            return;
        }
        let scale = 1.0 / (f64::from(samples) * pixels as f64);
        let u = Rng::new(settings.seed, Purpose::Resampling, round, 0).f64();
        let seeds = spread(&left, scale, &beside, total / count as f64, u);
        let step = total * pixels as f64 / (seeds.len() as f64 * f64::from(STEPS));
        let (mutations, table) = (self.mutations.as_slice(), &self.table);
        let kernel = Kernel { space: self.space, mutations, table, target: &split };
        let totals = Chains { cx: self.cx, kernel, round }.run(
            seeds.len(),
            |index, tracer, path| match seeds[index] {
                Seed::Base(pixel, rest) => base::replay(&split, settings, round, (pixel, rest), path),
                Seed::Bidirectional(candidate) => bootstrap.replay(&candidate, tracer, path),
            },
            |path, aim, steps| {
                if let Some(pixel) = self.space.pixel(path.raster) {
                    film.add(pixel, aim.deposit * (steps * step));
                }
            },
        );
        self.totals.lock().unwrap_or_else(PoisonError::into_inner).add(&totals);
    }

    fn report(&self) -> Report {
        let totals = self.totals.lock().unwrap_or_else(PoisonError::into_inner);
        let mut report = totals.report(self.mutations.iter().map(|m| m.name()));
        report.numbers.push(("residual".into(), self.plan.residual));
        report.numbers.push(("mutations_per_sample".into(), self.plan.mutations_per_sample));
        report
    }
}

impl AjarRounds<'_> {
    /// Candidates that path tracing never finds, lights without extent behind Dirac events, their weights those of the
    /// target and a sample.
    fn beside(&self, bootstrap: &Bootstrap<'_>) -> Vec<Candidate> {
        if !self.cx.world.lights.has_dirac() {
            return Vec::new();
        }
        let unseen = |x0: Kind, x1_connectable: bool| {
            matches!(x0, Kind::PointLight | Kind::DirectionalLight) && !x1_connectable
        };
        let mut found = bootstrap.candidates_where(unseen);
        for candidate in &mut found {
            let brightness = self.plan.brightness[candidate.pixel as usize];
            candidate.weight /= brightness * f64::from(bootstrap.samples);
        }
        found
    }
}

/// Seeds at even steps through what the pixels of the base left, `scale` each, and the candidates beside.
fn spread(left: &[f64], scale: f64, beside: &[Candidate], step: f64, u: f64) -> Vec<Seed> {
    let mut seeds = Vec::new();
    let (mut sum, mut next) = (0.0, u * step);
    for (pixel, &left) in left.iter().enumerate() {
        while next < sum + left * scale {
            seeds.push(Seed::Base(pixel, (next - sum) / scale));
            next += step;
        }
        sum += left * scale;
    }
    for candidate in beside {
        sum += candidate.weight;
        while next < sum {
            seeds.push(Seed::Bidirectional(*candidate));
            next += step;
        }
    }
    seeds
}
