//! Polygons into triangle meshes, one a material.

use std::{iter::successors, ops::Range};

use ajar_scene::Mesh;
use glam::Vec3;

use super::{Polygons, ears};

/// No vertex.
const NONE: u32 = u32::MAX;

/// Vertices at one position that a corner is compared with, the latest first. That corners of a fan with more of them are
/// not joined only costs memory.
const COMPARED: usize = 32;

/// What the way to triangles found.
#[derive(Debug, Default)]
pub(crate) struct Triangulated {
    /// One for each material that has faces.
    pub meshes: Vec<Mesh>,
    /// Faces that had less than three corners or no area.
    pub degenerate: usize,
    /// Faces that cross themselves; their triangles may overlap.
    pub crossing: usize,
}

/// The mesh of one part in the making.
struct Builder<'a> {
    polygons: &'a Polygons,
    part: u32,
    mesh: Mesh,
    /// One a position: the part whose vertex was made last there, and that vertex.
    latest: &'a mut [[u32; 2]],
    /// One a vertex: that before it at the same position.
    before: Vec<u32>,
    points: Vec<Vec3>,
    found: Vec<[u32; 3]>,
}

impl Polygons {
    /// Splits all faces. Vertices at the same position with equal attributes are one.
    pub fn triangulated(&self) -> Triangulated {
        let first = self.first();
        let part = |face: u32| self.part_of[face as usize];
        let mut faces: Vec<u32> =
            (0..self.faces.len() as u32).filter(|&face| !self.is_hole[face as usize]).collect();
        faces.sort_by_key(|&face| part(face));
        let mut latest = vec![[NONE; 2]; self.positions.len()];
        let mut done = Triangulated::default();
        for faces in faces.chunk_by(|&a, &b| part(a) == part(b)) {
            let mut builder = Builder::new(self, part(faces[0]), &mut latest);
            for &face in faces {
                let face = face as usize;
                builder.face(first[face] as usize..first[face + 1] as usize, &mut done);
            }
            if !builder.mesh.triangles.is_empty() {
                done.meshes.push(builder.mesh);
            }
        }
        done
    }
}

impl<'a> Builder<'a> {
    fn new(polygons: &'a Polygons, part: u32, latest: &'a mut [[u32; 2]]) -> Self {
        let mesh = Mesh {
            name: polygons.name.clone(),
            material: polygons.materials[part as usize],
            normals: polygons.normals.as_ref().map(|_| Vec::new()),
            uvs: vec![Vec::new(); polygons.uvs.len()],
            colors: polygons.colors.as_ref().map(|_| Vec::new()),
            ..Mesh::default()
        };
        let (before, points, found) = Default::default();
        Self { polygons, part, mesh, latest, before, points, found }
    }

    /// Adds the triangles of the face with these corners.
    fn face(&mut self, corners: Range<usize>, done: &mut Triangulated) {
        let positions = self.polygons.corners[corners.clone()].iter();
        self.points.clear();
        self.points.extend(positions.map(|&position| self.polygons.positions[position as usize]));
        let Some(normal) = ears::vector_area(&self.points).try_normalize() else {
            done.degenerate += 1;
            return;
        };
        let mut found = std::mem::take(&mut self.found);
        done.crossing += usize::from(!ears::triangulate(&self.points, normal, &mut found));
        for triangle in found.drain(..) {
            let triangle = triangle.map(|corner| self.vertex(corners.start + corner as usize));
            self.mesh.triangles.push(triangle);
        }
        self.found = found;
    }

    /// The vertex of a corner, made if there is none yet.
    fn vertex(&mut self, corner: usize) -> u32 {
        let position = self.polygons.corners[corner] as usize;
        let [part, latest] = self.latest[position];
        let latest = if part == self.part { latest } else { NONE };
        let known = |vertex: u32| Some(vertex).filter(|&vertex| vertex != NONE);
        let chain = successors(known(latest), |&vertex| known(self.before[vertex as usize]));
        if let Some(vertex) = chain.take(COMPARED).find(|&vertex| self.is_like(vertex, corner)) {
            return vertex;
        }
        let next = self.before.len() as u32;
        self.before.push(latest);
        self.latest[position] = [self.part, next];
        self.push(corner);
        next
    }

    /// Whether a vertex has the attributes of a corner.
    fn is_like(&self, vertex: u32, corner: usize) -> bool {
        let (Self { polygons, mesh, .. }, vertex) = (self, vertex as usize);
        let normals = mesh.normals.as_ref().zip(polygons.normals.as_ref());
        let colors = mesh.colors.as_ref().zip(polygons.colors.as_ref());
        normals.is_none_or(|(made, given)| made[vertex] == given.at(corner))
            && mesh.uvs.iter().zip(&polygons.uvs).all(|(made, given)| made[vertex] == given.at(corner))
            && colors.is_none_or(|(made, given)| made[vertex] == given.at(corner))
    }

    fn push(&mut self, corner: usize) {
        let Self { polygons, mesh, .. } = self;
        mesh.positions.push(polygons.positions[polygons.corners[corner] as usize]);
        if let (Some(to), Some(from)) = (&mut mesh.normals, &polygons.normals) {
            to.push(from.at(corner));
        }
        for (to, from) in mesh.uvs.iter_mut().zip(&polygons.uvs) {
            to.push(from.at(corner));
        }
        if let (Some(to), Some(from)) = (&mut mesh.colors, &polygons.colors) {
            to.push(from.at(corner));
        }
    }
}

#[cfg(test)]
mod tests {
    use ajar_scene::Id;
    use glam::Vec2;

    use super::super::{Attribute, Per, Polygons};
    use super::*;

    /// Two squares side by side, the second with a material of its own.
    fn two() -> Polygons {
        Polygons {
            positions: [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
                .map(|[x, y]| Vec3::new(x as f32, y as f32, 0.0))
                .to_vec(),
            faces: vec![4, 4],
            corners: vec![0, 1, 4, 3, 1, 2, 5, 4],
            part_of: vec![0, 1],
            is_hole: vec![false; 2],
            materials: vec![None, Some(Id::new(3))],
            ..Polygons::default()
        }
    }

    #[test]
    fn each_material_has_its_mesh() {
        let done = two().triangulated();
        let [first, second] = &done.meshes[..] else { panic!("{:?}", done.meshes.len()) };
        assert_eq!((first.material, second.material), (None, Some(Id::new(3))));
        assert_eq!((first.positions.len(), second.triangles.len()), (4, 2));
    }

    #[test]
    fn vertices_are_joined_where_all_is_the_same() {
        let mut mesh = two();
        mesh.part_of = vec![0, 0];
        assert_eq!(mesh.triangulated().meshes[0].positions.len(), 6);
        mesh.uvs =
            vec![Attribute { values: vec![Vec2::ZERO, Vec2::ONE], indices: vec![0, 0, 0, 0, 1, 1, 1, 1] }];
        assert_eq!(mesh.triangulated().meshes[0].positions.len(), 8);
        mesh.uvs[0].indices = vec![0; 8];
        assert_eq!(mesh.triangulated().meshes[0].positions.len(), 6);
        // Equal values count, not where they are.
        mesh.uvs = vec![Attribute { values: vec![Vec2::ONE; 8], indices: (0..8).collect() }; 3];
        assert_eq!(mesh.triangulated().meshes[0].positions.len(), 6);
        mesh.uvs[2].values[4..].fill(Vec2::ZERO);
        assert_eq!(mesh.triangulated().meshes[0].positions.len(), 8);
    }

    #[test]
    fn parts_share_no_vertices_and_keep_the_order_of_their_faces() {
        let mut mesh = two();
        mesh.part_of = vec![1, 0];
        let done = mesh.triangulated();
        let [first, second] = &done.meshes[..] else { panic!("{:?}", done.meshes.len()) };
        assert_eq!((first.material, second.material), (None, Some(Id::new(3))));
        assert_eq!((first.positions[0].x, second.positions[0].x), (1.0, 0.0));
        assert_eq!((first.positions.len(), second.positions.len()), (4, 4));
    }

    #[test]
    fn a_fan_of_more_vertices_than_are_compared_is_whole() {
        let count = 3 * COMPARED as u32;
        let rim = (0..=count).map(|i| {
            let (y, x) = (i as f32 / count as f32).sin_cos();
            Vec3::new(x, y, 0.0)
        });
        let corners: Vec<_> = (1..=count).flat_map(|i| [0, i, i + 1]).collect();
        let mesh = Polygons {
            positions: std::iter::once(Vec3::ZERO).chain(rim).collect(),
            faces: vec![3; count as usize],
            part_of: vec![0; count as usize],
            is_hole: vec![false; count as usize],
            materials: vec![None],
            uvs: vec![Attribute {
                values: (0..corners.len()).map(|i| Vec2::splat((i / 3) as f32)).collect(),
                indices: (0..corners.len() as u32).collect(),
            }],
            corners,
            ..Polygons::default()
        };
        let made = &mesh.triangulated().meshes[0];
        assert_eq!((made.triangles.len(), made.positions.len()), (count as usize, 3 * count as usize));
    }

    #[test]
    fn holes_and_faces_without_area_are_left_out() {
        let mut mesh = two();
        mesh.is_hole[0] = true;
        mesh.corners[4..].fill(1);
        let done = mesh.triangulated();
        assert_eq!((done.meshes.len(), done.degenerate), (0, 1));
    }

    #[test]
    fn attributes_are_spread_over_corners() {
        let mesh = two();
        let spread = |indices: Option<Vec<u32>>, per, values: usize| {
            mesh.attribute(vec![0.0; values], indices, per).map(|attribute| attribute.indices)
        };
        assert_eq!(spread(None, Per::Face, 2).expect("fits"), [0, 0, 0, 0, 1, 1, 1, 1]);
        assert_eq!(spread(None, Per::Mesh, 1).expect("fits"), [0; 8]);
        assert_eq!(spread(None, Per::Position, 6).expect("fits"), mesh.corners);
        assert_eq!(spread(Some(vec![1, 0]), Per::Face, 2).expect("fits"), [1, 1, 1, 1, 0, 0, 0, 0]);
        assert!(spread(None, Per::Corner, 7).is_err());
        assert!(spread(Some(vec![0, 2]), Per::Face, 2).is_err());
    }
}
