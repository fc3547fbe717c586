//! Tangents for meshes that bring none: MikkTSpace (Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited"), which
//! is what baked normal maps assume.

use ajar_scene::Mesh;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::math::Frame;

/// Unit tangents at the three corners of each triangle, with the sign that makes `w · (n × t)` the bitangent.
///
/// The tangent points to where u grows, the bitangent to where v falls: up in the image, as glTF and normal maps with
/// green up have it. Corners that share a vertex can differ where texture coordinates are mirrored. A corner whose
/// coordinates give no direction gets some tangent perpendicular to its normal. Triangles of a mesh without normals are flat.
///
/// `None` if the mesh has no such set of texture coordinates, or if its indices dangle.
pub fn generate(mesh: &Mesh, uv_set: usize) -> Option<Vec<[Vec4; 3]>> {
    let normals = mesh.normals.as_deref();
    let uvs = mesh.uvs.get(uv_set)?.as_slice();
    let vertices = mesh.positions.len().min(normals.map_or(usize::MAX, <[Vec3]>::len)).min(uvs.len());
    if mesh.triangles.iter().flatten().any(|&vertex| vertex as usize >= vertices) {
        return None;
    }
    let mut corners = Corners { mesh, normals, uvs, tangents: vec![[Vec4::ZERO; 3]; mesh.triangles.len()] };
    generate_tangents(&mut corners).ok()?;
    let mut tangents = std::mem::take(&mut corners.tangents);
    for (face, tangents) in tangents.iter_mut().enumerate() {
        for (corner, tangent) in tangents.iter_mut().enumerate() {
            *tangent = usable(*tangent, corners.normal_of(face, corner));
        }
    }
    Some(tangents)
}

/// `tangent`, or some other one if it is no direction beside the normal.
fn usable(tangent: Vec4, normal: Vec3) -> Vec4 {
    let t = tangent.truncate();
    let beside = t.cross(normal).length() > 1e-4 * normal.length();
    if beside && t.is_finite() && (t.length() - 1.0).abs() < 1e-2 {
        return tangent;
    }
    let normal = normal.as_dvec3().try_normalize().unwrap_or(DVec3::Z);
    Frame::from_z(normal).x.as_vec3().extend(1.0)
}

/// A mesh as the generator reads it: no shared vertices, v growing upwards.
struct Corners<'a> {
    mesh: &'a Mesh,
    normals: Option<&'a [Vec3]>,
    uvs: &'a [Vec2],
    tangents: Vec<[Vec4; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }

    /// That of the vertex, or of the triangle.
    fn normal_of(&self, face: usize, corner: usize) -> Vec3 {
        if let Some(normals) = self.normals {
            return normals[self.vertex(face, corner)];
        }
        let [a, b, c] =
            self.mesh.triangles[face].map(|vertex| self.mesh.positions[vertex as usize].as_dvec3());
        (b - a).cross(c - a).normalize_or(DVec3::Z).as_vec3()
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vert: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, vert)].to_array()
    }

    fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
        self.normal_of(face, vert).to_array()
    }

    fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
        let uv = self.uvs[self.vertex(face, vert)];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, tangent_space: Option<TangentSpace>, face: usize, vert: usize) {
        // Without a value the zero stays, which `usable` replaces.
        if let Some(space) = tangent_space {
            self.tangents[face][vert] = Vec4::from_array(space.tangent_encoded());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit square in the XY plane, front +Z, with texture coordinates `uv` of its corners (0,0) (1,0) (1,1) (0,1).
    fn square(uv: [[f32; 2]; 4]) -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            normals: Some(vec![Vec3::Z; 4]),
            uvs: vec![vec![], uv.map(Vec2::from).to_vec()],
            ..Mesh::default()
        }
    }

    fn check(mesh: &Mesh, tangent: Vec3, bitangent: Vec3) {
        for t in generate(mesh, 1).unwrap().into_iter().flatten() {
            assert!((t.truncate() - tangent).length() < 1e-6, "{t}");
            assert!((Vec3::Z.cross(t.truncate()) * t.w - bitangent).length() < 1e-6, "{t}");
        }
    }

    #[test]
    fn tangent_is_plus_u_and_bitangent_minus_v() {
        // An upright image: u right, v (from the top left) down. Green up in the map must be +Y in space.
        check(&square([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]), Vec3::X, Vec3::Y);
        // Mirrored left to right.
        check(&square([[1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0]]), -Vec3::X, Vec3::Y);
        // Upside down.
        check(&square([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), Vec3::X, -Vec3::Y);
        // Quarter turn: u grows along +Y, v along +X.
        check(&square([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]), Vec3::Y, -Vec3::X);
    }

    #[test]
    fn mirrored_halves_keep_their_own_sign_at_shared_vertices() {
        let mut mesh = square([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        mesh.positions.extend([Vec3::new(2.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 0.0)]);
        mesh.triangles.extend([[1, 4, 5], [1, 5, 2]]);
        mesh.normals = Some(vec![Vec3::Z; 6]);
        mesh.uvs[1].extend([Vec2::new(0.0, 1.0), Vec2::new(0.0, 0.0)]);
        let tangents = generate(&mesh, 1).unwrap();
        for (triangle, x) in [(0, 1.0), (1, 1.0), (2, -1.0), (3, -1.0)] {
            for t in tangents[triangle] {
                assert!((t - Vec4::new(x, 0.0, 0.0, x)).length() < 1e-6, "{triangle}: {t}");
            }
        }
    }

    #[test]
    fn degenerate_coordinates_still_give_a_frame() {
        for uv in [[[0.5, 0.5]; 4], [[f32::NAN, 0.0]; 4]] {
            for t in generate(&square(uv), 1).unwrap().into_iter().flatten() {
                assert!(t.truncate().cross(Vec3::Z).length() > 0.99 && t.w.abs() == 1.0, "{t}");
            }
        }
    }

    /// Normal maps show on flat triangles too.
    #[test]
    fn meshes_without_normals_are_flat() {
        let upright = square([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        check(&Mesh { normals: None, ..upright }, Vec3::X, Vec3::Y);
    }

    #[test]
    fn missing_attributes_and_dangling_indices_give_none() {
        let mesh = square([[0.0; 2]; 4]);
        assert!(generate(&mesh, 0).is_none() && generate(&mesh, 2).is_none());
        assert!(generate(&Mesh { triangles: vec![[0, 1, 9]], ..mesh }, 1).is_none());
    }
}
