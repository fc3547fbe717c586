//! Rays that leave surfaces.

use ajar_scene::Mesh;
use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::{Geometry, blocked, direction, lumpy, placed, rng, soup};
use crate::bvh::{Anchor, inside, offset_origin, segment};
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

/// How many rays into a closed mesh from close to the edges of its triangles leave it; all of them see its `center`.
fn escapes_from_edges(geometry: &Geometry, triangles: usize, center: DVec3, kept_inside: bool) -> usize {
    let mut rng = rng(9);
    let mut escaped = 0;
    for _ in 0..20_000 {
        let vertices = geometry.vertices(0, rng.below(triangles) as u32);
        let rounding = geometry.rounding(0, &vertices);
        let near = 10f64.powf(-4.0 - 12.0 * rng.f64());
        let along = (1.0 - near) * rng.f64();
        let weights = [near, along, 1.0 - near - along];
        let turn = rng.below(3);
        let uv = [weights[turn], weights[(turn + 1) % 3]];
        let [u, v] = if kept_inside { inside(&vertices, uv, rounding) } else { uv };
        let p = vertices[0] * (1.0 - u - v) + vertices[1] * u + vertices[2] * v;
        let n = normal(&vertices);
        let n = if n.dot(center - p) < 0.0 { -n } else { n };
        let w = direction(&mut rng);
        let w = if w.dot(n) < 0.0 { -w } else { w };
        let ray = Ray::new(offset_origin(p, n, w, rounding), w);
        escaped += usize::from(!blocked(geometry, &ray));
    }
    escaped
}

fn cube() -> Mesh {
    let positions = (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32)).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

#[test]
fn rays_from_edges_stay_in_a_closed_mesh() {
    let mut without = 0;
    // Flattened, the edges of lumps are sharper than is promised.
    let lumps = maps().into_iter().take(3).map(|map| (lumpy(4), DVec3::ZERO, map));
    for (mesh, center, map) in maps().map(|map| (cube(), DVec3::splat(0.5), map)).into_iter().chain(lumps) {
        let (triangles, center) = (mesh.triangles.len(), map.transform_point3(center));
        for own in [false, true] {
            let geometry = placed(mesh.clone(), map, own);
            assert_eq!(escapes_from_edges(&geometry, triangles, center, true), 0, "{map:?} {own}");
            without += escapes_from_edges(&geometry, triangles, center, false);
        }
    }
    assert!(without > 100, "this test finds what escapes: {without}");
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
