//! Measures how many incoherent rays a second one thread casts in a furnished room, and writes room, rays and hits to a
//! file, so that another ray caster can be measured on the same (`tools/bench/rays.py`).
//!
//! Usage: `rays FILE`. The file holds, little-endian: numbers of triangles and rays as u64, then as f32 nine coordinates
//! per triangle, origins, directions, distances of the hits (infinity for none).

use std::error::Error;
use std::f64::consts::TAU;
use std::io::{BufWriter, Write};
use std::time::Instant;

use ajar_render::bvh::{Geometry, InstanceGeometry, Met, offset_origin};
use ajar_render::math::Frame;
use ajar_render::ray::Ray;
use ajar_render::rng::{Purpose, Rng};
use ajar_scene::Mesh;
use glam::{DAffine3, DVec3, Vec3};

const RAYS: usize = 400_000;
/// Rays timed together. Of several passes each batch's fastest counts, so that other work on the machine does not.
const BATCH: usize = 500;
const PASSES: usize = 8;
const SIZE: DVec3 = DVec3::new(8.0, 6.0, 3.0);

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("usage: rays FILE")?;
    let mesh = room();
    let started = Instant::now();
    let geometry = Geometry::build(&[&mesh], &[InstanceGeometry::solid(0, DAffine3::IDENTITY)]);
    let mut out = std::io::stdout();
    writeln!(out, "triangles {} built in {:.2?}", mesh.triangles.len(), started.elapsed())?;
    writeln!(out, "bytes per triangle {:.1}", geometry.memory() as f64 / mesh.triangles.len() as f64)?;
    let rays = rays(&geometry);

    let mut distances = vec![f64::INFINITY; rays.len()];
    let (mut nearest, mut shadow) = (Fastest::default(), Fastest::default());
    for _ in 0..PASSES {
        for (batch, (rays, distances)) in rays.chunks(BATCH).zip(distances.chunks_mut(BATCH)).enumerate() {
            nearest.time(batch, || {
                for (ray, distance) in rays.iter().zip(distances) {
                    *distance = geometry.nearest(ray).map_or(f64::INFINITY, |met| met.hit.t);
                }
            });
            shadow.time(batch, || {
                let is_blocked = |ray: &&Ray| geometry.blocked(&Ray { t_max: 2.0, ..**ray });
                std::hint::black_box(rays.iter().filter(is_blocked).count());
            });
        }
    }
    write(&file, &geometry, mesh.triangles.len(), &rays, &distances)?;
    writeln!(out, "Mrays/s nearest {:.3} shadow {:.3}", nearest.rate(rays.len()), shadow.rate(rays.len()))?;
    Ok(())
}

/// The fastest time of each batch in seconds.
#[derive(Default)]
struct Fastest(Vec<f64>);

impl Fastest {
    fn time(&mut self, batch: usize, work: impl FnOnce()) {
        let start = Instant::now();
        work();
        self.0.resize(self.0.len().max(batch + 1), f64::INFINITY);
        self.0[batch] = self.0[batch].min(start.elapsed().as_secs_f64());
    }

    /// Millions a second.
    fn rate(&self, count: usize) -> f64 {
        count as f64 / self.0.iter().sum::<f64>() / 1e6
    }
}

/// Rays as diffuse paths make them: from where others ended, around the normal. Rounded to f32 for the file's sake.
fn rays(geometry: &Geometry) -> Vec<Ray> {
    let mut rng = Rng::new(1, Purpose::Test, 0, 0);
    let mut rays = Vec::with_capacity(RAYS);
    let mut ray = Ray::new(SIZE * 0.5, DVec3::X);
    while rays.len() < RAYS {
        let start = SIZE * 0.98 * DVec3::new(rng.f64(), rng.f64(), rng.f64()) + 0.01 * SIZE;
        let Some(Met { hit, vertices }) = geometry.nearest(&ray).filter(|_| rng.f64() < 0.8) else {
            ray = Ray::new(start, around(DVec3::Z, &mut rng));
            continue;
        };
        let [a, b, c] = vertices;
        let n = (b - a).cross(c - a).normalize();
        let n = if n.dot(ray.direction) > 0.0 { -n } else { n };
        let w = around(n, &mut rng);
        let origin = offset_origin(ray.at(hit.t), n, w, 4.0 * geometry.rounding(hit.instance, &vertices));
        ray = Ray::new(origin.as_vec3().as_dvec3(), w.as_vec3().as_dvec3());
        rays.push(ray);
    }
    rays
}

/// A direction by the cosine to `n`.
fn around(n: DVec3, rng: &mut Rng) -> DVec3 {
    let (r, phi) = (rng.f64(), TAU * rng.f64());
    let local = DVec3::new(r.sqrt() * phi.cos(), r.sqrt() * phi.sin(), (1.0 - r).sqrt());
    Frame::from_z(n).to_world(local)
}

fn write(
    file: &str,
    geometry: &Geometry,
    triangles: usize,
    rays: &[Ray],
    distances: &[f64],
) -> std::io::Result<()> {
    let mut out = BufWriter::new(std::fs::File::create(file)?);
    out.write_all(&(triangles as u64).to_le_bytes())?;
    out.write_all(&(rays.len() as u64).to_le_bytes())?;
    let corners = (0..triangles as u32).flat_map(|i| geometry.vertices(0, i));
    let vectors = corners.chain(rays.iter().map(|r| r.origin)).chain(rays.iter().map(|r| r.direction));
    for x in vectors.flat_map(|v| v.to_array()).chain(distances.iter().copied()) {
        out.write_all(&(x as f32).to_le_bytes())?;
    }
    out.flush()
}

/// Four walls, and furniture from boxes, turned parts, cloth and leaves.
fn room() -> Mesh {
    let mut mesh = Mesh::default();
    let mut rng = Rng::new(2, Purpose::Test, 0, 0);
    cuboid(&mut mesh, DVec3::ZERO, SIZE);
    for i in 0..4 {
        let at = DVec3::new(1.0 + 1.2 * f64::from(i), if i % 2 == 0 { 1.5 } else { 4.0 }, 0.0);
        table(&mut mesh, at, &mut rng);
    }
    for i in 0..3 {
        shelf(&mut mesh, DVec3::new(0.3 + 2.5 * f64::from(i), 5.65, 0.0), &mut rng);
    }
    for i in 0..4 {
        plant(&mut mesh, DVec3::new(0.5 + 2.2 * f64::from(i), 0.5, 0.0), &mut rng);
    }
    let fold = |u: f64, v: f64| {
        DVec3::new(0.15 + 0.07 * (60.0 * u).sin() * (1.0 - 0.5 * v), 5.0 * u + 0.5, 0.2 + 2.6 * v)
    };
    grid(&mut mesh, 260, 90, fold);
    let carpet = |u: f64, v: f64| {
        let rough = 0.01 * ((200.0 * u).sin() * (170.0 * v).cos()).abs();
        DVec3::new(2.0 + 4.0 * u, 1.5 + 3.0 * v, 0.01 + rough)
    };
    grid(&mut mesh, 250, 190, carpet);
    mesh
}

fn grid(mesh: &mut Mesh, columns: u32, rows: u32, point: impl Fn(f64, f64) -> DVec3) {
    let first = mesh.positions.len() as u32;
    for j in 0..=rows {
        for i in 0..=columns {
            let p = point(f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
            mesh.positions.push(p.as_vec3());
        }
    }
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let a = first + j * (columns + 1) + i;
        let b = a + columns + 1;
        mesh.triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
    }
}

fn cuboid(mesh: &mut Mesh, low: DVec3, size: DVec3) {
    let first = mesh.positions.len() as u32;
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    mesh.positions.extend((0..8).map(|i| (low + size * corner(i)).as_vec3()));
    for q in [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]] {
        let [a, b, c, d] = q.map(|i: u32| first + i);
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

/// A turned part around the vertical through `at`.
fn turned(mesh: &mut Mesh, at: DVec3, height: f64, detail: u32, radius: impl Fn(f64) -> f64) {
    grid(mesh, detail, detail, |u, v| {
        let (sin, cos) = (TAU * u).sin_cos();
        at + DVec3::new(radius(v) * cos, radius(v) * sin, height * v)
    });
}

fn table(mesh: &mut Mesh, at: DVec3, rng: &mut Rng) {
    cuboid(mesh, at + DVec3::new(-0.5, -0.35, 0.7), DVec3::new(1.0, 0.7, 0.04));
    for (x, y) in [(-0.45, -0.3), (0.45, -0.3), (-0.45, 0.3), (0.45, 0.3)] {
        turned(mesh, at + DVec3::new(x, y, 0.0), 0.7, 32, |v| 0.03 + 0.012 * (20.0 * v).sin());
    }
    for _ in 0..5 {
        let place = at + DVec3::new(0.7 * rng.f64() - 0.35, 0.4 * rng.f64() - 0.2, 0.745);
        let width = 0.04 + 0.04 * rng.f64();
        turned(mesh, place, 0.1 + 0.2 * rng.f64(), 48, |v| width * (0.3 + (3.0 * v).sin().abs()));
    }
}

fn shelf(mesh: &mut Mesh, at: DVec3, rng: &mut Rng) {
    for i in 0..6 {
        cuboid(mesh, at + DVec3::Z * (0.4 * f64::from(i)), DVec3::new(2.0, 0.3, 0.025));
        let mut x = 0.02;
        while x < 1.9 && i < 5 {
            let size = DVec3::new(0.01 + 0.03 * rng.f64(), 0.15 + 0.1 * rng.f64(), 0.2 + 0.15 * rng.f64());
            cuboid(mesh, at + DVec3::new(x, 0.02, 0.4 * f64::from(i) + 0.026), size);
            x += size.x + 0.002;
        }
    }
}

fn plant(mesh: &mut Mesh, at: DVec3, rng: &mut Rng) {
    turned(mesh, at, 0.3, 48, |v| 0.12 + 0.05 * v);
    for _ in 0..1500 {
        let stem = around(DVec3::Z, rng) * (0.3 + 0.5 * rng.f64()) + at + DVec3::Z * 0.3;
        let frame = Frame::from_z(around(DVec3::Z, rng));
        grid(mesh, 3, 5, |u, v| {
            let wide = 0.03 * (v * (1.0 - v)).sqrt() * (2.0 * u - 1.0);
            stem + frame.x * (0.1 * v) + frame.y * wide + frame.z * (0.02 * (v * v + u))
        });
    }
    mesh.positions.iter_mut().for_each(|p| *p = p.max(Vec3::splat(0.0)));
}
