//! No ray leaves a closed mesh.

use ajar_scene::Mesh;
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::{blocked, closed, cube, direction, icosphere, in_cube, lumpy, nearest, placed, rng};
use crate::bvh::Geometry;
use crate::ray::Ray;

/// Rays from inside: at random, and aimed at points on edges, at vertices, and from afar along edges.
fn escapes(geometry: &Geometry, mesh: &Mesh, to_world: DAffine3, rays: u64, core: f64) -> usize {
    let mut rng = rng(rays);
    let mut escaped = 0;
    for i in 0..rays {
        let origin = to_world.transform_point3(in_cube(&mut rng) * core);
        let t = rng.below(mesh.triangles.len()) as u32;
        let [a, b, _] = geometry.vertices(0, t);
        let along = match i % 4 {
            0 => to_world.transform_vector3(direction(&mut rng)),
            1 => a - origin,
            2 => a.lerp(b, rng.f64()) - origin,
            _ => a.midpoint(b) - origin,
        };
        let ray = Ray::new(origin, along.normalize());
        escaped += usize::from(nearest(geometry, &ray).is_none());
        escaped += usize::from(!blocked(geometry, &ray));
    }
    escaped
}

#[test]
fn closed_meshes_let_none_of_ten_million_rays_out() {
    const RAYS: u64 = 10_000_000;
    let skewed = DAffine3::from_mat3_translation(
        DMat3::from_rotation_y(0.7)
            * DMat3::from_diagonal(DVec3::new(1.0, -2.5, 0.3))
            * DMat3::from_rotation_x(0.4),
        DVec3::new(3.0, 20.0, -7.0),
    );
    let maps = [
        DAffine3::IDENTITY,
        DAffine3::from_translation(DVec3::new(1e4, -1e4, 1e4)),
        DAffine3::from_scale(DVec3::splat(1e-4)),
        skewed,
    ];
    let meshes = [
        (icosphere(5), 0.4),
        (lumpy(6), 0.1),
        (cube(), 0.9),
        (closed(2, |p| 1.0 + 20.0 * p.z.abs().powi(30)), 0.4),
    ];
    let part = RAYS / (2 * maps.len() * meshes.len()) as u64;
    let cases = meshes
        .iter()
        .flat_map(|mesh| maps.map(|map| (mesh, map)))
        .flat_map(|case| [(case, false), (case, true)]);
    let cases: Vec<_> = cases.enumerate().collect();
    cases.par_iter().for_each(|(case, (((mesh, core), map), own))| {
        let geometry = placed(mesh.clone(), *map, *own);
        assert_eq!(escapes(&geometry, mesh, *map, part, *core), 0, "case {case}");
    });
}

/// A mesh near the origin of a world that also holds something far: padding follows the boxes, not the scene.
#[test]
fn a_far_ground_opens_no_gap() {
    let mut mesh = icosphere(4);
    let sphere = mesh.clone();
    let first = mesh.positions.len() as u32;
    let far = 1e6f32;
    mesh.positions.extend([
        glam::Vec3::new(-far, -5.0, -far),
        glam::Vec3::new(far, -5.0, -far),
        glam::Vec3::new(0.0, -5.0, far),
    ]);
    mesh.triangles.push([first, first + 1, first + 2]);
    let geometry = super::world(mesh);
    assert_eq!(escapes(&geometry, &sphere, DAffine3::IDENTITY, 200_000, 0.4), 0);
}
