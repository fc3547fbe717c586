//! A path in the making: x_0 … x_l of the old one, new vertices from both ends, x_m … x_k of the old one.
//!
//! Nothing here knows densities: walks choose directions and cast rays, [`Proposal::join`] measures the result.

use ajar_render::{
    bsdf::{Mode, Side},
    path::{Kind, Vertex},
    rng::Rng,
};
use glam::{DVec2, DVec3};

use super::{
    Reject,
    path::{Node, Path, Space},
    strata::Strata,
};
use crate::bdpt::MAX_VERTICES;

/// A path in the making; keeps its memory.
#[derive(Debug)]
pub struct Proposal {
    /// The kept light side and the new vertices from it; after [`Proposal::join`] the whole path.
    pub path: Path,
    /// From the first vertex that the eye's side starts from, kept or new, towards the light.
    tail: Vec<Node>,
    /// Index of the first kept vertex of the eye's side in the old path; its edges + 1 if none is.
    kept: usize,
    /// Number of vertices kept on the light's side.
    stem: usize,
    /// Directions from the ends to the vertices before them.
    to_light: DVec3,
    to_eye: DVec3,
    /// Whether the lens of the eye's side is new.
    new_lens: bool,
    /// Where the chain stands among others.
    pub strata: Strata,
    /// Rays cast so far.
    pub rays: u64,
}

impl Default for Proposal {
    fn default() -> Self {
        Self {
            path: Path::with_capacity(),
            tail: Vec::with_capacity(MAX_VERTICES),
            kept: 0,
            stem: 0,
            to_light: DVec3::ZERO,
            to_eye: DVec3::ZERO,
            new_lens: false,
            strata: Strata::default(),
            rays: 0,
        }
    }
}

impl Proposal {
    /// Keeps the first `stem` vertices of `x` and those from `x_kept` on.
    pub fn begin(&mut self, x: &Path, stem: usize, kept: usize) {
        (self.stem, self.kept) = (stem, kept);
        self.path.nodes.clear();
        self.path.nodes.extend_from_slice(&x.nodes[..stem]);
        (self.path.raster, self.path.lens, self.path.light) = (x.raster, x.lens, x.light);
        if stem >= 2 {
            self.to_light = -x.nodes[stem - 2].edge.to_eye;
        }
        self.tail.clear();
        self.new_lens = false;
        if let Some(node) = x.nodes.get(kept) {
            self.tail.push(*node);
            self.to_eye = node.edge.to_eye;
        }
    }

    /// The last vertex of the light's side.
    pub fn light_end(&self) -> Option<&Vertex> {
        self.path.nodes.last().map(|node| &node.vertex)
    }

    /// The last vertex of the eye's side, and the direction to the one before it.
    pub fn eye_end(&self) -> Option<(&Vertex, DVec3)> {
        self.tail.last().map(|node| (&node.vertex, self.to_eye))
    }

    /// Direction from the last vertex of the light's side to the one before it.
    pub fn light_known(&self) -> DVec3 {
        self.to_light
    }

    /// Whether the eye's side has only a kept vertex so far, the lens.
    pub fn starts_at_kept_lens(&self) -> bool {
        matches!(self.tail.as_slice(), [node] if node.vertex.kind == Kind::Lens) && !self.new_lens
    }

    /// Whether the eye's side scatters smoothly anywhere between its ends.
    pub fn has_smooth_between_ends(&self) -> bool {
        let between = 1..self.tail.len().saturating_sub(1);
        self.tail[between].iter().any(|node| node.vertex.connectable())
    }

    /// Adds `x0` as the new light end.
    pub fn push_light(&mut self, x0: Vertex) {
        self.path.nodes.push(Node::new(x0));
    }

    /// Adds a new lens vertex at the lens point `lens`. Its place may depend on the raster position.
    pub fn push_lens(&mut self, space: &Space<'_>, lens: [f64; 2]) {
        (self.path.lens, self.new_lens) = (lens, true);
        let origin = space.world.camera.ray(self.path.raster, lens).origin;
        self.tail.push(Node::new(space.world.lens_vertex(origin)));
    }

    /// Adds `n` vertices to the light's side by sampling.
    ///
    /// # Errors
    /// The walk was lost or absorbed.
    pub fn sample_from_light(&mut self, space: &Space<'_>, n: usize, rng: &mut Rng) -> Result<(), Reject> {
        for _ in 0..n {
            if self.path.nodes.is_empty() {
                let (x0, _) = space.world.lights.sample(rng.f64(), rng.pair()).ok_or(Reject::Lost)?;
                self.push_light(x0);
                continue;
            }
            let index = self.path.nodes.len() - 1;
            let kept = self.path.nodes.len() == self.stem;
            let vertex = &mut self.path.nodes[index].vertex;
            if index == 0 {
                let emission = space.world.lights.emit(vertex, rng.pair(), rng.f64()).ok_or(Reject::Lost)?;
                let direction = emission.direction;
                let origin = if vertex.infinite() { emission.origin } else { vertex.leave(direction) };
                self.arrive_from_light(space, origin, direction, rng)?;
            } else {
                let direction = scatter(vertex, Side::TowardEye, self.to_light, kept, rng)?;
                self.go_from_light(space, direction, rng)?;
            }
        }
        Ok(())
    }

    /// Adds the vertex that the last one of the light's side sees in `direction`.
    ///
    /// # Errors
    /// There is none.
    pub fn go_from_light(
        &mut self,
        space: &Space<'_>,
        direction: DVec3,
        rng: &mut Rng,
    ) -> Result<(), Reject> {
        let origin = self.light_end().ok_or(Reject::Lost)?.leave(direction);
        self.arrive_from_light(space, origin, direction, rng)
    }

    fn arrive_from_light(
        &mut self,
        space: &Space<'_>,
        origin: DVec3,
        direction: DVec3,
        rng: &mut Rng,
    ) -> Result<(), Reject> {
        let seed = if space.world.has_alpha() { rng.next_u32() } else { 0 };
        self.rays += 1;
        let vertex = space.world.trace(origin, direction, false, seed).ok_or(Reject::Lost)?;
        self.path.nodes.push(Node::new(vertex));
        self.to_light = -direction;
        Ok(())
    }

    /// Adds `n` vertices to the eye's side by sampling, a lens first if none is kept.
    ///
    /// # Errors
    /// The walk was lost or absorbed.
    pub fn sample_from_eye(&mut self, space: &Space<'_>, n: usize, rng: &mut Rng) -> Result<(), Reject> {
        for i in 0..n {
            if self.tail.is_empty() {
                self.path.raster = space.raster(rng.pair());
                self.push_lens(space, rng.pair());
                continue;
            }
            let kept = i == 0 && !self.new_lens;
            let index = self.tail.len() - 1;
            let vertex = &mut self.tail[index].vertex;
            if vertex.kind == Kind::Lens {
                if kept {
                    self.path.raster = space.raster(rng.pair());
                }
                self.go_from_lens(space, rng)?;
            } else {
                let direction = scatter(vertex, Side::TowardLight, self.to_eye, kept, rng)?;
                self.go_from_eye(space, direction, rng)?;
            }
        }
        Ok(())
    }

    /// Adds the vertex seen at the raster position through the lens point.
    ///
    /// # Errors
    /// There is none.
    pub fn go_from_lens(&mut self, space: &Space<'_>, rng: &mut Rng) -> Result<(), Reject> {
        let ray = space.world.camera.ray(self.path.raster, self.path.lens);
        if let Some(lens) = self.tail.last_mut() {
            lens.vertex.p = ray.origin;
        }
        self.go_from_eye(space, ray.direction, rng)
    }

    /// Adds what the last vertex of the eye's side sees in `direction`, surface or surroundings.
    ///
    /// # Errors
    /// There is nothing, or something follows the surroundings.
    pub fn go_from_eye(&mut self, space: &Space<'_>, direction: DVec3, rng: &mut Rng) -> Result<(), Reject> {
        let from = &self.tail.last().ok_or(Reject::Lost)?.vertex;
        if from.infinite() {
            return Err(Reject::Lost);
        }
        let seed = if space.world.has_alpha() { rng.next_u32() } else { 0 };
        self.rays += 1;
        let seen = space.world.trace(from.leave(direction), direction, from.kind == Kind::Lens, seed);
        let seen = seen.or_else(|| space.world.lights.surroundings(direction)).ok_or(Reject::Lost)?;
        self.tail.push(Node::new(seen));
        self.to_eye = -direction;
        Ok(())
    }

    /// Makes the last vertex of the eye's side continue as the Dirac event `mode`, and adds what it sees then.
    ///
    /// # Errors
    /// The surface has no such event.
    pub fn force_from_eye(&mut self, space: &Space<'_>, mode: Mode, rng: &mut Rng) -> Result<(), Reject> {
        let to_eye = self.to_eye;
        let vertex = &mut self.tail.last_mut().ok_or(Reject::Lost)?.vertex;
        let direction = force(vertex, Side::TowardLight, to_eye, mode)?;
        self.go_from_eye(space, direction, rng)
    }

    /// The same for the light's side.
    ///
    /// # Errors
    /// The surface has no such event.
    pub fn force_from_light(&mut self, space: &Space<'_>, mode: Mode, rng: &mut Rng) -> Result<(), Reject> {
        let to_light = self.to_light;
        let vertex = &mut self.path.nodes.last_mut().ok_or(Reject::Lost)?.vertex;
        let direction = force(vertex, Side::TowardEye, to_light, mode)?;
        self.go_from_light(space, direction, rng)
    }

    /// Joins both sides and the kept end of `x`, and measures the new path. A connection to the lens finds its raster
    /// position.
    ///
    /// # Errors
    /// Why the path carries no light.
    pub fn join(&mut self, space: &Space<'_>, x: &Path) -> Result<(), Reject> {
        let (stem, light_side) = (self.stem, self.path.nodes.len());
        let eye_keeps = self.kept <= x.edges();
        // The first vertex of the tail is a copy of the kept one, apart from the lens, which may have moved.
        self.path.nodes.extend(self.tail.drain(..).rev());
        let end = self.path.nodes.len() - 1;
        if eye_keeps {
            self.path.nodes.extend_from_slice(&x.nodes[self.kept + 1..]);
        }
        let k = self.path.edges();
        if k < 2 || k > space.max_depth {
            return Err(Reject::Unsuitable);
        }
        let connection = light_side.checked_sub(1);
        if connection == Some(k - 1) {
            self.connect_lens(space)?;
        }
        if connection.is_none() && self.path.nodes[0].vertex.emitter == Vertex::NO_EMITTER {
            return Err(Reject::Black);
        }
        // The surroundings end a path; they are nowhere else.
        if self.path.nodes[1..].iter().any(|node| node.vertex.infinite()) {
            return Err(Reject::Lost);
        }
        self.rays += u64::from(connection.is_some());
        self.path.measure(space, (stem.saturating_sub(1), end), connection)
    }

    fn connect_lens(&mut self, space: &Space<'_>) -> Result<(), Reject> {
        let lens = self.path.lens;
        let [.., last, end] = self.path.nodes.as_mut_slice() else { return Err(Reject::Unsuitable) };
        if last.vertex.infinite() {
            return Err(Reject::Lost);
        }
        let seen = space.world.camera.connect(last.vertex.p, lens).ok_or(Reject::Outside)?;
        if space.pixel(seen.raster).is_none() {
            return Err(Reject::Outside);
        }
        end.vertex.p = seen.lens;
        self.path.raster = seen.raster;
        Ok(())
    }

    /// Moves the raster position by `offset` pixels.
    ///
    /// # Errors
    /// It leaves the window.
    pub fn move_raster(&mut self, space: &Space<'_>, offset: DVec2) -> Result<(), Reject> {
        self.path.raster += offset;
        space.pixel(self.path.raster).map(|_| ()).ok_or(Reject::Outside)
    }
}

/// Samples the direction in which a walk goes on from `vertex`, and sets its mode. A kept vertex has to stay smooth.
fn scatter(
    vertex: &mut Vertex,
    side: Side,
    known: DVec3,
    kept: bool,
    rng: &mut Rng,
) -> Result<DVec3, Reject> {
    let (u_lobe, u) = (rng.f64(), rng.pair());
    let sample = vertex.bsdf.sample(side, vertex.frame.to_local(known), u_lobe, u).ok_or(Reject::Absorbed)?;
    if sample.mode == Mode::Smooth {
        return Ok(vertex.frame.to_world(sample.direction));
    }
    if kept {
        return Err(Reject::Unsuitable);
    }
    force(vertex, side, known, sample.mode)
}

fn force(vertex: &mut Vertex, side: Side, known: DVec3, mode: Mode) -> Result<DVec3, Reject> {
    let step = vertex.dirac_step(side, known, mode).ok_or(Reject::Unsuitable)?;
    vertex.mode = mode;
    Ok(step.direction)
}
