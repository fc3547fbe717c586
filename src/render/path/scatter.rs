//! One step of a random walk: how a path goes on from a vertex.

use glam::DVec3;

use super::{DiracStep, Vertex};
use crate::{
    bsdf::{Mode, Side},
    math::Rgb,
};

/// Edges from the walk's start after which Russian roulette begins.
pub const ROULETTE_DEPTH: usize = 5;

/// A sampled continuation.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// World direction of the next vertex.
    pub direction: DVec3,
    /// Factors of f over density, roulette excluded.
    pub weight: Rgb,
    /// Native density (`Edge::density`), roulette excluded.
    pub density: f64,
    /// Native density of the reverse step, from the next vertex back to where the walk came from.
    pub back: f64,
    /// How the vertex scatters in this path.
    pub mode: Mode,
}

impl Vertex {
    /// Samples how a walk that came from `known` goes on.
    #[inline]
    pub fn scatter(&self, side: Side, known: DVec3, u_lobe: f64, u: [f64; 2]) -> Option<Step> {
        let sample = self.bsdf.sample(side, self.frame.to_local(known), u_lobe, u)?;
        if sample.mode != Mode::Smooth {
            return self.dirac_scatter(side, known, sample.mode);
        }
        let direction = self.frame.to_world(sample.direction);
        let (w_l, w_e) = oriented(side, known, direction);
        let found = self.evaluate(w_l, w_e);
        let (density, back) = match side {
            Side::TowardLight => (found.toward_light, found.toward_eye),
            Side::TowardEye => (found.toward_eye, found.toward_light),
        };
        let factor = found.value * self.projected(direction);
        (density > 0.0 && factor != Rgb::ZERO).then(|| Step {
            direction,
            weight: factor / density,
            density,
            back,
            mode: Mode::Smooth,
        })
    }

    fn dirac_scatter(&self, side: Side, known: DVec3, mode: Mode) -> Option<Step> {
        let DiracStep { direction, factor, density, .. } = self.dirac_step(side, known, mode)?;
        let back = self.dirac_step(side.other(), direction, mode).map_or(0.0, |reverse| reverse.density);
        Some(Step { direction, weight: factor / density, density, back, mode })
    }

    /// Probability that a walk survives Russian roulette after `edges` edges: a function of the place alone, so that it
    /// is part of every density (design notes, evidence 10: the largest albedo of the material here).
    #[inline]
    pub fn survival(&self, edges: usize) -> f64 {
        if edges < ROULETTE_DEPTH { 1.0 } else { survival(self.bsdf.albedo_bound()) }
    }
}

/// Probability that a walk survives Russian roulette that goes by `albedo`.
#[inline]
pub fn survival(albedo: f64) -> f64 {
    albedo.clamp(0.05, 0.95)
}

/// (towards the light, towards the eye) for a walk that came from `known` and goes to `new`.
#[inline]
pub fn oriented(side: Side, known: DVec3, new: DVec3) -> (DVec3, DVec3) {
    match side {
        Side::TowardLight => (new, known),
        Side::TowardEye => (known, new),
    }
}
