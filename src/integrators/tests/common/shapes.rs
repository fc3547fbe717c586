//! Meshes: quads, boxes, spheres.

use ajar_scene::Mesh;
use glam::{Vec2, Vec3};

/// A parallelogram with corner `o` and edges `a`, `b`; its front is the side of a × b.
pub fn quad(o: Vec3, a: Vec3, b: Vec3) -> Mesh {
    Mesh {
        positions: vec![o, o + a, o + a + b, o + b],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: vec![vec![Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO]],
        ..Mesh::default()
    }
}

/// A [`quad`] with normals, which normal maps need.
pub fn board(o: Vec3, a: Vec3, b: Vec3) -> Mesh {
    Mesh { normals: Some(vec![a.cross(b).normalize(); 4]), ..quad(o, a, b) }
}

/// An axis-aligned box; its front faces outwards, or inwards.
pub fn cuboid(low: Vec3, high: Vec3, inwards: bool) -> Mesh {
    let d = high - low;
    let (x, y, z) = (Vec3::X * d.x, Vec3::Y * d.y, Vec3::Z * d.z);
    let mut mesh = Mesh::default();
    let faces = [
        quad(low, y, x),
        quad(low + z, x, y),
        quad(low, x, z),
        quad(low + y, z, x),
        quad(low, z, y),
        quad(low + x, y, z),
    ];
    for face in faces {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(face.positions);
        let turn = |[a, b, c]: [u32; 3]| if inwards { [a, c, b] } else { [a, b, c] };
        mesh.triangles.extend(face.triangles.into_iter().map(|t| turn(t).map(|i| i + first)));
    }
    mesh
}

/// A sphere, `smooth` with vertex normals.
pub fn sphere(centre: Vec3, radius: f32, segments: u32, smooth: bool) -> Mesh {
    let (around, down) = (2 * segments, segments);
    let mut mesh = Mesh::default();
    let mut normals = Vec::new();
    for j in 0..=down {
        for i in 0..around {
            let polar = std::f32::consts::PI * j as f32 / down as f32;
            let angle = std::f32::consts::TAU * i as f32 / around as f32;
            let n = Vec3::new(polar.sin() * angle.cos(), polar.cos(), polar.sin() * angle.sin());
            mesh.positions.push(centre + n * radius);
            normals.push(n);
        }
    }
    let at = |j: u32, i: u32| j * around + i % around;
    for j in 0..down {
        for i in 0..around {
            if j > 0 {
                mesh.triangles.push([at(j, i), at(j, i + 1), at(j + 1, i)]);
            }
            if j + 1 < down {
                mesh.triangles.push([at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)]);
            }
        }
    }
    mesh.normals = smooth.then_some(normals);
    mesh
}
