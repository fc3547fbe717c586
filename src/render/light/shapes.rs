//! Lights with a shape become meshes that shine: then there is one kind of area light.

use std::f64::consts::{PI, TAU};

use ajar_scene::{LightKind, Mesh};
use glam::{Vec2, Vec3};

/// Segments around discs, spheres and cylinders.
const AROUND: u32 = 64;
/// Segments of a sphere from pole to pole.
const DOWN: u32 = 32;

/// The mesh of a light with a shape, in the space of its node, front side shining; `None` for other kinds. Round shapes
/// are inscribed polygons, enlarged to the area of the true shape so that they send the same power.
pub(crate) fn tessellate(kind: &LightKind) -> Option<Mesh> {
    match *kind {
        LightKind::Rect { width, height, .. } => Some(rectangle(width, height)),
        LightKind::Disk { radius, .. } => Some(disc(radius)),
        LightKind::Sphere { radius, .. } => Some(sphere(radius)),
        LightKind::Cylinder { radius, length, .. } => Some(cylinder(radius, length)),
        LightKind::Point { .. }
        | LightKind::Spot { .. }
        | LightKind::Directional { .. }
        | LightKind::Environment { .. } => None,
    }
}

fn rectangle(width: f32, height: f32) -> Mesh {
    let corner = |u: f32, v: f32| Vec3::new((u - 0.5) * width, (0.5 - v) * height, 0.0);
    Mesh {
        positions: vec![corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0)],
        // Seen from −Z, where the light goes, these turn counter-clockwise.
        triangles: vec![[0, 2, 1], [0, 3, 2]],
        // Seen from where it shines, +X is on the left (UsdLux RectLight).
        uvs: vec![vec![Vec2::X, Vec2::ONE, Vec2::Y, Vec2::ZERO]],
        ..Mesh::default()
    }
}

fn disc(radius: f32) -> Mesh {
    let polygon = f64::from(AROUND) / 2.0 * (TAU / f64::from(AROUND)).sin();
    let r = f64::from(radius) * (PI / polygon).sqrt();
    let rim = (0..AROUND).map(|i| {
        let angle = TAU * f64::from(i) / f64::from(AROUND);
        Vec3::new((r * angle.cos()) as f32, (r * angle.sin()) as f32, 0.0)
    });
    Mesh {
        positions: std::iter::once(Vec3::ZERO).chain(rim).collect(),
        triangles: (0..AROUND).map(|i| [0, 1 + (i + 1) % AROUND, 1 + i]).collect(),
        ..Mesh::default()
    }
}

fn sphere(radius: f32) -> Mesh {
    let ring = |j: u32| {
        let polar = PI * f64::from(j) / f64::from(DOWN);
        (0..AROUND).map(move |i| {
            let angle = TAU * f64::from(i) / f64::from(AROUND);
            let (x, z) = (polar.sin() * angle.cos(), polar.sin() * angle.sin());
            Vec3::new(x as f32, polar.cos() as f32, z as f32)
        })
    };
    let mut positions = vec![Vec3::Y];
    positions.extend((1..DOWN).flat_map(ring));
    positions.push(Vec3::NEG_Y);
    let last = positions.len() as u32 - 1;
    let at = |j: u32, i: u32| 1 + (j - 1) * AROUND + i % AROUND;
    let mut triangles = Vec::new();
    for i in 0..AROUND {
        triangles.push([0, at(1, i + 1), at(1, i)]);
        triangles.push([last, at(DOWN - 1, i), at(DOWN - 1, i + 1)]);
        for j in 1..DOWN - 1 {
            triangles.push([at(j, i), at(j, i + 1), at(j + 1, i + 1)]);
            triangles.push([at(j, i), at(j + 1, i + 1), at(j + 1, i)]);
        }
    }
    scaled_to_area(Mesh { positions, triangles, ..Mesh::default() }, radius, 4.0 * PI, Vec3::ONE)
}

fn cylinder(radius: f32, length: f32) -> Mesh {
    let mut positions = Vec::new();
    for x in [-0.5, 0.5] {
        for i in 0..AROUND {
            let angle = TAU * f64::from(i) / f64::from(AROUND);
            positions.push(Vec3::new(x * length, angle.cos() as f32, angle.sin() as f32));
        }
    }
    let mut triangles = Vec::new();
    for i in 0..AROUND {
        let (a, b) = (i, (i + 1) % AROUND);
        triangles.push([a, b + AROUND, a + AROUND]);
        triangles.push([a, b, b + AROUND]);
    }
    let round = Vec3::new(0.0, 1.0, 1.0);
    scaled_to_area(Mesh { positions, triangles, ..Mesh::default() }, radius, TAU * f64::from(length), round)
}

/// Scales a shape of unit radius along the axes `round` to `radius`, such that at radius 1 its area would be `area`.
fn scaled_to_area(mut mesh: Mesh, radius: f32, area: f64, round: Vec3) -> Mesh {
    let found: f64 = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
            (b - a).cross(c - a).length() / 2.0
        })
        .sum();
    let ratio = area / found.max(f64::MIN_POSITIVE);
    // A sphere's area grows with the square of its radius, a tube's linearly.
    let factor = radius * if round == Vec3::ONE { ratio.sqrt() } else { ratio } as f32;
    for p in &mut mesh.positions {
        *p *= Vec3::select(round.cmpgt(Vec3::ZERO), Vec3::splat(factor), Vec3::ONE);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(mesh: &Mesh) -> impl Iterator<Item = [glam::DVec3; 3]> + '_ {
        mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize].as_dvec3()))
    }

    #[test]
    fn areas_are_those_of_the_true_shapes() {
        let radiance = 1.0;
        for (kind, area) in [
            (LightKind::Rect { radiance, width: 2.0, height: 3.0, texture: None }, 6.0),
            (LightKind::Disk { radiance, radius: 0.5 }, PI * 0.25),
            (LightKind::Sphere { radiance, radius: 0.5 }, PI),
            (LightKind::Cylinder { radiance, radius: 0.5, length: 3.0 }, PI * 3.0),
        ] {
            let mesh = tessellate(&kind).expect("has a shape");
            let found: f64 = triangles(&mesh).map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum();
            assert!((found / area - 1.0).abs() < 1e-5, "{kind:?}: {found}");
        }
    }

    #[test]
    fn flat_shapes_shine_down_z_and_round_ones_outwards() {
        let radiance = 1.0;
        for kind in [
            LightKind::Rect { radiance, width: 2.0, height: 3.0, texture: None },
            LightKind::Disk { radiance, radius: 0.5 },
        ] {
            let mesh = tessellate(&kind).expect("has a shape");
            assert!(triangles(&mesh).all(|[a, b, c]| (b - a).cross(c - a).z < 0.0));
        }
        for (kind, axis) in [
            (LightKind::Sphere { radiance, radius: 0.5 }, glam::DVec3::ONE),
            (LightKind::Cylinder { radiance, radius: 0.5, length: 3.0 }, glam::DVec3::new(0.0, 1.0, 1.0)),
        ] {
            let mesh = tessellate(&kind).expect("has a shape");
            let outwards = |[a, b, c]: [glam::DVec3; 3]| (b - a).cross(c - a).dot((a + b + c) * axis) > 0.0;
            assert!(triangles(&mesh).all(outwards), "{kind:?}");
        }
    }
}
