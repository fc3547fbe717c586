//! Manifold perturbation (Jakob & Marschner 2012): moves a smooth vertex b that sees the next one towards the light, c,
//! through mirrors and lenses, while c stays. The chain between them is found again from its old shape.
//!
//! The step that moves b is the one of the lens or of a turned direction at the smooth vertex before it. The chain
//! follows from both ends, so its part of the density is how much the light's direction at c turns when b moves.

use ajar_render::{path::Vertex, rng::Rng};

use super::{
    super::{
        Aux, Mutation, Reject,
        manifold::{Walker, generalized_geometry},
        path::{Path, Signature, Space},
        perturb::{raster_offset, turn},
        proposal::Proposal,
    },
    eye_chain::step_density,
};

/// Caustics of small lights, directly seen or through other mirrors and lenses.
#[derive(Clone, Copy, Debug)]
pub struct Manifold;

/// Indices of the three smooth vertices: the fixed one, the moving one, the one that it moves from.
#[derive(Clone, Copy)]
struct Place {
    c: usize,
    b: usize,
    a: usize,
}

/// All places, from the eye.
fn places(x: &Signature) -> impl Iterator<Item = Place> {
    let next = |from: usize| (0..from).rev().find(|&i| x.connectable(i));
    std::iter::successors(Some(x.edges()), move |&a| next(a)).filter_map(move |a| {
        let b = next(a)?;
        let c = next(b)?;
        (c + 1 < b).then_some(Place { c, b, a })
    })
}

/// How near the way back has to come to the old chain, relative to its length.
const RETURN: f64 = 1e-4;

impl Mutation for Manifold {
    fn name(&self) -> &'static str {
        "manifold"
    }

    fn applies(&self, x: &Signature) -> bool {
        places(x).next().is_some()
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        let count = places(&x.signature).count();
        let chosen = places(&x.signature).nth(rng.below(count.max(1)));
        let Place { c, b, a } = chosen.ok_or(Reject::Unsuitable)?;
        if space.world.has_alpha() {
            // The chain would pass half-covered surfaces by chance, and the way back would not.
            return Err(Reject::Unsuitable);
        }
        y.begin(space, x, (c + 1, a, a - c - 1))?;
        if a == x.edges() {
            y.move_raster(space, raster_offset(space, rng))?;
            y.go_from_lens(space, rng)?;
        } else {
            y.go_from_eye(space, turn(-x.nodes[a - 1].edge.to_eye, rng), rng)?;
        }
        for node in x.nodes[b + 1..a].iter().rev() {
            y.force_from_eye(space, node.vertex.mode, rng)?;
        }
        let target = *y.eye_end().ok_or(Reject::Lost)?.0;
        if target.infinite() || !target.bsdf.has_smooth() {
            return Err(Reject::Lost);
        }
        let old: Vec<Vertex> = x.nodes[c..=b].iter().map(|node| node.vertex).collect();
        let mut walker = Walker { world: space.world, rays: 0 };
        let found = there_and_back(&mut walker, &old, &target);
        y.rays += walker.rays;
        y.place_from_light(&found?[1..b - c]);
        y.join(space)?;
        Ok(Aux { stem: c + 1, removed: a - c - 1, added: a - c - 1, ..Aux::default() })
    }

    fn q(&self, space: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        let (c, a) = (aux.stem - 1, aux.stem + aux.added);
        let Some(b) = (c + 1..a).rev().find(|&i| y.connectable(i)) else { return 0.0 };
        let chain: Vec<Vertex> = y.nodes[c..=b].iter().map(|node| node.vertex).collect();
        let Some(geometry) = generalized_geometry(space.world, &chain) else { return 0.0 };
        let density: f64 = (b + 1..=a).map(|i| step_density(y, i)).product();
        density / (geometry * y.scalar())
    }
}

/// The chain that ends at `target`, if `old` is found again from it.
fn there_and_back(walker: &mut Walker<'_>, old: &[Vertex], target: &Vertex) -> Result<Vec<Vertex>, Reject> {
    let mut chain = old.to_vec();
    walker.move_end(&mut chain, target)?;
    let mut back = chain.clone();
    let end = old.last().ok_or(Reject::Unsuitable)?;
    walker.move_end(&mut back, end)?;
    let inner = 1..old.len() - 1;
    let length: f64 = old[1..].windows(2).map(|pair| (pair[1].p - pair[0].p).length()).sum();
    let far = |(a, b): (&Vertex, &Vertex)| (a.p - b.p).length() > RETURN * length;
    if old[inner.clone()].iter().zip(&back[inner]).any(far) {
        return Err(Reject::Unsuitable);
    }
    Ok(chain)
}
