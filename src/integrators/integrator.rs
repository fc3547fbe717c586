//! The contract of integrators and their list.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

use ajar_render::{World, film::RoundFilm};

use crate::{
    bdpt::Bdpt,
    mlt::{Ajar, Mlt, choice::Choice, lens_subpaths::Spread},
    path::PathTracer,
};

/// Everything an image depends on besides the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Seed of all randomness.
    pub seed: u64,
    /// Edges of the longest path.
    pub max_depth: usize,
    /// Eye samples a pixel in one round.
    pub samples_per_round: u32,
    /// Pixels to render.
    pub window: Window,
    /// How chains of Metropolis light transport work.
    pub metropolis: Metropolis,
}

/// How chains of Metropolis light transport work.
#[derive(Clone, Debug, PartialEq)]
pub struct Metropolis {
    /// Weights of mutations by name, where they shall not be the usual ones; 0 switches one off.
    pub weights: BTreeMap<String, f64>,
    /// How the choice between mutations is weighed.
    pub choice: Choice,
    /// Steps of a chain.
    pub chain_length: u32,
    /// How lens subpaths spread.
    pub lens_subpaths: Spread,
}

impl Default for Metropolis {
    fn default() -> Self {
        Self {
            weights: BTreeMap::new(),
            choice: Choice::default(),
            chain_length: CHAIN_LENGTH,
            lens_subpaths: Spread::default(),
        }
    }
}

/// Steps of a chain where nothing says another number. A few bright pixels among dark ones are seen by the chains that begin
/// there alone: with longer and fewer chains their share of the light varies more (docs/metropolis.md has figures).
const CHAIN_LENGTH: u32 = 512;

impl Settings {
    /// Numbers of the samples that a pixel gets in `round`: rounds go on where the one before ends.
    pub fn samples(&self, round: u32) -> std::ops::Range<u64> {
        let (round, samples) = (u64::from(round), u64::from(self.samples_per_round));
        round * samples..(round + 1) * samples
    }
}

/// A rectangle of pixels, the end excluded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Window {
    /// Columns.
    pub fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.y1 - self.y0
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width() as usize * self.height() as usize
    }

    /// Index of pixel (x, y) of the full frame in a film of this window.
    pub fn index(&self, x: u32, y: u32) -> Option<usize> {
        let inside = (self.x0..self.x1).contains(&x) && (self.y0..self.y1).contains(&y);
        inside.then(|| (y - self.y0) as usize * self.width() as usize + (x - self.x0) as usize)
    }
}

/// What a round reads.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// The prepared scene.
    pub world: &'a World,
    /// The settings.
    pub settings: &'a Settings,
    /// Set by others to stop early: the round in progress is then worthless.
    pub cancel: &'a AtomicBool,
}

impl Context<'_> {
    /// Whether the round should end at once.
    pub fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

/// A way to render.
pub trait Integrator: Sync {
    /// Short name for settings.
    fn name(&self) -> &'static str;

    /// One sentence for people who choose.
    fn description(&self) -> &'static str;

    /// Longest path that it can build, in edges.
    fn max_depth(&self) -> usize;

    /// Samples a pixel of a round where nothing asks for a number: a few seconds of work on a small image.
    fn samples_per_round(&self) -> u32 {
        16
    }

    /// Gets ready to render: whatever all rounds share. Depends on world and settings alone.
    fn prepare<'a>(&self, cx: Context<'a>) -> Box<dyn Rounds + 'a>;
}

/// An integrator at work.
pub trait Rounds {
    /// Adds one round to an empty film of the window. The round's pixel values are the deposits times
    /// [`Rounds::scale`]. If the context was cancelled meanwhile the film is worthless.
    fn render(&self, round: u32, film: &RoundFilm);

    /// What one deposit counts in the round's pixel value.
    fn scale(&self) -> f64;

    /// What the rounds so far tell about themselves.
    fn report(&self) -> Report {
        Report::default()
    }
}

/// What rounds tell about themselves.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// For people: problems with the image.
    pub warnings: Vec<String>,
    /// For people: how it went, a line each.
    pub lines: Vec<String>,
    /// For programs: names and numbers.
    pub numbers: Vec<(String, f64)>,
}

impl Report {
    /// The number of this name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }
}

/// All integrators.
pub fn integrators() -> &'static [&'static dyn Integrator] {
    &[&Ajar { always: false }, &PathTracer, &Bdpt, &Mlt]
}
