//! Triangles of meshes and of their placements, gathered around a centre.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

use super::MeshGeometry;
use super::blas::Blas;

/// Points that the centre is estimated from.
const SAMPLES: usize = 4096;

/// The tree of a mesh in its own space.
pub(super) fn own_blas(mesh: &MeshGeometry) -> Blas {
    let step = mesh.positions.len().div_ceil(SAMPLES).max(1);
    let center = median(mesh.positions.iter().step_by(step).map(|p| p.as_dvec3()).collect());
    let triangles: Vec<_> =
        mesh.triangles.par_iter().map(|t| place(mesh, t, &DAffine3::from_translation(-center))).collect();
    let ids: Vec<_> = (0..triangles.len() as u32).map(|i| [0, i]).collect();
    Blas::build(center, &triangles, &ids)
}

/// Placements that become triangles in world space.
#[derive(Default)]
pub(super) struct Baked<'a> {
    parts: Vec<(u32, &'a MeshGeometry, DAffine3)>,
    triangles: usize,
}

impl<'a> Baked<'a> {
    /// Adds placement number `instance`; answers with the number of its first triangle.
    pub(super) fn add(
        &mut self,
        instance: u32,
        mesh: Option<&'a Arc<MeshGeometry>>,
        to_world: DAffine3,
    ) -> u32 {
        let first = self.triangles;
        if let Some(mesh) = mesh {
            self.parts.push((instance, mesh, to_world));
            self.triangles += mesh.triangles.len();
        }
        first as u32
    }

    pub(super) fn build(self) -> Blas {
        let center = self.center();
        let triangles: Vec<_> = self
            .parts
            .par_iter()
            .flat_map(|&(_, mesh, to_world)| {
                let map = DAffine3::from_translation(-center) * to_world;
                mesh.triangles.par_iter().map(move |t| place(mesh, t, &map))
            })
            .collect();
        let ids: Vec<_> = self
            .parts
            .par_iter()
            .flat_map(|&(instance, mesh, _)| {
                (0..mesh.triangles.len() as u32).into_par_iter().map(move |i| [instance, i])
            })
            .collect();
        Blas::build(center, &triangles, &ids)
    }

    /// Where the detail is: the median of the vertices, which a large ground plane or a stray vertex hardly moves.
    fn center(&self) -> DVec3 {
        let vertices: usize = self.parts.iter().map(|(_, mesh, _)| mesh.positions.len()).sum();
        let step = vertices.div_ceil(SAMPLES).max(1);
        let all = self.parts.iter().flat_map(|(_, mesh, to_world)| {
            mesh.positions.iter().map(move |p| to_world.transform_point3(p.as_dvec3()))
        });
        median(all.step_by(step).collect())
    }
}

/// The vertices of a triangle under `map`; NaN where the mesh has none.
fn place(mesh: &MeshGeometry, triangle: &[u32; 3], map: &DAffine3) -> [Vec3; 3] {
    triangle.map(|index| {
        mesh.positions.get(index as usize).map_or(Vec3::NAN, |p| map.transform_point3(p.as_dvec3()).as_vec3())
    })
}

/// The median per axis, of finite points.
fn median(mut points: Vec<DVec3>) -> DVec3 {
    points.retain(|p| p.is_finite());
    if points.is_empty() {
        return DVec3::ZERO;
    }
    let middle = points.len() / 2;
    let mut axis = |k: usize| {
        points.select_nth_unstable_by(middle, |a, b| a[k].total_cmp(&b[k]));
        points[middle][k]
    };
    DVec3::new(axis(0), axis(1), axis(2))
}
