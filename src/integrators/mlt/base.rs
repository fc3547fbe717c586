//! The base of the `ajar` estimator: path tracing that leaves to Metropolis chains what it is bad at (after Gruson et
//! al. 2019, "Selectively Metropolised Monte Carlo light transport simulation"; mlt.md §5.4 of the design).
//!
//! C = f*/p is what the path tracer makes of a path that it finds with density p. With μ the brightness of the path's
//! pixel, the share w_B = κμ/(κμ + C) of f belongs to the base, which so never adds more than κμ, and the rest to the
//! chains. Both compute the same C, so the shares add up to 1.

use std::ops::Range;

use ajar_render::{
    math::{Rgb, scalar},
    path::{ROULETTE_DEPTH, Vertex, survival},
    sampler::Sequence,
};
use glam::DVec2;
use rayon::prelude::*;

use super::{
    path::{Node, Path, Space},
    target::{Aim, Target},
};
use crate::{
    Settings,
    path::{Found, Visitor, walk},
};

/// Which part of each path belongs to whom, and who finds seeds for the chains.
#[derive(Clone, Copy, Debug)]
pub struct Split<'a> {
    /// Where paths live.
    pub space: Space<'a>,
    /// Brightness of each pixel of the window, nowhere 0.
    pub brightness: &'a [f64],
    /// How many times as many samples as usual each pixel gets.
    pub effort: &'a [u32],
    /// Bidirectional samples for each usual eye path: seeds come from both.
    pub beside: f64,
    /// κ: how many times a pixel's brightness one path may add to it.
    pub clamp: f64,
}

/// From how many times its pixel's brightness on a contribution C is heavy: what path tracing seldom finds,
/// bidirectional samples may find more often.
const HEAVY: f64 = 8.0;
/// Room for rounding where C is known before the path is built.
const ROOM: f64 = 1.05;

/// w_R: the share of a path with contribution C that belongs to the chains where the base may add at most `most` = κμ.
pub fn share_of_chains(contribution: f64, most: f64) -> f64 {
    if contribution.is_infinite() { 1.0 } else { contribution / (most + contribution) }
}

impl Split<'_> {
    /// w_R.
    fn share_of_chains(&self, contribution: f64, brightness: f64) -> f64 {
        share_of_chains(contribution, self.clamp * brightness)
    }

    /// What a path leaves to the chains: C·w_R/μ. Light seen directly is the base's alone.
    fn left(&self, path: &Found<'_>, brightness: f64) -> f64 {
        let c = scalar(path.value);
        if path.edges == 1 { 0.0 } else { c * self.share_of_chains(c, brightness) / brightness }
    }

    /// Whether bidirectional samples look for paths of this contribution too.
    fn is_heavy(&self, contribution: f64, brightness: f64) -> bool {
        self.beside > 0.0 && contribution > HEAVY * brightness
    }

    /// Whether bidirectional samples may look for a path at `raster` (pixels) that is worth `alone` to the path tracer. What
    /// they are then worth as seeds is found from the paths themselves.
    pub fn is_sought_beside(&self, raster: DVec2, alone: f64) -> bool {
        let Some(pixel) = self.space.pixel(raster) else { return false };
        self.is_heavy(ROOM * alone, self.brightness[pixel])
    }

    /// What a bidirectional sample of `x`, weighed by f*/p, is worth as a seed.
    pub fn seed_beside(&self, x: &Path) -> f64 {
        let Some(pixel) = self.space.pixel(x.raster) else { return 0.0 };
        let (brightness, contribution) = (self.brightness[pixel], contribution(x));
        let share = 1.0 - self.seeds_of_base(x, contribution, pixel);
        share * self.share_of_chains(contribution, brightness) / brightness
    }

    /// The part of the seeds at `x` that is left to path tracing, by the balance heuristic; the rest is left to
    /// bidirectional samples.
    fn seeds_of_base(&self, x: &Path, contribution: f64, pixel: usize) -> f64 {
        if !self.is_heavy(contribution, self.brightness[pixel]) {
            return 1.0;
        }
        let base = f64::from(self.effort[pixel]) * x.scalar() / contribution;
        base / (base + self.beside * bidirectional_density(x))
    }

    /// Numbers of the samples that a pixel gets in `round`.
    fn samples(&self, settings: &Settings, round: u32, pixel: usize) -> Range<u64> {
        let (usual, effort) = (settings.samples(round), u64::from(self.effort[pixel]));
        usual.start * effort..usual.end * effort
    }
}

/// Total density of the techniques of bidirectional path tracing, their Russian roulette included.
fn bidirectional_density(x: &Path) -> f64 {
    let k = x.edges();
    let survives = |i: usize, edges: usize| {
        if edges < ROULETTE_DEPTH || i == 0 || i == k { 1.0 } else { survival(x.nodes[i].albedo) }
    };
    // Technique s: the walk from the light survives at x_1 … x_{s-2}, that from the eye at x_{s+1} … x_{k-1}.
    let mut sum = 0.0;
    x.splits(0, k + 1, |s, density| {
        let light: f64 = (1..s.saturating_sub(1)).map(|i| survives(i, i)).product();
        let eye: f64 = (s + 1..k).map(|i| survives(i, k - i)).product();
        sum += density * light * eye;
    });
    sum
}

impl Target for Split<'_> {
    fn aim(&self, x: &Path) -> Aim {
        let brightness = self.space.pixel(x.raster).map_or(1.0, |pixel| self.brightness[pixel]);
        let share = self.share_of_chains(contribution(x), brightness);
        Aim { weight: share / brightness, deposit: x.f * (brightness / x.scalar()) }
    }
}

/// C of a path of two edges or more, infinite where the path tracer never finds it.
pub fn contribution(x: &Path) -> f64 {
    let k = x.edges();
    let (mut density, mut walk_albedo) = (1.0, 1.0);
    // Probability to survive roulette at x_i, as the walk of the path tracer has it.
    let mut survives = |i: usize| {
        let (edges, albedo) = (k - i, x.nodes[i].albedo);
        if edges <= ROULETTE_DEPTH {
            walk_albedo *= albedo;
        }
        match edges {
            0 => 1.0,
            ROULETTE_DEPTH => survival(walk_albedo),
            _ if edges < ROULETTE_DEPTH => 1.0,
            _ => survival(albedo),
        }
    };
    for i in (2..=k).rev() {
        density *= x.nodes[i].to_light * if i < k { survives(i) } else { 1.0 };
    }
    let mut both = 0.0;
    if x.connectable(1) {
        both += density * x.light / x.nodes[0].passed;
    }
    if x.nodes[0].vertex.can_be_met() {
        both += density * x.nodes[1].to_light * survives(1);
    }
    x.scalar() / both
}

/// Adds the base of a round to the film. Returns what each pixel leaves to the chains as their seeds: the sum over as
/// many samples as usual of C·w_R/μ, of heavy paths the part that bidirectional samples do not look for.
pub fn render(
    split: &Split<'_>,
    settings: &Settings,
    round: u32,
    add: impl Fn(usize, Rgb) + Sync,
) -> Vec<f64> {
    let window = split.space.window;
    (0..window.pixels())
        .into_par_iter()
        .with_min_len(window.width() as usize)
        .map_init(Path::with_capacity, |path, pixel| {
            if split.space.cancelled() {
                return 0.0;
            }
            let mut shares = Shares::new(split, pixel);
            for sample in split.samples(settings, round, pixel) {
                trace(&split.space, settings.seed, pixel, sample, &mut shares);
                if std::mem::take(&mut shares.heavy) {
                    let mut heavy = Seeds::new(split, pixel, path);
                    trace(&split.space, settings.seed, pixel, sample, &mut heavy);
                    shares.left += heavy.left_of_heavy;
                }
            }
            let effort = f64::from(split.effort[pixel]);
            add(pixel, shares.sum / (f64::from(settings.samples_per_round) * effort));
            shares.left / effort
        })
        .collect()
}

/// Runs one sample of a pixel. Returns raster position and lens point.
pub fn trace(
    space: &Space<'_>,
    seed: u64,
    pixel: usize,
    sample: u64,
    visitor: &mut impl Visitor,
) -> (DVec2, [f64; 2]) {
    let window = space.window;
    let width = window.width() as usize;
    let (x, y) = (window.x0 + (pixel % width) as u32, window.y0 + (pixel / width) as u32);
    let number = u64::from(y) * u64::from(space.world.camera.width) + u64::from(x);
    let mut sampler = Sequence::new(seed, 0, number).sample(sample);
    let [dx, dy] = sampler.next_2d();
    let raster = DVec2::new(f64::from(x) + dx, f64::from(y) + dy);
    (raster, walk(space.world, space.max_depth, raster, &mut sampler, visitor))
}

/// Vertices of the first walk of a pixel, the lens included.
pub fn vertices(space: &Space<'_>, seed: u64, pixel: usize) -> usize {
    struct Count(usize);
    impl Visitor for Count {
        fn leave(&mut self, _: &Vertex) {
            self.0 += 1;
        }
        fn found(&mut self, _: &Found<'_>) {}
    }
    let mut count = Count(0);
    trace(space, seed, pixel, 0, &mut count);
    count.0
}

/// Divides what a pixel's samples find.
struct Shares<'a> {
    split: &'a Split<'a>,
    brightness: f64,
    /// What belongs to the base.
    sum: Rgb,
    /// What is left to the chains, but for heavy paths.
    left: f64,
    /// Whether there were heavy paths.
    heavy: bool,
}

impl<'a> Shares<'a> {
    fn new(split: &'a Split<'a>, pixel: usize) -> Self {
        Self { split, brightness: split.brightness[pixel], sum: Rgb::ZERO, left: 0.0, heavy: false }
    }
}

impl Visitor for Shares<'_> {
    fn found(&mut self, path: &Found<'_>) {
        let (left, c) = (self.split.left(path, self.brightness), scalar(path.value));
        // w_R = left·μ/C, so that what stays is (C − left·μ)/C of the value.
        self.sum += path.value * (1.0 - left * self.brightness / c);
        if left > 0.0 && self.split.is_heavy(c, self.brightness) {
            self.heavy = true;
        } else {
            self.left += left;
        }
    }
}

/// Finds the path of a pixel at which the sum of what is left to the chains, as [`render`] has it, exceeds `rest`, and
/// builds it into `path`; `None` if rounding lost it.
pub fn replay(
    split: &Split<'_>,
    settings: &Settings,
    round: u32,
    (pixel, rest): (usize, f64),
    path: &mut Path,
) -> Option<()> {
    let rest = rest * f64::from(split.effort[pixel]);
    let mut seeds = Seeds { rest, ..Seeds::new(split, pixel, path) };
    for sample in split.samples(settings, round, pixel) {
        seeds.walked.clear();
        let (raster, lens) = trace(&split.space, settings.seed, pixel, sample, &mut seeds);
        if seeds.found {
            (seeds.path.raster, seeds.path.lens) = (raster, lens);
            return Some(());
        }
    }
    None
}

/// Builds the paths that chains may start from.
struct Seeds<'a> {
    split: &'a Split<'a>,
    pixel: usize,
    brightness: f64,
    walked: Vec<Vertex>,
    path: &'a mut Path,
    /// What heavy paths leave to the chains.
    left_of_heavy: f64,
    /// How much is to be passed over until the path that is asked for.
    rest: f64,
    /// Whether it was found.
    found: bool,
}

impl<'a> Seeds<'a> {
    fn new(split: &'a Split<'a>, pixel: usize, path: &'a mut Path) -> Self {
        let (brightness, rest) = (split.brightness[pixel], f64::INFINITY);
        Self { split, pixel, brightness, walked: Vec::new(), path, left_of_heavy: 0.0, rest, found: false }
    }

    fn build(&mut self, path: &Found<'_>) -> Option<()> {
        let ends = std::iter::once(path.x0).chain(path.seen_from);
        self.path.nodes.clear();
        self.path.nodes.extend(ends.chain(self.walked.iter().rev()).map(|vertex| Node::new(*vertex)));
        let (edges, connection) = (self.path.edges(), path.seen_from.map(|_| 0));
        self.path.measure(&self.split.space, (0, edges), connection).ok()
    }
}

impl Visitor for Seeds<'_> {
    fn leave(&mut self, vertex: &Vertex) {
        self.walked.push(*vertex);
    }

    fn found(&mut self, path: &Found<'_>) {
        let (mut left, c) = (self.split.left(path, self.brightness), scalar(path.value));
        let is_heavy = self.split.is_heavy(c, self.brightness);
        if self.found || left == 0.0 || !(is_heavy || self.rest.is_finite()) {
            return;
        }
        if is_heavy {
            left *= self.build(path).map_or(1.0, |()| self.split.seeds_of_base(self.path, c, self.pixel));
            self.left_of_heavy += left;
        }
        self.rest -= left;
        if self.rest < 0.0 {
            self.found = self.build(path).is_some();
            self.rest = f64::NEG_INFINITY;
        }
    }
}
