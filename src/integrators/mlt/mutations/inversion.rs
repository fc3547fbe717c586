//! Perturbation by sampler inversion (mlt.md §3.6 of the design; after Bitterli et al. 2017, "Reversible Jump Metropolis
//! Light Transport using Inverse Mappings", with the technique drawn from its posterior at every step).
//!
//! One of the techniques that could have made the moving vertices is drawn in proportion to its density, the random
//! numbers that it would have used are found by inverting the samplers, moved a little, and used again. Emitters, lobes
//! and Dirac events stay as they are: their probabilities are labels of the move.

use ajar_render::{
    bsdf::{LOBES, Mode, Side},
    math::Frame,
    path::{Kind, Site, Vertex},
    rng::Rng,
    warp,
};
use glam::DVec3;

use super::{
    super::{
        Aux, Mutation, Reject,
        path::{Node, Path, Signature, Space},
        perturb::{raster_offset, unit_offset},
        proposal::Proposal,
    },
    bidirectional::Ranges,
    eye_chain::moving,
};

/// Moves the whole path.
#[derive(Clone, Copy, Debug)]
pub struct Technique;

/// Moves a piece of the path, chosen as the bidirectional mutation does.
#[derive(Clone, Copy, Debug)]
pub struct Window;

/// Moves everything from the lens to the first vertex that can be connected: rough mirrors and lens points too.
#[derive(Clone, Copy, Debug)]
pub struct EyeChain;

/// Moves everything from the light to the first vertex that can be connected.
#[derive(Clone, Copy, Debug)]
pub struct LightChain;

/// What moves.
#[derive(Clone, Copy)]
struct Piece {
    /// Vertices kept on the light's side.
    stem: usize,
    /// Vertices that move.
    count: usize,
    /// How many of them are made from the light's side; `None`: drawn in proportion to the density of doing so.
    split: Option<usize>,
}

impl Mutation for Technique {
    fn name(&self) -> &'static str {
        "technique"
    }

    fn applies(&self, _: &Signature) -> bool {
        true
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        propose(space, x, y, Piece { stem: 0, count: x.edges() + 1, split: None }, rng)
    }

    fn q(&self, _: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        q_of_all_splits(y, aux)
    }
}

impl Mutation for Window {
    fn name(&self) -> &'static str {
        "window"
    }

    fn applies(&self, _: &Signature) -> bool {
        true
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        // Modes do not change, so that the chance of this piece is the same at x and at y.
        let (length, stem) = Ranges::of(x).choose(2, rng).ok_or(Reject::Unsuitable)?;
        propose(space, x, y, Piece { stem, count: length - 1, split: None }, rng)
    }

    fn q(&self, _: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        q_of_all_splits(y, aux)
    }
}

impl Mutation for EyeChain {
    fn name(&self) -> &'static str {
        "eye-chain"
    }

    fn applies(&self, x: &Signature) -> bool {
        !x.is_lit_from_far() || moving(x).end > 0
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        let stem = moving(&x.signature).end;
        if stem == 0 && !x.nodes[0].vertex.can_be_met() {
            return Err(Reject::Unsuitable);
        }
        propose(space, x, y, Piece { stem, count: x.edges() + 1 - stem, split: Some(0) }, rng)
    }

    fn q(&self, _: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        let density: f64 = (aux.stem..=y.edges()).map(|i| y.from_eye(i)).product();
        let passed = if aux.stem > 0 { y.nodes[aux.stem - 1].passed } else { 1.0 };
        density / (passed * y.scalar() * aux.labels[1])
    }
}

/// The first vertex from the light whose neighbour towards the eye it can be connected with.
fn first_pair(x: &Signature) -> Option<usize> {
    (0..x.edges()).find(|&i| x.connectable(i) && x.connectable(i + 1))
}

impl Mutation for LightChain {
    fn name(&self) -> &'static str {
        "light-chain"
    }

    fn applies(&self, x: &Signature) -> bool {
        first_pair(x).is_some()
    }

    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        let count = first_pair(&x.signature).ok_or(Reject::Unsuitable)? + 1;
        propose(space, x, y, Piece { stem: 0, count, split: Some(count) }, rng)
    }

    fn q(&self, _: &Space<'_>, _: &Path, y: &Path, aux: &Aux) -> f64 {
        let density: f64 = (0..aux.added).map(|i| y.from_light(i)).product();
        density / (y.nodes[aux.added - 1].passed * y.scalar() * aux.labels[1])
    }
}

fn q_of_all_splits(y: &Path, aux: &Aux) -> f64 {
    y.density(aux.stem, aux.added) / (y.scalar() * aux.labels[1])
}

fn propose(
    space: &Space<'_>,
    x: &Path,
    y: &mut Proposal,
    Piece { stem, count, split }: Piece,
    rng: &mut Rng,
) -> Result<Aux, Reject> {
    let split = match split {
        Some(split) => split,
        None => choose_split(x, stem, count, rng).ok_or(Reject::Unsuitable)?,
    };
    y.begin(space, x, (stem, stem + count, count))?;
    let mut labels = [1.0; 2];
    for i in stem..stem + split {
        move_from_light(space, x, y, i, &mut labels, rng)?;
    }
    for i in (stem + split..stem + count).rev() {
        move_from_eye(space, x, y, i, &mut labels, rng)?;
    }
    y.join(space)?;
    // Dirac events are labels too; both paths have them at the same places.
    let chance = |node: &Node, i: usize| {
        if (stem..stem + split).contains(&(i + 1)) { node.chance_to_eye } else { node.chance_to_light }
    };
    let sources = stem.saturating_sub(1)..(stem + count + 1).min(x.nodes.len());
    for i in sources.filter(|&i| !x.connectable(i)) {
        labels[0] *= chance(&x.nodes[i], i);
        labels[1] *= chance(&y.path.nodes[i], i);
    }
    Ok(Aux { stem, removed: count, added: count, labels })
}

/// The number of vertices to make from the light's side, in proportion to the density of doing so.
fn choose_split(x: &Path, stem: usize, count: usize, rng: &mut Rng) -> Option<usize> {
    let mut rest = rng.f64() * x.density(stem, count);
    let mut chosen = None;
    x.splits(stem, count, |s, p| {
        if p > 0.0 && (rest >= 0.0 || chosen.is_none()) {
            chosen = Some(s);
        }
        rest -= p;
    });
    chosen
}

/// Makes y_i from y_{i-1} as x_i was made from x_{i-1}.
fn move_from_light(
    space: &Space<'_>,
    x: &Path,
    y: &mut Proposal,
    i: usize,
    labels: &mut [f64; 2],
    rng: &mut Rng,
) -> Result<(), Reject> {
    if i == 0 {
        y.push_light(move_light(space, &x.nodes[0].vertex, rng)?);
        return Ok(());
    }
    let from = &x.nodes[i - 1];
    if i == 1 {
        if from.vertex.kind == Kind::Surface {
            let direction = turn_emission(&from.vertex, from.edge.to_eye, y.light_end(), rng)?;
            return y.go_from_light(space, direction, rng);
        }
        return y.sample_from_light(space, 1, rng);
    }
    if !from.vertex.connectable() {
        return y.force_from_light(space, from.vertex.mode, rng);
    }
    let known = [-x.nodes[i - 2].edge.to_eye, y.light_known()];
    let to = y.light_end().ok_or(Reject::Lost)?;
    let direction =
        turn_scattering(Side::TowardEye, [&from.vertex, to], known, from.edge.to_eye, labels, rng)?;
    y.go_from_light(space, direction, rng)
}

/// Makes y_i from y_{i+1} as x_i was made from x_{i+1}.
fn move_from_eye(
    space: &Space<'_>,
    x: &Path,
    y: &mut Proposal,
    i: usize,
    labels: &mut [f64; 2],
    rng: &mut Rng,
) -> Result<(), Reject> {
    let k = x.edges();
    if i == k {
        y.move_raster(space, raster_offset(space, rng))?;
        y.push_lens(space, unit_offset(x.lens, rng));
        return Ok(());
    }
    if i + 1 == k {
        if y.starts_at_kept_lens() {
            y.move_raster(space, raster_offset(space, rng))?;
        }
        return y.go_from_lens(space, rng);
    }
    let from = &x.nodes[i + 1];
    if !from.vertex.connectable() {
        return y.force_from_eye(space, from.vertex.mode, rng);
    }
    let (to, known) = y.eye_end().ok_or(Reject::Lost)?;
    let known = [from.edge.to_eye, known];
    let old = -x.nodes[i].edge.to_eye;
    let direction = turn_scattering(Side::TowardLight, [&from.vertex, to], known, old, labels, rng)?;
    y.go_from_eye(space, direction, rng)
}

/// Moves a light end on its emitter.
fn move_light(space: &Space<'_>, x0: &Vertex, rng: &mut Rng) -> Result<Vertex, Reject> {
    match x0.kind {
        Kind::Surface => {
            let u = unit_offset(warp::triangle_to_square(x0.site.uv), rng);
            Ok(space.world.surface(Site { uv: warp::square_to_triangle(u), ..x0.site }))
        }
        Kind::Environment => {
            // Its sampler is a mixture without inverse here: a new direction, independent of the old one.
            let (y0, _) = space.world.lights.sample(rng.f64(), rng.pair()).ok_or(Reject::Lost)?;
            if y0.kind == Kind::Environment { Ok(y0) } else { Err(Reject::Unsuitable) }
        }
        Kind::PointLight | Kind::DirectionalLight | Kind::Lens => Ok(*x0),
    }
}

/// Moves the direction in which a surface emits, on the same side.
fn turn_emission(x0: &Vertex, old: DVec3, y0: Option<&Vertex>, rng: &mut Rng) -> Result<DVec3, Reject> {
    let y0 = y0.ok_or(Reject::Lost)?;
    let side = 1f64.copysign(x0.ng.dot(old));
    let u = warp::cosine_hemisphere_to_square(Frame::from_z(x0.ng * side).to_local(old));
    let local = warp::square_to_cosine_hemisphere(unit_offset(u, rng));
    Ok(Frame::from_z(y0.ng * side).to_world(local))
}

/// Moves the direction in which a smooth vertex scatters, in a lobe drawn from those that may have given the old one.
fn turn_scattering(
    side: Side,
    [x, y]: [&Vertex; 2],
    known: [DVec3; 2],
    old: DVec3,
    labels: &mut [f64; 2],
    rng: &mut Rng,
) -> Result<DVec3, Reject> {
    let (known_x, old) = (x.frame.to_local(known[0]), x.frame.to_local(old));
    let weights = x.bsdf.lobe_weights(side, known_x);
    let mut densities = [0.0; LOBES];
    for (lobe, density) in densities.iter_mut().enumerate().filter(|(lobe, _)| weights[*lobe] > 0.0) {
        *density = weights[lobe] * x.bsdf.lobe_pdf(side, known_x, lobe, old);
    }
    let lobe = choose(&densities, rng).ok_or(Reject::Unsuitable)?;
    let u = x.bsdf.invert(side, known_x, lobe, old).ok_or(Reject::Unsuitable)?;
    let known_y = y.frame.to_local(known[1]);
    let weight = y.bsdf.lobe_weights(side, known_y)[lobe];
    if weight <= 0.0 {
        return Err(Reject::Unsuitable);
    }
    let sample = y.bsdf.sample_lobe(side, known_y, lobe, unit_offset(u, rng)).ok_or(Reject::Absorbed)?;
    if sample.mode != Mode::Smooth {
        return Err(Reject::Unsuitable);
    }
    labels[0] *= weights[lobe];
    labels[1] *= weight;
    Ok(y.frame.to_world(sample.direction))
}

fn choose(weights: &[f64; LOBES], rng: &mut Rng) -> Option<usize> {
    let mut rest = rng.f64() * weights.iter().sum::<f64>();
    let mut chosen = None;
    for (lobe, &weight) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
        chosen = Some(lobe);
        rest -= weight;
        if rest < 0.0 {
            break;
        }
    }
    chosen
}
