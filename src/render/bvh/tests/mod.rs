//! Tests of ray casting, and the shapes they use.

mod hits;
mod instances;
mod lanes;
mod rounding;
mod watertight;

use ajar_scene::Mesh;
use glam::{DAffine3, DVec3, Vec3};

use super::{Geometry, Hit, InstanceGeometry};
use crate::ray::Ray;
use crate::rng::{Purpose, Rng};

fn rng(index: u64) -> Rng {
    Rng::new(1, Purpose::Test, 0, index)
}

/// Uniform on the unit sphere.
fn direction(rng: &mut Rng) -> DVec3 {
    let z = 2.0 * rng.f64() - 1.0;
    let (sin, cos) = (std::f64::consts::TAU * rng.f64()).sin_cos();
    DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
}

fn in_cube(rng: &mut Rng) -> DVec3 {
    DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 2.0 - 1.0
}

/// The nearest hit, which must be the same with and without a choice of hits.
fn nearest(geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    let met = geometry.nearest(ray);
    assert_eq!(met, geometry.intersect(ray, |_| true));
    met.map(|met| {
        assert_eq!(met.vertices, geometry.vertices(met.hit.instance, met.hit.triangle));
        met.hit
    })
}

/// Whether there is a hit, which must be the same with and without a choice of hits.
fn blocked(geometry: &Geometry, ray: &Ray) -> bool {
    let found = geometry.blocked(ray);
    assert_eq!(found, geometry.occluded(ray, |_| true));
    found
}

/// A closed mesh around the origin: an octahedron whose faces are split `levels` times and pushed to `radius`.
fn closed(levels: u32, radius: impl Fn(DVec3) -> f64) -> Mesh {
    let mut points: Vec<DVec3> = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|a| [a, -a]).collect();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for (x, y, z) in (0..8).map(|i| (i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2))) {
        triangles.push([x, y, z]);
    }
    let mut middles = std::collections::HashMap::new();
    for _ in 0..levels {
        let mut finer = Vec::with_capacity(triangles.len() * 4);
        for t in triangles {
            let m: [u32; 3] = std::array::from_fn(|k| {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    points.push((points[a as usize] + points[b as usize]).normalize());
                    points.len() as u32 - 1
                })
            });
            finer.extend([[t[0], m[0], m[2]], [m[0], t[1], m[1]], [m[2], m[1], t[2]], m]);
        }
        triangles = finer;
    }
    let positions = points.iter().map(|p| (*p * radius(*p)).as_vec3()).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

fn icosphere(levels: u32) -> Mesh {
    closed(levels, |_| 1.0)
}

/// A closed mesh with slivers and folds that the origin still sees entirely.
fn lumpy(levels: u32) -> Mesh {
    closed(levels, |p| {
        1.0 + 0.3 * (9.0 * p.x).sin() * (7.0 * p.y).cos() + 0.2 * (31.0 * p.z + 3.0 * p.x).sin()
    })
}

fn cube() -> Mesh {
    let positions =
        (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0);
    let quads = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    Mesh { positions: positions.collect(), triangles, ..Mesh::default() }
}

/// Random triangles of many sizes in the unit cube.
fn soup(count: usize, size: f64, rng: &mut Rng) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count as u32 {
        let center = in_cube(rng);
        let size = size * rng.f64().powi(3);
        mesh.positions.extend((0..3).map(|_| (center + in_cube(rng) * size).as_vec3()));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

/// One mesh, placed once; with `own`, as a placement under the top level.
fn placed(mesh: Mesh, to_world: DAffine3, own: bool) -> Geometry {
    let mut instances = vec![InstanceGeometry::solid(0, to_world)];
    if own {
        // A second placement, out of the way, so that the mesh counts as placed many times.
        let size = to_world.transform_vector3(DVec3::ONE).length().max(to_world.translation.length());
        let away = DAffine3::from_translation(DVec3::splat(100.0 * size)) * to_world;
        instances.push(InstanceGeometry::solid(0, away));
    }
    Geometry::build_baking(&[&mesh], &instances, if own { 1 } else { usize::MAX }, None)
}

fn world(mesh: Mesh) -> Geometry {
    placed(mesh, DAffine3::IDENTITY, false)
}
