//! The world: a scene prepared for rendering, read-only from then on.

mod cast;
mod differential;
mod emission;
mod emitters;
mod prepare;
mod previous;
mod surface;
#[cfg(test)]
mod tests;

pub use differential::Differential;
pub use prepare::{PrepareOptions, prepare, prepare_after};
pub use previous::Previous;

use std::sync::Arc;

use ajar_scene::{Id, Mesh, Node, Scene};
use glam::{DAffine3, DMat3, DVec3};

use crate::{
    bvh::Geometry,
    camera::Camera,
    light::Lights,
    material::Material,
    path::{Kind, Vertex},
    texture::Textures,
};
use emitters::Surrounding;
use previous::Tangents;

/// A mesh placed by a node.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The mesh.
    pub mesh: Id<Mesh>,
    /// The node.
    pub node: Id<Node>,
    /// Index of its material.
    pub material: u32,
    /// From mesh space to the world.
    pub to_world: DAffine3,
    /// Turns normals into world space, scaled by what keeps the front side in front.
    pub normal_to_world: DMat3,
    /// −1 where `to_world` mirrors, so that counter-clockwise triangles would show their back, else 1.
    pub handedness: f64,
    /// Emitter index of its first triangle, if it emits.
    pub first_emitter: Option<u32>,
}

/// A scene prepared for rendering. Clones share what is large.
#[derive(Clone, Debug)]
pub struct World {
    /// Camera with film.
    pub camera: Camera,
    /// Emitters.
    pub lights: Arc<Lights>,
    /// Length below which an edge carries no light, metres.
    pub shortest_edge: f64,
    /// The scene, its lights with a shape turned into meshes.
    pub scene: Arc<Scene>,
    geometry: Arc<Geometry>,
    instances: Vec<Instance>,
    /// Meshes of the scene from this number on are the shapes of lights.
    solids: usize,
    materials: Vec<Material>,
    textures: Textures,
    /// What the surroundings in `lights` are made of.
    surroundings: Vec<Surrounding>,
    /// For each mesh tangents per triangle corner, where a material needs them and the mesh has none.
    tangents: Vec<Option<Tangents>>,
    has_alpha: bool,
    has_culling: bool,
    has_absorption: bool,
}

impl World {
    /// The same, seen by another camera.
    pub fn seen_by(&self, camera: &ajar_scene::Camera, to_world: &DAffine3, size: [u32; 2]) -> Self {
        let [width, height] = size;
        Self { camera: Camera::new(camera, to_world, width, height), ..self.clone() }
    }

    /// The meshes placed in it.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// Its materials, in the order of `Instance::material`.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Its geometry.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Whether some surfaces let rays through by chance.
    pub fn has_alpha(&self) -> bool {
        self.has_alpha
    }

    /// The vertex at the lens point `p`.
    #[inline]
    pub fn lens_vertex(&self, p: DVec3) -> Vertex {
        Vertex::isolated(Kind::Lens, p, Vertex::NO_EMITTER)
    }

    /// Whether rays leave `source` in one direction only, so that densities are per area.
    pub fn fixed_direction(&self, source: &Vertex) -> bool {
        match source.kind {
            Kind::Lens => self.camera.is_orthographic(),
            _ => source.direction_is_fixed(),
        }
    }
}
