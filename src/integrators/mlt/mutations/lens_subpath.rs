//! Lens subpath mutation (Veach & Guibas 1997 §4.3.4): suffix (L|D)DS*E. Another eye subpath replaces the old one up to
//! the first smooth vertex, so that chains spread evenly over the image.

use ajar_render::{bsdf::Side, rng::Rng};

use super::super::{
    Aux, Mutation, Reject,
    path::{Path, Signature, Space},
    proposal::Proposal,
};

/// Jumps across the image.
#[derive(Clone, Copy, Debug)]
pub struct LensSubpath;

/// Index of the first smooth vertex from the lens, if a connectable one precedes it.
fn end(x: &Signature) -> Option<usize> {
    let end = (1..x.edges()).rev().find(|&i| x.connectable(i))?;
    x.connectable(end - 1).then_some(end)
}

impl Mutation for LensSubpath {
    fn name(&self) -> &'static str {
        "lens-subpath"
    }

    fn applies(&self, x: &Signature) -> bool {
        end(x).is_some()
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, _: &mut Rng) -> Result<Aux, Reject> {
        let (end, k) = (end(&x.signature).ok_or(Reject::Unsuitable)?, x.edges());
        let added = y.begin_lens_subpath(space, x, end)?;
        y.join(space)?;
        Ok(Aux { stem: end, removed: k + 1 - end, added, ..Aux::default() })
    }

    fn q(&self, _: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        let density: f64 = (aux.stem..=y.edges()).map(|i| y.from_eye(i)).product();
        // The subpath ended because no Dirac event was chosen.
        let node = &y.nodes[aux.stem];
        let known = node.vertex.frame.to_local(node.edge.to_eye);
        let chances = node.vertex.bsdf.dirac_chances(Side::TowardLight, known);
        density * (1.0 - chances.iter().sum::<f64>()) / (y.nodes[aux.stem - 1].passed * y.scalar())
    }
}
