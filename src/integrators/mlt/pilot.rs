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
    first_look::{self, Glance},
    gain::{Gain, gain_over},
    path::Path,
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
/// How many times smaller the error with chains must seem for them to be run: on easy scenes the estimate is up to twice too
/// good (docs/metropolis.md has figures).
const PAYS: f64 = 1.7;
/// The same for the first look to go on.
const MAY_PAY: f64 = 0.8 * PAYS;
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
pub const FLOOR: f64 = 0.1;

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
    /// Squared error of path tracing alone over that of base and chains in equal time, as far as the pilot can tell.
    pub advantage: f64,
}

/// Makes the plan; none where path tracing is better alone. `always` asks for chains wherever they find light.
pub fn plan(chains: &PlainChains<'_>, always: bool) -> Option<Plan> {
    let pays = |gain: &Gain, least| always || gain.advantage() > least;
    let pixels = chains.space.window.pixels();
    let gain_run = |mutations: Mutations| short_run(chains, GAIN_ROUND, mutations.for_pixels(pixels));
    let rough = seen_by_chains(chains, None, ROUGH.for_pixels(pixels));
    gain_over(chains, &rough, &gain_run(ROUGH)).filter(|gain| pays(gain, MAY_PAY))?;
    let surfaces = Surfaces::new(&chains.space);
    let mut brightness = seen_by_chains(chains, Some((&rough, &surfaces)), BRIGHTNESS.for_pixels(pixels));
    let (walked, sent_on) = seen_by_walks(chains, &surfaces);
    drop(surfaces);
    // Chains may have missed what walks find easily; a brightness that is too low costs more than one as much too high.
    brightness.iter_mut().zip(walked).for_each(|(chained, walked)| *chained = chained.max(walked));
    let gain = gain_over(chains, &brightness, &gain_run(GAIN));
    let gain = gain.filter(|gain| pays(gain, PAYS))?;
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
        advantage: gain.advantage(),
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
            parts[part(start.sample, PARTS)] = scalar(aim.deposit) * (share * (PARTS * pixels) as f64);
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

/// To which of so many parts a bidirectional sample belongs, by Weyl's sequence: low bits of its number say at which columns of
/// the image it begins, high bits at which rows.
pub fn part(sample: u32, parts: usize) -> usize {
    ((u64::from(sample.wrapping_mul(0x9E37_79B9)) * parts as u64) >> 32) as usize
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
            counts[row as usize][column as usize][part(sample, PARTS)] += 1;
        }
        let usual = SAMPLES as usize / (64 * PARTS);
        let all = counts.as_flattened().as_flattened();
        assert!(all.iter().all(|&count: &usize| count.abs_diff(usual) <= usual / 5), "{all:?}");
    }
}
