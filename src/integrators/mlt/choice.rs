//! Which mutation to try next (Veach & Guibas 1997 §4.4; mlt.md §4 of the design).
//!
//! The probability depends on the path alone, through its class, and on a table that does not change within a round. It
//! is part of the acceptance ratio.

use ajar_render::rng::Rng;

use super::{Mutation, path::Signature};

/// Classes of paths.
pub const CLASSES: usize = 24;

/// What makes mutations fit a path or not: number of Dirac chains that the eye looks through (0, 1, more), whether two
/// neighbours that scatter smoothly (or lie on a light) follow each other anywhere, and the number of edges (2, 3, 4,
/// more).
pub fn class(x: &Signature) -> usize {
    let k = x.edges();
    let mut chains = 0;
    let mut i = k - 1;
    while i > 0 {
        if !x.connectable(i) {
            chains += usize::from(x.connectable(i + 1));
        } else if x.connectable(i - 1) {
            break;
        }
        i -= 1;
    }
    let pair = (1..k).any(|i| x.connectable(i) && x.connectable(i - 1));
    let length = (k - 2).min(3);
    (chains.min(2) * 2 + usize::from(pair)) * 4 + length
}

/// Whether paths of a class have two neighbours that can be connected.
pub fn has_pair(class: usize) -> bool {
    class / 4 % 2 == 1
}

/// Most mutations in a table.
pub const MAX_MUTATIONS: usize = 12;

/// Weights of mutations by class.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Not negative; they need not sum to 1.
    pub weights: [[f64; MAX_MUTATIONS]; CLASSES],
}

impl Table {
    /// The same weight for all mutations that have one.
    pub fn equal(&self) -> Self {
        Self { weights: self.weights.map(|row| row.map(|w| f64::from(u8::from(w > 0.0)))) }
    }

    /// The same weights for all classes.
    pub fn uniform(weights: &[f64]) -> Self {
        let mut row = [0.0; MAX_MUTATIONS];
        row[..weights.len()].copy_from_slice(weights);
        Self { weights: [row; CLASSES] }
    }
}

/// How a table is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// Weights that suit most scenes.
    #[default]
    Fixed,
    /// Weights by what a pilot saw mutations do to paths of each class.
    Learned,
    /// All mutations that apply are equally likely.
    Equal,
}

impl Choice {
    /// Its name in settings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Learned => "learned",
            Self::Equal => "equal",
        }
    }

    /// All of them.
    pub const ALL: [Self; 3] = [Self::Fixed, Self::Learned, Self::Equal];
}

/// What a mutation did to paths of a class.
#[derive(Clone, Copy, Debug, Default)]
struct Lesson {
    tried: f64,
    /// Sum of acceptance probabilities times how useful the change was, in [0, 1].
    worth: f64,
    rays: f64,
}

/// Watches mutations at work.
#[derive(Clone, Debug)]
pub struct Learner {
    lessons: [[Lesson; MAX_MUTATIONS]; CLASSES],
}

/// Raster distance that changes what a chain sees as much as any, pixels.
const FAR: f64 = 8.0;
/// Use of a change that leaves the raster position as it is.
const LOCAL_USE: f64 = 0.25;
/// Bookkeeping of a mutation, in rays.
const OVERHEAD: f64 = 1.5;
/// Tries from which a lesson counts.
const LEAST_TRIES: f64 = 200.0;
/// Least share of a mutation that was ever useful.
const LEAST_SHARE: f64 = 0.02;

impl Default for Learner {
    fn default() -> Self {
        Self { lessons: [[Lesson::default(); MAX_MUTATIONS]; CLASSES] }
    }
}

impl Learner {
    /// Mutation number `m` cast `rays` rays for a proposal from `x` that is accepted with some probability and moves the
    /// raster position by some pixels.
    pub fn note(&mut self, x: &Signature, m: usize, rays: u64, (acceptance, moved): (f64, f64)) {
        let lesson = &mut self.lessons[class(x)][m];
        lesson.tried += 1.0;
        lesson.worth += acceptance * (moved / FAR).clamp(LOCAL_USE, 1.0);
        lesson.rays += rays as f64;
    }

    /// Adds what another learned.
    pub fn add(&mut self, other: &Self) {
        for (sum, more) in self.lessons.iter_mut().flatten().zip(other.lessons.iter().flatten()) {
            sum.tried += more.tried;
            sum.worth += more.worth;
            sum.rays += more.rays;
        }
    }

    /// Weights in proportion to use over cost. Classes that too little is known of keep those of `usual`, and what has
    /// no weight there gets none.
    pub fn table(&self, usual: &Table) -> Table {
        let mut table = usual.clone();
        for (row, lessons) in table.weights.iter_mut().zip(&self.lessons) {
            let worth =
                lessons.map(|l| if l.tried > 0.0 { l.worth / (l.rays + OVERHEAD * l.tried) } else { 0.0 });
            let known =
                row.iter().zip(lessons).all(|(w, l)| *w == 0.0 || l.tried == 0.0 || l.tried >= LEAST_TRIES);
            let total: f64 = row.iter().zip(&worth).filter(|(w, _)| **w > 0.0).map(|(_, worth)| worth).sum();
            if known && total > 0.0 {
                for (weight, worth) in row.iter_mut().zip(worth).filter(|(w, _)| **w > 0.0) {
                    *weight = if worth > 0.0 { (worth / total).max(LEAST_SHARE) } else { LEAST_SHARE };
                }
            }
        }
        table
    }
}

/// The chances of each mutation at a path.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    weights: [f64; MAX_MUTATIONS],
    total: f64,
}

impl Selection {
    /// Nothing applies.
    pub const NONE: Self = Self { weights: [0.0; MAX_MUTATIONS], total: 0.0 };

    /// At paths of the kind `x`.
    pub fn at(x: &Signature, mutations: &[&dyn Mutation], table: &Table) -> Self {
        let row = &table.weights[class(x)];
        let mut weights = [0.0; MAX_MUTATIONS];
        let mut total = 0.0;
        for ((weight, mutation), &given) in weights.iter_mut().zip(mutations).zip(row) {
            if given > 0.0 && mutation.applies(x) {
                *weight = given;
                total += given;
            }
        }
        Self { weights, total }
    }

    /// Index of the mutation to try; `None` if none applies.
    pub fn choose(&self, rng: &mut Rng) -> Option<usize> {
        let mut rest = rng.f64() * self.total;
        let mut last = None;
        for (i, &weight) in self.weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            last = Some(i);
            rest -= weight;
            if rest < 0.0 {
                break;
            }
        }
        last
    }

    /// Probability of a mutation.
    pub fn probability(&self, mutation: usize) -> f64 {
        if self.total > 0.0 { self.weights[mutation] / self.total } else { 0.0 }
    }
}
