//! A first look at the image by eye paths: how bright pixels are, and which of them mirrors and glass send on.

use ajar_render::{
    bsdf::{Mode, Side},
    math::scalar,
    path::Vertex,
};
use rayon::prelude::*;

use super::{
    base,
    path::Space,
    smooth::{Values, smooth},
};
use crate::{
    Settings,
    path::{Found, Visitor},
};

/// What the samples of a pixel see on average.
#[derive(Clone, Copy, Debug, Default)]
pub struct Glance {
    /// Brightness, without light seen directly.
    pub brightness: f64,
    /// Share of them that something like a mirror or glass sends on.
    pub sent_on: f64,
}

#[derive(Default)]
struct Look {
    brightness: f64,
    walked: Vec<Vertex>,
}

impl Visitor for Look {
    fn leave(&mut self, vertex: &Vertex) {
        self.walked.push(*vertex);
    }

    fn found(&mut self, path: &Found<'_>) {
        if path.edges > 1 {
            self.brightness += scalar(path.value);
        }
    }
}

/// Density of a direction from which on a surface counts as a mirror, 1/sr: the highlight of a roughness of about .3.
const SHARP: f64 = 10.0;

/// Whether the first surface of a walk sends it on much as a mirror or glass would.
fn is_sent_on(walked: &[Vertex]) -> bool {
    match walked {
        [_, first, ..] if first.mode != Mode::Smooth => true,
        [lens, first, next, ..] => {
            let [known, new] = [lens, next].map(|end| first.frame.to_local((end.p - first.p).normalize()));
            first.bsdf.pdf(Side::TowardLight, known, new) > SHARP
        }
        _ => false,
    }
}

/// Eye paths of a look, and most a pixel.
const WALKS: usize = 1 << 17;
const MOST_WALKS: u32 = 2;

/// Of how many pixels in a row one is looked at, and of how many rows.
pub fn step(pixels: usize) -> usize {
    (pixels as f64 / WALKS as f64).sqrt().ceil().max(1.0) as usize
}

/// What the samples of pixels see, of one in each square with sides of [`step`]. Each `round` has its own samples, which are
/// others than those of the image: its brightness must not decide on itself.
pub fn glances(space: &Space<'_>, settings: &Settings, round: u32) -> Vec<Option<Glance>> {
    let pixels = space.window.pixels();
    let (step, walks) = (step(pixels), ((WALKS / pixels) as u32).clamp(1, MOST_WALKS));
    let settings = Settings { seed: !settings.seed, samples_per_round: walks, ..settings.clone() };
    let mean = |pixel| {
        let mut look = Look::default();
        let mut sent_on = 0;
        for sample in settings.samples(round) {
            look.walked.clear();
            base::trace(space, settings.seed, pixel, sample, &mut look);
            sent_on += usize::from(is_sent_on(&look.walked));
        }
        let samples = f64::from(settings.samples_per_round);
        Glance { brightness: look.brightness / samples, sent_on: sent_on as f64 / samples }
    };
    let width = space.window.width() as usize;
    let speaks = |pixel: usize| (pixel % width).is_multiple_of(step) && (pixel / width).is_multiple_of(step);
    (0..pixels)
        .into_par_iter()
        .map(|pixel| (speaks(pixel) && !space.cancelled()).then(|| mean(pixel)))
        .collect()
}

/// How many times as many samples pixels get at most that are seen through mirrors or glass alone. Curved ones break what
/// they show into pieces smaller than a pixel; chains seldom pass from one to another, so that samples have to find each.
const MOST_EFFORT: f64 = 12.0;
/// Samples that this may add, relative to the usual ones.
const MOST_ADDED: f64 = 0.5;

/// How many times as many samples as usual each pixel gets, given the share of them that mirrors and glass send on.
pub fn efforts_for(sent_on: &[f64]) -> Vec<u32> {
    let mean = sent_on.iter().sum::<f64>() / sent_on.len() as f64;
    let added = (MOST_EFFORT - 1.0).min(MOST_ADDED / mean);
    sent_on.iter().map(|share| 1 + (added * share) as u32).collect()
}

/// The same, found by a look of its own.
pub fn efforts(space: &Space<'_>, settings: &Settings) -> Vec<u32> {
    // Lens, first surface and next.
    let short = space.with_depth(space.max_depth.min(3));
    let glances = glances(&short, settings, 0).into_iter();
    let found: Vec<Values> = glances
        .map(|glance| glance.map_or(Values::ZERO, |seen| Values::new(seen.sent_on, 0.0, 0.0, 1.0)))
        .collect();
    let reach = step(found.len()) - 1;
    let sent_on = smooth(&found, space.window.width() as usize, reach);
    efforts_for(&sent_on.iter().map(|seen| seen.x).collect::<Vec<_>>())
}
