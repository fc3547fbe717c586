//! What the `ajar` estimator learns before its first round: how bright each pixel is, and whether chains pay.
//!
//! All of it is a function of world, settings and seed, and stays as it is for all rounds: then any part of the rounds
//! can be rendered anywhere, and each is unbiased.

use ajar_render::{film::Film, math::scalar};

use super::{
    base::{self, Split},
    path::Space,
    plain::PlainChains,
};
use crate::Settings;

/// Mutations a pixel that find the brightness, and then what they would cost and gain.
const BRIGHTNESS_MUTATIONS: u64 = 12;
const GAIN_MUTATIONS: u64 = 4;
/// Most mutations of either pilot: large images are learned more coarsely.
const MOST_MUTATIONS: u64 = 1 << 22;
/// Mutations that the square of pixels to average over should hold.
const AVERAGED: f64 = 300.0;
/// Eye paths a pixel, twice, that look for what the chains missed; one in large images.
const WALKS: u32 = 2;
const LARGE: usize = 1 << 19;
/// Round numbers of the pilots.
const BRIGHTNESS_ROUND: u32 = u32::MAX - 1;
const GAIN_ROUND: u32 = u32::MAX - 2;
/// Least brightness, relative to the mean.
const FLOOR: f64 = 0.02;
/// Steps that a chain needs to forget a pixel: measured between 4 in easy scenes and 47 behind a door.
const CORRELATION: f64 = 15.0;
/// Even spread makes an eye path worth about this many random ones where paths alone do well.
const EVENNESS: f64 = 1.5;
/// Bookkeeping of a mutation, in rays.
const OVERHEAD: f64 = 1.5;
/// Shares of the work that the base may get beside chains.
const BASE_SHARE: [f64; 2] = [0.3, 0.7];

/// Share of the work that looks for seeds besides the base.
const SEED_WORK: f64 = 0.1;
/// What a bidirectional sample, its paths measured, costs in eye paths.
const BIDIRECTIONAL_COST: f64 = 8.0;

/// What the pilot found.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Mean of the channels of each pixel of the window, smoothed, nowhere 0.
    pub brightness: Vec<f64>,
    /// Mutations for each eye path; 0 where the base is better alone.
    pub mutations_per_sample: f64,
    /// Bidirectional samples for each eye path, which look for seeds too.
    pub beside: f64,
    /// Share of the image that chains would render, in units of each pixel's brightness.
    pub residual: f64,
}

/// Makes the plan; `always` asks for chains even where they do not pay.
pub fn plan(chains: &PlainChains<'_>, always: bool) -> Plan {
    let brightness = brightness(chains);
    let split = Split { space: chains.space, brightness: &brightness, beside: 0.0 };
    let gain = gain(chains, &split);
    let useful = gain.filter(|gain| always || !gain.is_path_better());
    let mutations_per_sample = useful.map_or(0.0, |gain| gain.mutations_per_sample());
    let beside = useful.map_or(0.0, |gain| gain.beside(mutations_per_sample));
    Plan { mutations_per_sample, beside, residual: gain.map_or(0.0, |gain| gain.residual), brightness }
}

fn brightness(chains: &PlainChains<'_>) -> Vec<f64> {
    let space = &chains.space;
    let pixels = space.window.pixels();
    let mut film = Film::new(pixels, crate::brightness(space.world, space.max_depth));
    let round = film.round();
    let mutations = (BRIGHTNESS_MUTATIONS * pixels as u64).min(MOST_MUTATIONS);
    chains.render(BRIGHTNESS_ROUND, mutations, |path, aim, share| {
        if let Some(pixel) = space.pixel(path.raster) {
            round.add(pixel, aim.deposit * (share * pixels as f64));
        }
    });
    film.merge(&round, 1.0);
    let width = space.window.width() as usize;
    // Pixels on each side over which to average.
    let side = (AVERAGED * pixels as f64 / mutations as f64).sqrt();
    let reach = ((side - 1.0) / 2.0).ceil() as usize;
    let walks = if pixels > LARGE { 1 } else { WALKS };
    let found: Vec<f64> = (0..pixels).map(|pixel| scalar(film.mean(pixel))).collect();
    let walked = [0, 1].map(|half| {
        // Other samples than those of the image, which must not depend on its own brightness.
        let seed = !chains.cx.settings.seed;
        let settings = Settings { seed, samples_per_round: walks, ..chains.cx.settings.clone() };
        smooth(&base::means(space, &settings, half), width, reach)
    });
    let mean = found.iter().sum::<f64>() / pixels as f64;
    if mean <= 0.0 {
        return vec![1.0; pixels];
    }
    // Chains may have missed what walks find easily. A brightness that is too low costs much, one that is too high
    // little; what only one half of the walks found is a firefly.
    let walked = walked[0].iter().zip(&walked[1]).map(|(a, b)| a.min(*b));
    smooth(&found, width, reach)
        .iter()
        .zip(walked)
        .map(|(b, walked)| b.max(walked).max(FLOOR * mean))
        .collect()
}

/// Mean over the square of pixels around each.
fn smooth(values: &[f64], width: usize, reach: usize) -> Vec<f64> {
    let rows = values.len() / width;
    let span = |i: usize, n: usize| i.saturating_sub(reach)..(i + reach + 1).min(n);
    let across: Vec<f64> = (0..values.len())
        .map(|i| {
            let (row, columns) = (i / width * width, span(i % width, width));
            let count = columns.len() as f64;
            values[row + columns.start..row + columns.end].iter().sum::<f64>() / count
        })
        .collect();
    (0..values.len())
        .map(|i| {
            let rows = span(i / width, rows);
            let count = rows.len() as f64;
            rows.map(|row| across[row * width + i % width]).sum::<f64>() / count
        })
        .collect()
}

/// Relative second moments of one sample, averaged over pixels, and costs in rays.
#[derive(Clone, Copy, Debug, Default)]
struct Gain {
    /// Of path tracing alone, and of the base.
    path: f64,
    base: f64,
    residual: f64,
    path_cost: f64,
    mutation_cost: f64,
}

impl Gain {
    /// Bidirectional samples for each eye path that take the share [`SEED_WORK`] of the work.
    fn beside(&self, mutations_per_sample: f64) -> f64 {
        let work = self.path_cost + mutations_per_sample * self.mutation_cost;
        SEED_WORK * work / (BIDIRECTIONAL_COST * self.path_cost)
    }

    /// Whether path tracing alone has the smaller error.
    fn is_path_better(&self) -> bool {
        let (base, chains) = self.work();
        self.path * self.path_cost < EVENNESS * (base.sqrt() + chains.sqrt()).powi(2)
    }

    /// Variances times costs of base and chains.
    fn work(&self) -> (f64, f64) {
        (self.base * self.path_cost, self.residual.powi(2) * CORRELATION * self.mutation_cost)
    }

    /// Minimizes σ²_B/t_B + σ²_M/t_M: times in proportion to the standard deviations, within bounds.
    fn mutations_per_sample(&self) -> f64 {
        let (base, chains) = self.work();
        let [least, most] = BASE_SHARE;
        let share = (base.sqrt() / (base.sqrt() + chains.sqrt())).clamp(least, most);
        (1.0 - share) / share * self.path_cost / self.mutation_cost
    }
}

/// Chains see paths in proportion to what they contribute: the mean of C/μ over them is the second moment of the path
/// tracer, however seldom it would find them itself.
fn gain(chains: &PlainChains<'_>, split: &Split<'_>) -> Option<Gain> {
    let space = &chains.space;
    // Sums are made per row of pixels and then in order: the order of threads must not show.
    let rows = Film::new(space.window.pixels(), 1.0);
    let (paths, bases, residuals) = (rows.round(), rows.round(), rows.round());
    let totals = chains.render(
        GAIN_ROUND,
        (GAIN_MUTATIONS * space.window.pixels() as u64).min(MOST_MUTATIONS),
        |path, aim, share| {
            let Some(pixel) = space.pixel(path.raster) else { return };
            let brightness = split.brightness[pixel];
            let relative = scalar(aim.deposit) * share / brightness;
            let c = base::contribution(path);
            let left = Split::residual(c, brightness);
            let moment = |x: f64| ajar_render::math::Rgb::splat(x.min(MOST) * relative);
            paths.add(pixel, moment(c / brightness));
            bases.add(pixel, moment((1.0 - left).powi(2) * if c.is_finite() { c / brightness } else { 0.0 }));
            residuals.add(pixel, moment(left));
        },
    );
    if totals.stats.steps() == 0 {
        return None;
    }
    let mean = |round| {
        let mut film = rows.clone();
        film.merge(round, 1.0);
        (0..film.pixels()).map(|pixel| film.mean(pixel).x).sum::<f64>()
    };
    let settings = Settings { samples_per_round: 1, ..chains.cx.settings.clone() };
    Some(Gain {
        path: mean(&paths),
        base: mean(&bases),
        residual: mean(&residuals),
        path_cost: path_cost(space, &settings),
        mutation_cost: totals.rays_per_mutation() + OVERHEAD,
    })
}

/// Largest relative contribution that counts in the second moments.
const MOST: f64 = 1e5;

/// Rays of one eye path.
fn path_cost(space: &Space<'_>, settings: &Settings) -> f64 {
    const STRIDE: usize = 37;
    let pixels = (0..space.window.pixels()).step_by(STRIDE);
    let count = pixels.len() as f64;
    let vertices: usize = pixels.map(|pixel| base::vertices(space, settings.seed, pixel)).sum();
    // At each vertex one ray to a light and one that goes on.
    2.0 * vertices as f64 / count
}
