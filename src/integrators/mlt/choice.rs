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
    /// The same weights for all classes.
    pub fn uniform(weights: &[f64]) -> Self {
        let mut row = [0.0; MAX_MUTATIONS];
        row[..weights.len()].copy_from_slice(weights);
        Self { weights: [row; CLASSES] }
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
