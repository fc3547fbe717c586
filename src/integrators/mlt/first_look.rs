//! A first look at the image by eye paths: how bright pixels are, and which of them mirrors and glass send on.

use ajar_render::{
    bsdf::{Mode, Side},
    math::scalar,
    path::Vertex,
};
use rayon::prelude::*;

use super::{base, path::Space};
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

/// What the samples of pixels see, of one pixel in each square with sides of `step`.
pub fn glances(space: &Space<'_>, settings: &Settings, round: u32, step: usize) -> Vec<Option<Glance>> {
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
    (0..space.window.pixels())
        .into_par_iter()
        .map(|pixel| (speaks(pixel) && !space.cancelled()).then(|| mean(pixel)))
        .collect()
}
