//! Bidirectional mutation (Veach & Guibas 1997 §4.2): deletes a piece of the path and grows another from both ends.

use ajar_render::rng::Rng;

use super::super::{
    Aux, Mutation, Reject,
    path::{Path, Signature, Space},
    proposal::Proposal,
};

/// Changes path length and topology; from anywhere it can reach everything.
#[derive(Clone, Copy, Debug)]
pub struct Bidirectional;

impl Mutation for Bidirectional {
    fn name(&self) -> &'static str {
        "bidirectional"
    }

    fn applies(&self, _: &Signature) -> bool {
        true
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        let ranges = Ranges::of(x);
        let (length, stem) = ranges.choose(1, rng).ok_or(Reject::Unsuitable)?;
        let lengths = Lengths::new(space, x.edges(), length, stem);
        let new_length = lengths.choose(rng).ok_or(Reject::Unsuitable)?;
        let (removed, added) = (length - 1, new_length - 1);
        let kept = stem + removed;
        let least = fewest_from_light(space, stem);
        let most = added - usize::from(kept == x.edges() + 1);
        if most < least {
            return Err(Reject::Unsuitable);
        }
        let from_light = least + rng.below(most + 1 - least);
        y.begin(space, x, (stem, kept, added))?;
        y.sample_from_light(space, from_light, rng)?;
        y.sample_from_eye(space, added - from_light, rng)?;
        y.join(space)?;
        Ok(Aux { stem, removed, added, ..Aux::default() })
    }

    fn q(&self, space: &Space<'_>, x: &Path, y: &Path, aux: &Aux) -> f64 {
        let Chances { range, length, split } = Chances::new(space, x, aux);
        range * length * split * y.density(aux.stem, aux.added) / y.scalar()
    }
}

/// Probabilities of the discrete choices.
#[derive(Clone, Copy, Debug)]
pub struct Chances {
    /// Of the piece to delete: p_d of its length, over the number of places.
    pub range: f64,
    /// Of the new length, p_a.
    pub length: f64,
    /// Of the number of new vertices on the light's side.
    pub split: f64,
}

impl Chances {
    /// Those of `aux` at `x`.
    pub fn new(space: &Space<'_>, x: &Path, aux: &Aux) -> Self {
        let (old, new) = (aux.removed + 1, aux.added + 1);
        let least = fewest_from_light(space, aux.stem);
        let most = aux.added - usize::from(aux.stem + aux.removed == x.edges() + 1);
        Self {
            range: Ranges::of(x).probability(old, aux.stem),
            length: Lengths::new(space, x.edges(), old, aux.stem).probability(new),
            split: 1.0 / (most + 1 - least) as f64,
        }
    }
}

/// Light ends that no eye path meets have to come from the light's side.
fn fewest_from_light(space: &Space<'_>, stem: usize) -> usize {
    usize::from(stem == 0 && !space.world.lights.can_be_met())
}

/// p_d: which pieces can be deleted. A piece of `length` edges lies between x_{stem-1} and x_{stem-1+length}; beyond both
/// ends of the path is a virtual vertex.
pub(super) struct Ranges {
    /// Bit i + 1: x_i is connectable; bits of both virtual vertices are set.
    ends: u128,
    edges: usize,
}

/// 2⁻ⁿ; 2⁻⁶³ for all larger n.
fn half_to(n: usize) -> f64 {
    1.0 / (1u64 << n.min(63)) as f64
}

impl Ranges {
    pub(super) fn of(x: &Path) -> Self {
        let k = x.edges();
        Self { ends: 1 | 1 << (k + 2) | x.signature.ends() << 1, edges: k }
    }

    /// Stems for a deletion of `length` edges, as bits.
    fn stems(&self, length: usize) -> u128 {
        let k = self.edges;
        // The piece ends at x_1 or later and begins before the lens: ends stay ends.
        let first = if length == 1 { 1 } else { 0 };
        let span = k + 2 - length;
        let allowed = ((1u128 << (span + 1)) - 1) & !((1 << first) - 1) & ((1 << (k + 1)) - 1);
        self.ends & (self.ends >> length) & allowed
    }

    fn weight(length: usize) -> f64 {
        match length {
            1 => 0.25,
            2 => 0.5,
            n => half_to(n),
        }
    }

    /// Lengths from `least` on that can be deleted somewhere.
    fn feasible(&self, least: usize) -> impl Iterator<Item = usize> {
        (least..=self.edges + 2).filter(|&n| self.stems(n) != 0)
    }

    fn total(&self, least: usize) -> f64 {
        self.feasible(least).map(Self::weight).sum()
    }

    /// Length, at least `least`, and stem of a deletion.
    pub(super) fn choose(&self, least: usize, rng: &mut Rng) -> Option<(usize, usize)> {
        let mut rest = rng.f64() * self.total(least);
        let mut chosen = None;
        for length in self.feasible(least) {
            chosen = Some(length);
            rest -= Self::weight(length);
            if rest < 0.0 {
                break;
            }
        }
        let length = chosen?;
        let mut stems = self.stems(length);
        for _ in 0..rng.below(stems.count_ones() as usize) {
            stems &= stems - 1;
        }
        Some((length, stems.trailing_zeros() as usize))
    }

    /// Probability of [`Ranges::choose`] among all lengths.
    fn probability(&self, length: usize, stem: usize) -> f64 {
        let stems = self.stems(length);
        if stems >> stem & 1 == 0 {
            return 0.0;
        }
        Self::weight(length) / (self.total(1) * f64::from(stems.count_ones()))
    }
}

/// p_a: how many edges take the place of the deleted ones.
struct Lengths {
    /// Length of the deleted piece.
    old: usize,
    least: usize,
    most: usize,
}

impl Lengths {
    fn new(space: &Space<'_>, edges: usize, old: usize, stem: usize) -> Self {
        // New ends ask for a vertex each; a single edge has to be replaced by something else; the path keeps two edges.
        let open = usize::from(stem == 0) + usize::from(stem + old == edges + 2);
        let least = (1 + open).max(if old == 1 { 2 } else { 1 }).max((old + 2).saturating_sub(edges));
        Self { old, least, most: space.max_depth + old - edges }
    }

    /// ½ for the same length, 0.15 for one more or less, the rest halves with each further step.
    fn weight(change: usize) -> f64 {
        match change {
            0 => 0.5,
            1 => 0.15,
            n => 0.2 * half_to(n),
        }
    }

    /// Sum of the weights of changes 1 to `n`.
    fn up_to(n: usize) -> f64 {
        if n == 0 { 0.0 } else { 0.15 + 0.2 * (0.5 - half_to(n)) }
    }

    fn total(&self) -> f64 {
        let up = Self::up_to(self.most.saturating_sub(self.old))
            - Self::up_to(self.least.saturating_sub(self.old + 1));
        if self.least > self.old {
            return up;
        }
        Self::weight(0) + up + Self::up_to(self.old - self.least)
    }

    fn choose(&self, rng: &mut Rng) -> Option<usize> {
        if self.least > self.most {
            return None;
        }
        let mut rest = rng.f64() * self.total();
        let mut last = None;
        for change in 0..=self.most {
            for length in [Some(self.old + change), self.old.checked_sub(change).filter(|_| change > 0)] {
                let Some(length) = length.filter(|n| (self.least..=self.most).contains(n)) else { continue };
                last = Some(length);
                rest -= Self::weight(change);
                if rest < 0.0 {
                    return last;
                }
            }
        }
        last
    }

    fn probability(&self, new: usize) -> f64 {
        if !(self.least..=self.most).contains(&new) {
            return 0.0;
        }
        Self::weight(new.abs_diff(self.old)) / self.total()
    }
}
