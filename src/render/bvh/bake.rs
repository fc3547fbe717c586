//! Triangles of meshes and of their placements, gathered around a centre.

use ajar_scene::Mesh;
use glam::{DAffine3, DVec3, Vec3};

use super::blas::{Blas, Triangles};

/// Points that the centre is estimated from.
const SAMPLES: usize = 4096;

/// The tree of a mesh in its own space.
pub(super) fn own_blas(mesh: &Mesh) -> Blas {
    let step = mesh.positions.len().div_ceil(SAMPLES).max(1);
    let center = median(mesh.positions.iter().step_by(step).map(|p| p.as_dvec3()).collect());
    Blas::build(center, &Part { first: 0, instance: 0, mesh, map: DAffine3::from_translation(-center) })
}

/// A mesh in a place.
struct Part<'a> {
    /// Number of its first triangle.
    first: usize,
    instance: u32,
    mesh: &'a Mesh,
    map: DAffine3,
}

impl Triangles for Part<'_> {
    fn len(&self) -> usize {
        self.mesh.triangles.len()
    }

    /// NaN where the mesh has no vertex.
    #[inline]
    fn get(&self, index: u32) -> [Vec3; 3] {
        self.mesh.triangles[index as usize].map(|index| {
            let position = self.mesh.positions.get(index as usize);
            position.map_or(Vec3::NAN, |p| self.map.transform_point3(p.as_dvec3()).as_vec3())
        })
    }

    fn id(&self, index: u32) -> [u32; 2] {
        [self.instance, index]
    }
}

/// Placements that become triangles in world space.
#[derive(Default)]
pub(super) struct Baked<'a> {
    parts: Vec<Part<'a>>,
    triangles: usize,
}

impl<'a> Baked<'a> {
    /// Adds placement number `instance`; answers with the number of its first triangle.
    pub(super) fn add(&mut self, instance: u32, mesh: Option<&'a Mesh>, to_world: DAffine3) -> u32 {
        let first = self.triangles;
        if let Some(mesh) = mesh {
            self.parts.push(Part { first, instance, mesh, map: to_world });
            self.triangles += mesh.triangles.len();
        }
        first as u32
    }

    pub(super) fn build(mut self) -> Blas {
        let center = self.center();
        for part in &mut self.parts {
            part.map = DAffine3::from_translation(-center) * part.map;
        }
        Blas::build(center, &self)
    }

    /// Where the detail is: the median of the vertices, which a large ground plane or a stray vertex hardly moves.
    fn center(&self) -> DVec3 {
        let vertices: usize = self.parts.iter().map(|part| part.mesh.positions.len()).sum();
        let step = vertices.div_ceil(SAMPLES).max(1);
        let all = self
            .parts
            .iter()
            .flat_map(|part| part.mesh.positions.iter().map(|p| part.map.transform_point3(p.as_dvec3())));
        median(all.step_by(step).collect())
    }

    /// The placement with this triangle, and which of its triangles it is.
    #[inline]
    fn locate(&self, index: u32) -> (&Part<'a>, u32) {
        let after = self.parts.partition_point(|part| part.first <= index as usize);
        let part = &self.parts[after - 1];
        (part, index - part.first as u32)
    }
}

impl Triangles for Baked<'_> {
    fn len(&self) -> usize {
        self.triangles
    }

    #[inline]
    fn get(&self, index: u32) -> [Vec3; 3] {
        let (part, index) = self.locate(index);
        part.get(index)
    }

    fn id(&self, index: u32) -> [u32; 2] {
        let (part, index) = self.locate(index);
        part.id(index)
    }
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
