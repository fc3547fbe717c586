//! Caustic perturbation (Veach & Guibas 1997 §4.3.2): suffix (D|L)S⁺DE. Turns the direction in which light enters the
//! chain of mirrors and lenses; the first diffuse surface after it is connected to the lens.

use ajar_render::rng::Rng;

use super::super::{
    Aux, Mutation, Reject,
    path::{Path, Signature, Space},
    perturb::turn,
    proposal::Proposal,
};

/// Moves along the light inside a caustic.
#[derive(Clone, Copy, Debug)]
pub struct Caustic;

/// Index of the vertex before the Dirac chain that ends at x_{k-1}.
fn start(x: &Path) -> Option<usize> {
    start_of(&x.signature)
}

fn start_of(x: &Signature) -> Option<usize> {
    let k = x.edges();
    if k < 3 || !x.connectable(k - 1) || x.connectable(k - 2) {
        return None;
    }
    let start = (0..k - 2).rev().find(|&i| x.connectable(i))?;
    (start > 0 || !x.is_lit_from_far()).then_some(start)
}

impl Mutation for Caustic {
    fn name(&self) -> &'static str {
        "caustic"
    }

    fn applies(&self, x: &Signature) -> bool {
        start_of(x).is_some()
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        let (start, k) = (start(x).ok_or(Reject::Unsuitable)?, x.edges());
        y.begin(space, x, (start + 1, k, k - 1 - start))?;
        let direction = turn(x.nodes[start].edge.to_eye, rng);
        y.go_from_light(space, direction, rng)?;
        for node in &x.nodes[start + 1..k - 1] {
            y.force_from_light(space, node.vertex.mode, rng)?;
        }
        y.join(space)?;
        let count = k - 1 - start;
        Ok(Aux { stem: start + 1, removed: count, added: count, ..Aux::default() })
    }

    fn q(&self, _: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        let (start, k) = (aux.stem - 1, y.edges());
        let first = &y.nodes[start];
        // A turned direction has a density per solid angle that is the same back and forth.
        let turned = first.edge.density(1.0, &first.vertex, &y.nodes[aux.stem].vertex, false);
        let forced: f64 =
            y.nodes[aux.stem..k - 1].iter().map(|node| node.to_eye / node.chance_to_eye).product();
        turned * forced / (y.nodes[k - 1].passed * y.scalar())
    }
}
