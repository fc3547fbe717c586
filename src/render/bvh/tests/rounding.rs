//! Rays that leave surfaces.

use ajar_scene::Mesh;
use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::{Geometry, blocked, direction, lumpy, placed, rng, soup};
use crate::bvh::{Anchor, offset_origin, segment};
use crate::ray::Ray;
use crate::rng::Rng;

fn normal([a, b, c]: &[DVec3; 3]) -> DVec3 {
    (*b - *a).cross(*c - *a).normalize()
}

fn on_triangle([a, b, c]: &[DVec3; 3], rng: &mut Rng) -> DVec3 {
    let (s, v) = (rng.f64().sqrt(), rng.f64());
    *a * (1.0 - s) + *b * (s * (1.0 - v)) + *c * (s * v)
}

fn maps() -> [DAffine3; 4] {
    let skewed = DMat3::from_rotation_y(0.7) * DMat3::from_diagonal(DVec3::new(1.0, -2.5, 0.3));
    [
        DAffine3::IDENTITY,
        DAffine3::from_translation(DVec3::new(1e4, -3e3, 77.0)),
        DAffine3::from_scale(DVec3::splat(1e-4)),
        DAffine3::from_mat3_translation(skewed, DVec3::new(3.0, 20.0, -7.0)),
    ]
}

/// Directions at random and nearly along the surface.
fn leaving(n: DVec3, rng: &mut Rng) -> DVec3 {
    let w = direction(rng);
    let flat = w - n * n.dot(w) * (1.0 - 10f64.powf(-12.0 * rng.f64()));
    flat.normalize()
}

fn meets_itself(geometry: &Geometry, triangles: usize, rays: usize) -> usize {
    let mut rng = rng(5);
    let mut met = 0;
    for _ in 0..rays {
        let triangle = rng.below(triangles) as u32;
        let vertices = geometry.vertices(0, triangle);
        let n = normal(&vertices);
        let w = leaving(n, &mut rng);
        let p = on_triangle(&vertices, &mut rng);
        let origin = offset_origin(p, n, w, geometry.rounding(0, &vertices));
        met += usize::from(
            geometry.occluded(&Ray::new(origin, w), |hit| hit.instance == 0 && hit.triangle == triangle),
        );
    }
    met
}

#[test]
fn rays_do_not_meet_the_triangle_they_leave() {
    for map in maps() {
        for own in [false, true] {
            for mesh in [lumpy(4), soup(500, 1.0, &mut rng(6))] {
                let triangles = mesh.triangles.len();
                assert_eq!(meets_itself(&placed(mesh, map, own), triangles, 20_000), 0, "{map:?} {own}");
            }
        }
    }
}

/// Two parallel squares, the second `gap` above the first.
fn walls(gap: f32) -> Mesh {
    let square = |z: f32| {
        [Vec3::new(-1.0, -1.0, z), Vec3::new(1.0, -1.0, z), Vec3::new(1.0, 1.0, z), Vec3::new(-1.0, 1.0, z)]
    };
    let positions = square(0.0).into_iter().chain(square(gap)).collect();
    let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    Mesh { positions, triangles, ..Mesh::default() }
}

#[test]
fn offsets_do_not_pass_a_wall_close_by() {
    for map in maps() {
        for own in [false, true] {
            let geometry = placed(walls(1e-4), map, own);
            let mut rng = rng(7);
            for _ in 0..10_000 {
                let triangle = rng.below(2) as u32;
                let vertices = geometry.vertices(0, triangle);
                let up = map.transform_vector3(DVec3::Z).normalize();
                let n = normal(&vertices);
                // Well inside, so that a steep ray cannot slip out at the side.
                let p = on_triangle(&vertices, &mut rng) * 0.5 + map.translation * 0.5;
                let w = direction(&mut rng);
                let w = if w.dot(n) * up.dot(n) < 0.0 { -w } else { w };
                if w.dot(n).abs() < 0.01 {
                    continue;
                }
                let origin = offset_origin(p, n, w, geometry.rounding(0, &vertices));
                assert!(
                    geometry.occluded(&Ray::new(origin, w), |hit| hit.instance == 0 && hit.triangle >= 2)
                );
            }
        }
    }
}

fn anchor(geometry: &Geometry, triangle: u32, rng: &mut Rng) -> Anchor {
    let vertices = geometry.vertices(0, triangle);
    let position = on_triangle(&vertices, rng);
    Anchor { position, normal: normal(&vertices), rounding: geometry.rounding(0, &vertices) }
}

#[test]
fn segments_between_surfaces_meet_neither() {
    for map in maps() {
        for own in [false, true] {
            let mesh = lumpy(4);
            let triangles = mesh.triangles.len();
            let geometry = placed(mesh, map, own);
            let mut rng = rng(8);
            for _ in 0..20_000 {
                let (a, b) = (rng.below(triangles) as u32, rng.below(triangles) as u32);
                if a == b {
                    continue;
                }
                let ray = segment(&anchor(&geometry, a, &mut rng), &anchor(&geometry, b, &mut rng));
                assert!(
                    !geometry
                        .occluded(&ray, |hit| hit.instance == 0 && (hit.triangle == a || hit.triangle == b))
                );
            }
        }
    }
}

#[test]
fn segments_see_what_stands_between() {
    let geometry = placed(walls(1e-4), DAffine3::IDENTITY, false);
    let below = Anchor { position: DVec3::new(0.1, 0.2, 0.0), normal: DVec3::Z, rounding: 1e-6 };
    let above = Anchor { position: DVec3::new(0.1, 0.2, 3e-4), normal: DVec3::ZERO, rounding: 0.0 };
    assert!(blocked(&geometry, &segment(&below, &above)));
    assert!(blocked(&geometry, &segment(&above, &below)));
    let wall = Anchor { position: DVec3::new(-0.3, 0.2, 1e-4), normal: -DVec3::Z, rounding: 1e-6 };
    assert!(!blocked(&geometry, &segment(&below, &wall)));
    assert_eq!(segment(&below, &below).t_max, 0.0);
}
