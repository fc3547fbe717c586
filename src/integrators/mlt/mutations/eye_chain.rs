//! Perturbations from the eye: lens (Veach & Guibas 1997 §4.3.1) and multi-chain (Veach 1997 §11.4.4).
//!
//! The raster position moves, mirrors and lenses are followed as before; where a smooth vertex stands between two Dirac
//! chains the direction there is turned; the first smooth vertex after which another follows is connected to it.

use ajar_render::rng::Rng;

use super::super::{
    Aux, Mutation, Reject,
    path::{Path, Signature, Space},
    perturb::{raster_offset, turn},
    proposal::Proposal,
};

/// Suffix (D|L)DS*E, or LS*E without a connection: detail on the screen.
#[derive(Clone, Copy, Debug)]
pub struct Lens;

/// Suffix (D|L)DS⁺…DS⁺E with two chains or more: caustics seen in mirrors and through glass.
#[derive(Clone, Copy, Debug)]
pub struct MultiChain;

/// The part of the path that moves.
pub(super) struct Moving {
    /// Index of the last moving vertex, counted from the lens: a smooth one or the light.
    pub(super) end: usize,
    /// Smooth vertices between chains.
    turns: usize,
}

/// From the lens to the first smooth vertex that has a connectable one before it, or to the light.
pub(super) fn moving(x: &Signature) -> Moving {
    let mut turns = 0;
    for i in (1..x.edges()).rev() {
        if x.connectable(i) {
            if x.connectable(i - 1) {
                return Moving { end: i, turns };
            }
            turns += 1;
        }
    }
    Moving { end: 0, turns }
}

fn propose(space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
    let (Moving { end, .. }, k) = (moving(&x.signature), x.edges());
    y.begin(space, x, (end, k, k - end))?;
    y.move_raster(space, raster_offset(space, rng))?;
    y.go_from_lens(space, rng)?;
    for i in (end + 1..k).rev() {
        if x.connectable(i) {
            let direction = turn(-x.nodes[i - 1].edge.to_eye, rng);
            y.go_from_eye(space, direction, rng)?;
        } else {
            y.force_from_eye(space, x.nodes[i].vertex.mode, rng)?;
        }
    }
    y.join(space)?;
    Ok(Aux { stem: end, removed: k - end, added: k - end, ..Aux::default() })
}

/// Density of x_{i-1} as a perturbation from the eye makes it from x_i, up to a factor that is the same back and forth:
/// raster positions and directions move by kernels that are symmetric, Dirac events are forced.
pub(super) fn step_density(x: &Path, i: usize) -> f64 {
    let node = &x.nodes[i];
    if i == x.edges() {
        node.to_light
    } else if x.connectable(i) {
        x.nodes[i - 1].edge.density(1.0, &node.vertex, &x.nodes[i - 1].vertex, false)
    } else {
        node.to_light / node.chance_to_light
    }
}

fn q(y: &Path, aux: &Aux) -> f64 {
    let (end, k) = (aux.stem, y.edges());
    let density: f64 = (end + 1..=k).map(|i| step_density(y, i)).product();
    let passed = if end > 0 { y.nodes[end - 1].passed } else { 1.0 };
    density / (passed * y.scalar())
}

impl Mutation for Lens {
    fn name(&self) -> &'static str {
        "lens"
    }

    fn applies(&self, x: &Signature) -> bool {
        moving(x).turns == 0
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        propose(space, x, y, rng)
    }

    fn q(&self, _: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        q(y, aux)
    }
}

impl Mutation for MultiChain {
    fn name(&self) -> &'static str {
        "multi-chain"
    }

    fn applies(&self, x: &Signature) -> bool {
        moving(x).turns > 0
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        propose(space, x, y, rng)
    }

    fn q(&self, _: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        q(y, aux)
    }
}
