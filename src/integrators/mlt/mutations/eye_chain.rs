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
struct Moving {
    /// Index of the last moving vertex, counted from the lens: a smooth one or the light.
    end: usize,
    /// Smooth vertices between chains.
    turns: usize,
}

/// From the lens to the first smooth vertex that has a connectable one before it, or to the light.
fn moving(x: &Signature) -> Moving {
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

fn q(y: &Path, aux: &Aux) -> f64 {
    let (end, k) = (aux.stem, y.edges());
    // Raster positions and directions move by densities that are the same back and forth.
    let mut density = y.nodes[k].to_light;
    for i in end + 1..k {
        let node = &y.nodes[i];
        density *= if y.connectable(i) {
            y.nodes[i - 1].edge.density(1.0, &node.vertex, &y.nodes[i - 1].vertex, false)
        } else {
            node.to_light / node.chance_to_light
        };
    }
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
