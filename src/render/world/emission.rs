//! Emitted radiance.

use glam::DVec3;

use super::World;
use crate::{
    math::Rgb,
    path::{Kind, Vertex},
};

impl World {
    /// What the light end `x0` sends in `direction`: radiance for surfaces and surroundings (cd/m²), intensity (cd) for
    /// lights with a position, illuminance (lux) for directional ones.
    #[inline]
    pub fn emitted(&self, x0: &Vertex, direction: DVec3) -> Rgb {
        if x0.kind != Kind::Surface {
            return self.lights.distant_emission(x0, direction);
        }
        if x0.emitter == Vertex::NO_EMITTER {
            return Rgb::ZERO;
        }
        let instance = &self.instances[x0.site.instance as usize];
        let material = &self.materials[instance.material as usize];
        if x0.ng.dot(direction) <= 0.0 && !material.emits_both_sides() {
            return Rgb::ZERO;
        }
        material.emission(&self.textures, &self.point(instance, x0.site.triangle, x0.site.uv))
    }
}
