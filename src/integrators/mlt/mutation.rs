//! The contract of mutations (Veach & Guibas 1997 §4; mlt.md §3.2, §10 of the design).
//!
//! A mutation proposes a path y from a path x and knows how likely it does so. The driver owns everything else: which
//! mutation is chosen, the target, acceptance and recording.

use ajar_render::rng::Rng;

use super::{
    path::{Path, Signature, Space},
    proposal::Proposal,
};

/// Why a proposal is no path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reject {
    /// A ray left the scene.
    Lost,
    /// A surface absorbed the walk.
    Absorbed,
    /// It carries no light.
    Black,
    /// Something is in between.
    Blocked,
    /// It leaves the image.
    Outside,
    /// The mutation cannot make or unmake it.
    Unsuitable,
    /// Its contribution is not a number; counted and reported.
    NotFinite,
}

/// What a mutation chose besides vertices. All of it can be read backwards: [`Aux::reverse`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aux {
    /// Vertices kept on the light's side.
    pub stem: usize,
    /// Vertices replaced.
    pub removed: usize,
    /// Vertices that replace them.
    pub added: usize,
    /// Probabilities of the labels that are kept, at x and at y.
    pub labels: [f64; 2],
}

impl Default for Aux {
    fn default() -> Self {
        Self { stem: 0, removed: 0, added: 0, labels: [1.0; 2] }
    }
}

impl Aux {
    /// The choice that leads back.
    pub fn reverse(&self) -> Self {
        let [x, y] = self.labels;
        Self { removed: self.added, added: self.removed, labels: [y, x], ..*self }
    }
}

/// A way to propose paths.
pub trait Mutation: Sync {
    /// Name in settings and statistics.
    fn name(&self) -> &'static str;

    /// Whether it can be applied to paths of this kind.
    fn applies(&self, x: &Signature) -> bool;

    /// Proposes a path from `x`, which `y` follows, into `y`.
    ///
    /// # Errors
    /// Why there is none; the step then counts as a rejection.
    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject>;

    /// T(y|x; aux) / f*(y), up to a factor that is the same for (x, y, aux) and (y, x, aux.reverse()). Draws no random
    /// number and casts no ray. 0 where y cannot be proposed.
    fn q(&self, space: &Space<'_>, x: &Path, y: &Path, aux: &Aux) -> f64;
}
