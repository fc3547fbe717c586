//! Placements.

use glam::{DAffine3, DMat3, DVec3};

use super::{Geometry, InstanceGeometry, blocked, direction, icosphere, in_cube, lumpy, nearest, rng};
use crate::ray::Ray;

fn maps() -> Vec<DAffine3> {
    let turn = DMat3::from_rotation_z(0.3) * DMat3::from_rotation_x(1.1);
    let shapes = [
        DMat3::IDENTITY,
        turn * DMat3::from_diagonal(DVec3::new(2.0, 0.1, 0.7)),
        turn * DMat3::from_diagonal(DVec3::new(-1.0, 3.0, 0.5)) * turn,
        DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0)),
    ];
    let places = shapes.iter().enumerate();
    places.map(|(i, m)| DAffine3::from_mat3_translation(*m, DVec3::new(i as f64, -2.0, 1.0))).collect()
}

#[test]
fn placements_under_the_top_level_look_like_baked_ones() {
    let meshes = [&icosphere(3), &lumpy(3)];
    let instances: Vec<_> = maps()
        .iter()
        .flat_map(|&to_world| (0..3).map(move |mesh| InstanceGeometry::solid(mesh, to_world)))
        .collect();
    let own = Geometry::build_baking(&meshes, &instances, 1, None);
    let baked = Geometry::build_baking(&meshes, &instances, usize::MAX, None);
    let ((low, high), (inner_low, inner_high)) = (own.bounds(), baked.bounds());
    assert!(low.cmple(inner_low + 1e-4).all() && high.cmpge(inner_high - 1e-4).all());
    assert!((high - low).length() < 1.5 * (inner_high - inner_low).length());
    let mut rng = rng(3);
    let (mut met, mut different) = (0, 0);
    for _ in 0..20_000 {
        let middle = DVec3::new(1.5, -2.0, 1.0);
        let origin = middle + in_cube(&mut rng) * 6.0;
        let ray = Ray::new(origin, (middle + in_cube(&mut rng) * 2.0 - origin).normalize());
        let (a, b) = (nearest(&own, &ray), nearest(&baked, &ray));
        assert_eq!(blocked(&own, &ray), a.is_some());
        met += usize::from(a.is_some());
        match (a, b) {
            // Which triangle of the flat placement is met is up to rounding.
            (Some(a), Some(b)) if (a.t - b.t).abs() < 1e-4 => {
                let [p, q, r] = own.vertices(a.instance, a.triangle);
                let (u, v) = (f64::from(a.u), f64::from(a.v));
                let point = p * (1.0 - u - v) + q * u + r * v;
                assert!((point - ray.at(a.t)).length() < 1e-6);
            }
            (None, None) => {}
            _ => different += 1,
        }
    }
    assert!(met > 5000 && different <= met / 1000, "{different} of {met}");
}

#[test]
fn many_placements_cost_the_memory_of_one_mesh() {
    let mesh = lumpy(7);
    assert!(mesh.triangles.len() > 100_000);
    let single = Geometry::build(&[&mesh], &[InstanceGeometry::solid(0, DAffine3::IDENTITY)]);
    let mut rng = rng(4);
    let instances: Vec<_> = (0..10_000)
        .map(|_| InstanceGeometry::solid(0, DAffine3::from_translation(in_cube(&mut rng) * 100.0)))
        .collect();
    let many = Geometry::build(&[&mesh], &instances);
    let extra = many.memory() - single.memory();
    assert!(extra < 10_000 * 350, "{} and {extra} bytes", single.memory());
    assert!(single.memory() < 131_072 * 110, "{}", single.memory());
    let hits =
        (0..1000).filter(|_| blocked(&many, &Ray::new(in_cube(&mut rng) * 100.0, direction(&mut rng))));
    assert!(hits.count() > 300);
}
