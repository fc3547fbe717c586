//! The nearest hit is the nearest hit.

use std::cell::Cell;

use ajar_scene::Mesh;
use glam::{DAffine3, DVec3, Vec3};

use super::{Geometry, blocked, direction, icosphere, in_cube, nearest, placed, rng, soup, world};
use crate::bvh::Hit;
use crate::ray::Ray;

/// Distances along the ray to all triangles that it meets clear of their edges, nearest first.
fn brute_force(geometry: &Geometry, triangles: u32, ray: &Ray) -> Vec<(f64, u32)> {
    let mut all = Vec::new();
    for triangle in 0..triangles {
        let [a, b, c] = geometry.vertices(0, triangle);
        let p = ray.direction.cross(c - a);
        let inverse = 1.0 / (b - a).dot(p);
        let q = (ray.origin - a).cross(b - a);
        let (u, v) = ((ray.origin - a).dot(p) * inverse, ray.direction.dot(q) * inverse);
        let t = (c - a).dot(q) * inverse;
        if u > -1e-9 && v > -1e-9 && u + v < 1.0 + 1e-9 && t > 0.0 && t <= ray.t_max {
            all.push((t, triangle));
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

#[test]
fn nearest_hits_are_those_of_brute_force() {
    let mut rng = rng(0);
    for (count, size, own) in
        [(1, 1.0, false), (7, 1.0, false), (600, 0.5, false), (600, 0.5, true), (2000, 0.3, false)]
    {
        let geometry = placed(soup(count, size, &mut rng), DAffine3::IDENTITY, own);
        let (mut met, mut different) = (0, 0);
        for _ in 0..10_000 / 5 {
            let mut ray = Ray::new(in_cube(&mut rng) * 2.0, direction(&mut rng));
            if rng.f64() < 0.3 {
                ray.t_max = rng.f64();
            }
            let truth = brute_force(&geometry, count as u32, &ray);
            let found = nearest(&geometry, &ray);
            assert_eq!(found.is_some(), blocked(&geometry, &ray));
            met += usize::from(found.is_some());
            match (truth.first(), found) {
                (Some(&(t, triangle)), Some(hit)) if triangle == hit.triangle => {
                    assert!((t - hit.t).abs() < 1e-12 * (1.0 + t), "{t} {}", hit.t);
                    let [a, b, c] = geometry.vertices(0, triangle);
                    let (u, v) = (f64::from(hit.u), f64::from(hit.v));
                    let point = a * (1.0 - u - v) + b * u + c * v;
                    assert!((point - ray.at(hit.t)).length() < 1e-6);
                }
                (None, None) => {}
                _ => different += 1,
            }
        }
        assert!(met > 100 || count < 100, "{met} rays met something");
        // A ray within f32 rounding of an edge may go either way.
        assert!(different <= 1, "{different} of {met}");
    }
}

#[test]
fn accept_decides_which_hits_count() {
    let geometry = world(icosphere(3));
    let ray = Ray::new(DVec3::new(0.1, 0.2, -5.0), DVec3::Z);
    let near = nearest(&geometry, &ray).unwrap();
    let far = geometry.intersect(&ray, |hit| hit.triangle != near.triangle).unwrap().hit;
    assert!((near.t - 4.0).abs() < 0.1 && (far.t - 6.0).abs() < 0.1);
    assert!(geometry.occluded(&ray, |hit| hit.triangle == far.triangle));
    assert!(geometry.intersect(&ray, |_| false).is_none() && !geometry.occluded(&ray, |_| false));

    let seen = Cell::new(0);
    let offered = |hit: &Hit| {
        let exact = if hit.triangle == near.triangle { near } else { far };
        assert!(
            (hit.t - exact.t).abs() < 1e-5
                && (hit.u - exact.u).abs() < 1e-3
                && (hit.v - exact.v).abs() < 1e-3
        );
        seen.set(seen.get() + 1);
        false
    };
    geometry.intersect(&ray, offered);
    assert_eq!(seen.get(), 2);

    let until = |t_max: f64| blocked(&geometry, &Ray { t_max, ..ray });
    assert!(!until(near.t - 1e-5) && until(near.t + 1e-5) && !until(0.0) && !until(-1.0) && !until(f64::NAN));
}

#[test]
fn degenerate_triangles_and_rays_meet_nothing() {
    let mut mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::X * 3.0, Vec3::NAN, Vec3::INFINITY, Vec3::splat(f32::MAX)],
        triangles: vec![[0, 0, 0], [0, 1, 1], [0, 1, 2], [0, 1, 3], [1, 0, 4], [0, 1, 77], [0, 1, u32::MAX]],
        ..Mesh::default()
    };
    let empty = [world(Mesh::default()), world(mesh.clone()), Geometry::build(&[], &[])];
    let mut rng = rng(1);
    for geometry in &empty {
        for _ in 0..1000 {
            let target = DVec3::X * rng.f64() * 3.0;
            let origin = in_cube(&mut rng);
            let ray = Ray::new(origin, (target - origin).normalize());
            assert!(nearest(geometry, &ray).is_none());
        }
        assert_eq!(geometry.bounds(), (DVec3::ZERO, DVec3::ZERO));
    }
    mesh.triangles.push([1, 2, 5]);
    mesh.positions.push(Vec3::Y);
    mesh.triangles.push([0, 1, 6]);
    let geometry = world(mesh);
    let down = Ray::new(DVec3::new(0.2, 0.2, 1.0), -DVec3::Z);
    assert_eq!(geometry.intersect(&down, |hit| hit.triangle == 8).unwrap().hit.triangle, 8);
    assert_eq!(geometry.vertices(0, 1), [DVec3::ZERO, DVec3::X, DVec3::X]);
    for bad in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::splat(1e-300), DVec3::splat(1e300)] {
        for ray in [Ray::new(down.origin, bad), Ray::new(bad, -DVec3::Z), Ray::new(bad, bad)] {
            nearest(&geometry, &ray);
            blocked(&geometry, &ray);
        }
    }
}

#[test]
fn copies_without_end_do_not_harm() {
    let mut mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]; 20_000],
        ..Mesh::default()
    };
    // Each of these holds the next, so boxes cannot be told apart by place.
    for k in 0..200 {
        let size = 2f32.powf(-0.5 * k as f32);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([Vec3::ZERO, Vec3::X * size, Vec3::Y * size]);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    let geometry = world(mesh);
    let ray = Ray::new(DVec3::new(0.2, 0.2, 1.0), -DVec3::Z);
    let hit = nearest(&geometry, &ray).unwrap();
    assert_eq!((hit.triangle, hit.t), (0, 1.0));
}

#[test]
fn the_tree_does_not_depend_on_threads() {
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| world(soup(30_000, 0.1, &mut rng(2))))
    };
    let (one, many) = (build(1), build(5));
    assert!(one.baked.has_same_tree(&many.baked));
}

#[test]
fn coordinates_whose_areas_overflow_are_no_failure() {
    let mut mesh = icosphere(3);
    mesh.positions.iter_mut().for_each(|position| *position *= 1e30);
    let geometry = placed(mesh, DAffine3::IDENTITY, false);
    let hit = nearest(&geometry, &Ray::new(DVec3::Z * 3e30, DVec3::NEG_Z)).unwrap();
    assert!((hit.t / 1e30 - 2.0).abs() < 0.01);
}
