//! Walks of a proposal: new vertices, by the samplers, in a given direction, or by a Dirac event.

use ajar_render::{
    bsdf::{Mode, Side},
    path::{Kind, Vertex},
    rng::Rng,
};
use glam::DVec3;

use super::{
    super::{Reject, path::Space},
    Proposal,
};

impl Proposal {
    /// Adds `n` vertices to the light's side by sampling.
    ///
    /// # Errors
    /// The walk was lost or absorbed.
    pub fn sample_from_light(&mut self, space: &Space<'_>, n: usize, rng: &mut Rng) -> Result<(), Reject> {
        for _ in 0..n {
            let Some(end) = self.light.checked_sub(1) else {
                let (x0, _) = space.world.lights.sample(rng.f64(), rng.pair()).ok_or(Reject::Lost)?;
                self.push_light(x0);
                continue;
            };
            let kept = self.light == self.new.start;
            let vertex = &mut self.path.nodes[end].vertex;
            if end == 0 {
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
        let node = &mut self.path.nodes[self.light];
        if !space.world.trace_into(origin, direction, false, seed, &mut node.vertex) {
            return Err(Reject::Lost);
        }
        node.arrived();
        self.light += 1;
        self.to_light = -direction;
        Ok(())
    }

    /// Adds `n` vertices to the eye's side by sampling, a lens first if none is kept.
    ///
    /// # Errors
    /// The walk was lost or absorbed.
    pub fn sample_from_eye(&mut self, space: &Space<'_>, n: usize, rng: &mut Rng) -> Result<(), Reject> {
        for i in 0..n {
            if self.eye == self.path.nodes.len() {
                self.path.raster = space.raster(rng.pair());
                self.push_lens(space, rng.pair());
                continue;
            }
            let kept = i == 0 && !self.new_lens;
            let vertex = &mut self.path.nodes[self.eye].vertex;
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
        self.path.nodes[self.eye].vertex.p = ray.origin;
        self.go_from_eye(space, ray.direction, rng)
    }

    /// Adds what the last vertex of the eye's side sees in `direction`, surface or surroundings.
    ///
    /// # Errors
    /// There is nothing, or something follows the surroundings.
    pub fn go_from_eye(&mut self, space: &Space<'_>, direction: DVec3, rng: &mut Rng) -> Result<(), Reject> {
        let from = &self.path.nodes[self.eye].vertex;
        if from.infinite() {
            return Err(Reject::Lost);
        }
        let seed = if space.world.has_alpha() { rng.next_u32() } else { 0 };
        self.rays += 1;
        let (origin, from_lens) = (from.leave(direction), from.kind == Kind::Lens);
        let node = &mut self.path.nodes[self.eye - 1];
        if !space.world.trace_into(origin, direction, from_lens, seed, &mut node.vertex) {
            node.vertex = space.world.lights.surroundings(direction).ok_or(Reject::Lost)?;
        }
        node.arrived();
        self.eye -= 1;
        self.to_eye = -direction;
        Ok(())
    }

    /// Makes the last vertex of the eye's side continue as the Dirac event `mode`, and adds what it sees then.
    ///
    /// # Errors
    /// The surface has no such event.
    pub fn force_from_eye(&mut self, space: &Space<'_>, mode: Mode, rng: &mut Rng) -> Result<(), Reject> {
        let vertex = &mut self.path.nodes[self.eye].vertex;
        let direction = force(vertex, Side::TowardLight, self.to_eye, mode)?;
        self.go_from_eye(space, direction, rng)
    }

    /// The same for the light's side.
    ///
    /// # Errors
    /// The surface has no such event.
    pub fn force_from_light(&mut self, space: &Space<'_>, mode: Mode, rng: &mut Rng) -> Result<(), Reject> {
        let vertex = &mut self.path.nodes[self.light - 1].vertex;
        let direction = force(vertex, Side::TowardEye, self.to_light, mode)?;
        self.go_from_light(space, direction, rng)
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
