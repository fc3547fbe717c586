//! Triangle meshes.

use glam::{Vec2, Vec3, Vec4};
use serde::{Deserialize, Serialize};

use crate::{Id, Material};

/// Triangles with per-vertex attributes; every attribute present has one entry a position.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Name from the asset; not necessarily unique.
    pub name: String,
    /// Vertex positions in metres, mesh space.
    pub positions: Vec<Vec3>,
    /// Three positions a triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Unit shading normals; absent: flat.
    pub normals: Option<Vec<Vec3>>,
    /// Unit tangent and the sign of the bitangent `w · (n × t)`; absent: MikkTSpace where a normal map needs it.
    pub tangents: Option<Vec<Vec4>>,
    /// Texture coordinate sets, origin at the top left of the image.
    pub uvs: Vec<Vec<Vec2>>,
    /// Linear RGBA that multiplies base colour and opacity.
    pub colors: Option<Vec<Vec4>>,
    /// Material of the triangles unless the node replaces it; absent: the default material.
    pub material: Option<Id<Material>>,
}
