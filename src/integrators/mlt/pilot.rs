//! What the `ajar` estimator learns before its first round: how bright each pixel is, and whether chains pay.
//!
//! All of it is a function of world, settings and seed, and stays as it is for all rounds: then any part of the rounds
//! can be rendered anywhere, and each is unbiased.

use ajar_render::{
    film::Film,
    math::{Rgb, scalar},
};
use rayon::prelude::*;

use super::{
    base,
    first_look::{self, Glance},
    path::{Path, Space},
    plain::{PlainChains, Run},
    seeds::Candidate,
    smooth::{Surfaces, Values, smooth},
    target::Aim,
};

/// How many mutations a step of the pilot takes.
struct Mutations {
    a_pixel: u64,
    fewest: u64,
    most: u64,
}

impl Mutations {
    fn for_pixels(&self, pixels: usize) -> u64 {
        (self.a_pixel * pixels as u64).clamp(self.fewest, self.most)
    }
}

/// The first look, which spares easy scenes the rest.
const ROUGH: Mutations = Mutations { a_pixel: 2, fewest: 1 << 15, most: 1 << 17 };
/// Those that find the brightness: large images are learned more coarsely.
const BRIGHTNESS: Mutations = Mutations { a_pixel: 16, fewest: 1 << 16, most: 1 << 22 };
/// Those that find what chains would cost and gain.
const GAIN: Mutations = Mutations { a_pixel: 8, fewest: 1 << 15, most: 1 << 19 };
/// How much smaller the error of paths alone must be for the first look to decide: it is right within a third.
const CLEARLY: f64 = 0.7;
/// Mutations for each bidirectional sample that looks for seeds. Such samples are fewer than where chains make the image: what
/// one of them makes too bright lies in one part and in few squares.
const MUTATIONS_PER_SAMPLE: u64 = 64;
/// Steps of each chain: they begin where bidirectional samples say, and need not go far from there.
const LENGTH: u32 = 128;
/// Parts of the chains of which each finds the brightness by itself: the channels of a film.
const PARTS: usize = 3;
/// Mutations that the square of pixels to average over should hold, of all parts.
const AVERAGED: f64 = 300.0;
/// Round numbers of the pilots.
const BRIGHTNESS_ROUND: u32 = u32::MAX - 1;
const GAIN_ROUND: u32 = u32::MAX - 2;
const ROUGH_ROUND: u32 = u32::MAX - 4;
/// Least brightness, relative to the mean.
const FLOOR: f64 = 0.1;
/// Steps that a chain needs to forget a pixel: measured between 4 in easy scenes and 47 behind a door.
const CORRELATION: f64 = 15.0;
/// Even spread makes an eye path worth about this many random ones where paths alone do well.
const EVENNESS: f64 = 1.5;
/// What κ may be: where chains render next to everything, more would leave fireflies in the base; where they render
/// little, more spares them the work.
const CLAMPS: [f64; 3] = [2.0, 4.0, 8.0];
/// Bookkeeping of a mutation, in rays.
const OVERHEAD: f64 = 1.5;
/// Shares of the work that the base may get beside chains.
const BASE_SHARE: [f64; 2] = [0.3, 0.7];

/// What looks for seeds besides the base, relative to the work of base and chains.
const SEED_WORK: f64 = 0.11;
/// What a bidirectional sample that looks for heavy paths costs in eye paths.
const BIDIRECTIONAL_COST: f64 = 3.0;

/// What the pilot found.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Mean of the channels of each pixel of the window, smoothed, nowhere 0.
    pub brightness: Vec<f64>,
    /// How many times as many eye paths as usual each pixel gets.
    pub effort: Vec<u32>,
    /// κ of the base.
    pub clamp: f64,
    /// Mutations for each eye path.
    pub mutations_per_sample: f64,
    /// Bidirectional samples for each eye path, which look for seeds too.
    pub beside: f64,
    /// Share of the image that chains would render, in units of each pixel's brightness.
    pub residual: f64,
}

/// Makes the plan; none where path tracing is better alone. `always` asks for chains wherever they find light.
pub fn plan(chains: &PlainChains<'_>, always: bool) -> Option<Plan> {
    let pays = |gain: &Gain, least| always || gain.advantage() > least;
    let pixels = chains.space.window.pixels();
    let rough = seen_by_chains(chains, None, ROUGH.for_pixels(pixels));
    gain_over(chains, &rough, ROUGH.for_pixels(pixels)).filter(|gain| pays(gain, CLEARLY))?;
    let surfaces = Surfaces::new(&chains.space);
    let mut brightness = seen_by_chains(chains, Some((&rough, &surfaces)), BRIGHTNESS.for_pixels(pixels));
    let (walked, sent_on) = seen_by_walks(chains, &surfaces);
    drop(surfaces);
    // Chains may have missed what walks find easily; a brightness that is too low costs more than one as much too high.
    brightness.iter_mut().zip(walked).for_each(|(chained, walked)| *chained = chained.max(walked));
    let gain = gain_over(chains, &brightness, GAIN.for_pixels(pixels));
    let gain = gain.filter(|gain| pays(gain, 1.0))?;
    let mutations_per_sample = gain.mutations_per_sample();
    let beside = gain.beside(mutations_per_sample);
    let Gain { clamp, residual, .. } = gain;
    Some(Plan {
        brightness,
        effort: first_look::efforts_for(&sent_on),
        clamp,
        mutations_per_sample,
        beside,
        residual,
    })
}

/// Pixels on each side over which to average `samples` of `pixels`.
fn reach(samples: u64, pixels: usize) -> usize {
    let side = (AVERAGED * pixels as f64 / samples as f64).sqrt();
    ((side - 1.0) / 2.0).ceil().max(0.0) as usize
}

/// Brightness of each pixel as so many mutations find it, nowhere 0. Those that visit pixels in proportion to
/// their brightness learn little of dark ones; they do better relative to what is known `before`, and then tell surfaces
/// apart. A chain that stays long at a place has a say in one of several parts only, whose mean is geometric.
fn seen_by_chains(chains: &PlainChains<'_>, before: Option<(&[f64], &Surfaces)>, mutations: u64) -> Vec<f64> {
    let space = &chains.space;
    let pixels = space.window.pixels();
    let mut film = Film::new(pixels, crate::brightness(space.world, space.max_depth));
    let round = film.round();
    let record = |start: &Candidate, path: &Path, aim: &Aim, share: f64| {
        if let Some(pixel) = space.pixel(path.raster) {
            let mut parts = Rgb::ZERO;
            parts[part(start.sample)] = scalar(aim.deposit) * (share * (PARTS * pixels) as f64);
            round.add(pixel, parts);
        }
    };
    let number = if before.is_some() { BRIGHTNESS_ROUND } else { ROUGH_ROUND };
    let relative_to = before.map(|(brightness, _)| brightness);
    chains.render(&Run { relative_to, ..short_run(chains, number, mutations) }, record);
    if space.cancelled() {
        return vec![1.0; pixels];
    }
    film.merge(&round, 1.0);
    let found: Vec<Values> = (0..pixels).map(|pixel| film.mean(pixel).extend(1.0)).collect();
    drop((round, film));
    let mean = found.iter().map(|parts| scalar(parts.truncate())).sum::<f64>() / pixels as f64;
    if mean <= 0.0 {
        return vec![1.0; pixels];
    }
    let reach = reach(mutations, pixels);
    let parts = match before {
        Some((_, surfaces)) => surfaces.smooth(&found, reach),
        None => smooth(&found, space.window.width() as usize, reach),
    };
    let least = Rgb::splat(FLOOR * mean);
    parts.into_par_iter().map(|parts| parts.max(least).element_product().cbrt()).collect()
}

/// Many short chains from fewer seeds than a round has.
fn short_run(chains: &PlainChains<'_>, round: u32, mutations: u64) -> Run<'static> {
    Run { length: LENGTH, mutations_per_sample: MUTATIONS_PER_SAMPLE, ..chains.run(round, mutations) }
}

/// To which of the parts a bidirectional sample belongs, by Weyl's sequence: low bits of its number say at which columns of
/// the image it begins, high bits at which rows.
fn part(sample: u32) -> usize {
    ((u64::from(sample.wrapping_mul(0x9E37_79B9)) * PARTS as u64) >> 32) as usize
}

/// Brightness of each pixel as two sets of eye paths agree on it, for what only one of them found is a firefly; and the
/// share of them that mirrors and glass send on.
fn seen_by_walks(chains: &PlainChains<'_>, surfaces: &Surfaces) -> (Vec<f64>, Vec<f64>) {
    let space = &chains.space;
    let pixels = space.window.pixels();
    let reach = reach(BRIGHTNESS.for_pixels(pixels), pixels);
    let step = first_look::step(pixels);
    let [a, b] = [0, 1].map(|half| first_look::glances(space, chains.cx.settings, half));
    let both = |(a, b): (Option<Glance>, Option<Glance>)| match (a, b) {
        (Some(a), Some(b)) => Values::new(a.brightness, b.brightness, (a.sent_on + b.sent_on) / 2.0, 1.0),
        _ => Values::ZERO,
    };
    let found: Vec<Values> = a.into_iter().zip(b).map(both).collect();
    surfaces.smooth(&found, reach.max(step)).into_iter().map(|seen| (seen.x.min(seen.y), seen.z)).unzip()
}

/// Relative second moments of one sample, averaged over pixels, what is left to chains, and costs in rays.
#[derive(Clone, Copy, Debug, Default)]
struct Gain {
    /// κ of the base.
    clamp: f64,
    /// Second moments of path tracing alone, and of the base.
    path: f64,
    base: f64,
    /// Mean of what is left to chains.
    residual: f64,
    path_cost: f64,
    mutation_cost: f64,
}

impl Gain {
    /// Bidirectional samples for each eye path that add [`SEED_WORK`] to the work.
    fn beside(&self, mutations_per_sample: f64) -> f64 {
        let work = self.path_cost + mutations_per_sample * self.mutation_cost;
        SEED_WORK * work / (BIDIRECTIONAL_COST * self.path_cost)
    }

    /// Squared error of path tracing alone over that of base and chains, in equal time.
    fn advantage(&self) -> f64 {
        self.path * self.path_cost / (EVENNESS * self.error() * (1.0 + SEED_WORK))
    }

    /// Squared error of base and chains times the time that both take.
    fn error(&self) -> f64 {
        let ((base, chains), share) = (self.work(), self.share());
        base / share + chains / (1.0 - share)
    }

    /// Share of the base in the time. Minimizes σ²_B/t_B + σ²_M/t_M: times in proportion to the standard deviations, within
    /// bounds.
    fn share(&self) -> f64 {
        let (base, chains) = self.work();
        let [least, most] = BASE_SHARE;
        if base + chains > 0.0 {
            (base.sqrt() / (base.sqrt() + chains.sqrt())).clamp(least, most)
        } else {
            most
        }
    }

    /// Variances times costs of base and chains.
    fn work(&self) -> (f64, f64) {
        (self.base * self.path_cost, self.residual.powi(2) * CORRELATION * self.mutation_cost)
    }

    /// Mutations for each eye path.
    fn mutations_per_sample(&self) -> f64 {
        let share = self.share();
        (1.0 - share) / share * self.path_cost / self.mutation_cost
    }
}

/// Chains see paths in proportion to what they contribute: the mean of C/μ over them is the second moment of the path
/// tracer, however seldom it would find them itself. Of the values that κ may have the one with the least error.
fn gain_over(chains: &PlainChains<'_>, brightness: &[f64], mutations: u64) -> Option<Gain> {
    let space = &chains.space;
    // Sums are made per pixel and then in order: the order of threads must not show.
    let film = || Film::new(space.window.pixels(), 1.0);
    let [paths, bases, residuals] = [(); 3].map(|()| film().round());
    let totals = chains.render(&short_run(chains, GAIN_ROUND, mutations), |_, path, aim, share| {
        let Some(pixel) = space.pixel(path.raster) else { return };
        let brightness = brightness[pixel];
        let c = base::contribution(path);
        // The channels of these films are the values of κ.
        let left = CLAMPS.map(|clamp| base::share_of_chains(c, clamp * brightness));
        let relative = scalar(aim.deposit) * share / brightness;
        let moments = |of: [f64; 3]| Rgb::from(of.map(|x| x.min(MOST) * relative));
        let of_base = |left: f64| if left < 1.0 { (1.0 - left).powi(2) * c / brightness } else { 0.0 };
        paths.add(pixel, moments([c / brightness; 3]));
        bases.add(pixel, moments(left.map(of_base)));
        residuals.add(pixel, moments(left));
    });
    if totals.stats.steps() == 0 || space.cancelled() {
        return None;
    }
    let mean = |round| {
        let mut film = film();
        film.merge(round, 1.0);
        (0..film.pixels()).map(|pixel| film.mean(pixel)).sum::<Rgb>().to_array()
    };
    let (path_cost, mutation_cost) =
        (path_cost(space, chains.cx.settings.seed), totals.rays_per_mutation() + OVERHEAD);
    let [paths, bases, residuals] = [&paths, &bases, &residuals].map(mean);
    let gains = (0..CLAMPS.len()).map(|i| Gain {
        clamp: CLAMPS[i],
        path: paths[i],
        base: bases[i],
        residual: residuals[i],
        path_cost,
        mutation_cost,
    });
    let best = gains.min_by(|a, b| a.error().total_cmp(&b.error()));
    best.filter(|_| !space.cancelled())
}

/// Largest relative contribution that counts in the second moments.
const MOST: f64 = 1e5;

/// Rays of one eye path.
fn path_cost(space: &Space<'_>, seed: u64) -> f64 {
    const STRIDE: usize = 37;
    let paths = space.window.pixels().div_ceil(STRIDE);
    let vertices = |path| if space.cancelled() { 0 } else { base::vertices(space, seed, path * STRIDE) };
    let vertices: usize = (0..paths).into_par_iter().map(vertices).sum();
    // At each vertex one ray to a light and one that goes on.
    2.0 * vertices as f64 / paths as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_lie_all_over_the_image() {
        const SAMPLES: u32 = 1 << 14;
        let mut counts = [[[0; PARTS]; 8]; 8];
        for sample in 0..SAMPLES {
            // As `Bootstrap` places them.
            let (column, row) = (sample.reverse_bits() >> 29, sample * 8 / SAMPLES);
            counts[row as usize][column as usize][part(sample)] += 1;
        }
        let usual = SAMPLES as usize / (64 * PARTS);
        let all = counts.as_flattened().as_flattened();
        assert!(all.iter().all(|&count: &usize| count.abs_diff(usual) <= usual / 5), "{all:?}");
    }
}
