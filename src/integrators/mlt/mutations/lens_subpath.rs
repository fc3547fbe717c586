//! Lens subpath mutation (Veach & Guibas 1997 §4.3.4): suffix (L|D)DS*E. A new eye subpath through a stratified raster
//! position replaces the old one, so that chains spread evenly over the image.
//!
//! The seed paper lets each chain work through a list of pixels; then proposals depend on the chain's past. Here the
//! strata are dealt out across the chains of a round ([`super::super::strata`]).

use ajar_render::rng::Rng;

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

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        let (end, k) = (end(&x.signature).ok_or(Reject::Unsuitable)?, x.edges());
        y.begin(space, x, (end, k + 1, k + 1 - end))?;
        y.path.raster = space.raster(y.strata.next(rng.pair()));
        y.push_lens(space, rng.pair());
        y.sample_from_eye(space, k - end, rng)?;
        if y.has_smooth_between_ends() {
            return Err(Reject::Unsuitable);
        }
        y.join(space)?;
        Ok(Aux { stem: end, removed: k + 1 - end, added: k + 1 - end, ..Aux::default() })
    }

    fn q(&self, _: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        let density: f64 = (aux.stem..=y.edges()).map(|i| y.from_eye(i)).product();
        density / (y.nodes[aux.stem - 1].passed * y.scalar())
    }
}
