//! Rays through the world: what they meet and what gets through.

use std::cell::Cell;

use glam::DVec3;

use super::World;
use crate::{
    bvh::{Hit, Met, segment},
    math::Rgb,
    path::{Edge, Kind, Site, Vertex},
    ray::Ray,
};

impl World {
    /// The first surface that a ray meets. `from_lens` lets it through the backs of culled materials. Where opacity is
    /// partial, the surface is met with that probability, decided by a hash of `seed` and the hit.
    pub fn trace(&self, origin: DVec3, direction: DVec3, from_lens: bool, seed: u32) -> Option<Vertex> {
        let mut vertex = Vertex::isolated(Kind::Surface, DVec3::ZERO, Vertex::NO_EMITTER);
        self.trace_into(origin, direction, from_lens, seed, &mut vertex).then_some(vertex)
    }

    /// As [`World::trace`], in place: vertices are too large to be handed around at every step. If it meets nothing, the
    /// vertex stays as it is.
    pub fn trace_into(
        &self,
        origin: DVec3,
        direction: DVec3,
        from_lens: bool,
        seed: u32,
        vertex: &mut Vertex,
    ) -> bool {
        let ray = Ray::new(origin, direction);
        if self.has_alpha || (from_lens && self.has_culling) {
            self.nearest_solid(&ray, from_lens, seed).is_some_and(|met| self.set_met(&met, vertex))
        } else {
            self.geometry.nearest(&ray).is_some_and(|met| self.set_met(&met, vertex))
        }
    }

    /// Makes `vertex` that of a hit; always true.
    #[inline]
    fn set_met(&self, Met { hit, vertices }: &Met, vertex: &mut Vertex) -> bool {
        let uv = [f64::from(hit.u), f64::from(hit.v)];
        self.set_surface(Site { instance: hit.instance, triangle: hit.triangle, uv }, vertices, vertex);
        true
    }

    fn nearest_solid(&self, ray: &Ray, from_lens: bool, seed: u32) -> Option<Met> {
        self.geometry.intersect(ray, |hit| {
            if from_lens && self.culled(hit, ray.direction) {
                return false;
            }
            let opacity = self.opacity(hit);
            opacity >= 1.0 || uniform(hit, seed) < opacity
        })
    }

    /// Share of light that crosses the edge: 1 or 0, or the product of what partial opacities let through, times
    /// absorption.
    pub fn transmittance(&self, light: &Vertex, eye: &Vertex, edge: &Edge) -> Rgb {
        let passed = self.passed(light, eye);
        if passed > 0.0 { self.absorption(light, eye, edge) * passed } else { Rgb::ZERO }
    }

    /// Share of light that surfaces on the way let through: 1 or 0, or the product of what partial opacities leave.
    pub fn passed(&self, light: &Vertex, eye: &Vertex) -> f64 {
        let from_lens = eye.kind == Kind::Lens;
        let ray = if light.infinite() {
            Ray::new(eye.leave(light.p), light.p)
        } else {
            segment(&eye.anchor(), &light.anchor())
        };
        if self.has_alpha || (from_lens && self.has_culling) {
            self.passed_along(&ray, from_lens)
        } else {
            f64::from(u8::from(!self.geometry.blocked(&ray)))
        }
    }

    /// Product of what the surfaces along a ray let through.
    fn passed_along(&self, ray: &Ray, from_lens: bool) -> f64 {
        let passed = Cell::new(1.0);
        let blocked = self.geometry.occluded(ray, |hit| {
            if from_lens && self.culled(hit, ray.direction) {
                return false;
            }
            passed.set(passed.get() * (1.0 - self.opacity(hit)));
            passed.get() <= 0.0
        });
        if blocked { 0.0 } else { passed.get() }
    }

    /// Share of light that the medium along the edge leaves. The medium is that of the light end if the edge leaves it
    /// inwards, else that of the eye end: a rule about the path, not about the direction it was built in.
    #[inline]
    pub fn absorption(&self, light: &Vertex, eye: &Vertex, edge: &Edge) -> Rgb {
        if self.has_absorption { self.absorbed(light, eye, edge) } else { Rgb::ONE }
    }

    fn absorbed(&self, light: &Vertex, eye: &Vertex, edge: &Edge) -> Rgb {
        let inside = |vertex: &Vertex, w: DVec3| {
            (vertex.kind == Kind::Surface && vertex.ng.dot(w) < 0.0)
                .then(|| self.material_of(vertex).absorption())
                .flatten()
        };
        match inside(light, edge.to_eye).or_else(|| inside(eye, -edge.to_eye)) {
            Some(coefficient) => (-coefficient * edge.length).exp(),
            None => Rgb::ONE,
        }
    }

    fn culled(&self, hit: &Hit, direction: DVec3) -> bool {
        let instance = &self.instances[hit.instance as usize];
        self.materials[instance.material as usize].cull_back()
            && self.triangle_normal(hit.instance, hit.triangle).dot(direction) > 0.0
    }
}

/// A number in [0, 1) that depends on the place hit and the seed alone, so that the answer does not depend on how often
/// or in which order traversal asks.
fn uniform(hit: &Hit, seed: u32) -> f64 {
    let mut h = seed ^ 0x9E37_79B9;
    for word in [hit.instance, hit.triangle, hit.u.to_bits(), hit.v.to_bits()] {
        h = (h ^ word).wrapping_mul(0x85EB_CA6B);
        h ^= h >> 15;
        h = h.wrapping_mul(0xC2B2_AE35);
        h ^= h >> 13;
    }
    f64::from(h) * (1.0 / 4_294_967_296.0)
}
