//! Polygons into triangle meshes, one a material.

use std::ops::Range;

use ajar_scene::Mesh;
use glam::{Vec2, Vec3, Vec4};

use super::{Attribute, Polygons, ears};

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

/// The mesh of one part in the making. Arrays are slices here: this is the loop that large imports spend their time in.
struct Builder<'a> {
    positions: &'a [Vec3],
    corners: &'a [u32],
    normals: Option<Values<'a, Vec3>>,
    uvs: Vec<Values<'a, Vec2>>,
    colors: Option<Values<'a, Vec4>>,
    part: u32,
    /// One a position: the part whose vertex was made last there, and that vertex.
    latest: &'a mut [[u32; 2]],
    /// One a vertex: that before it at the same position.
    before: Vec<u32>,
    /// One a vertex: the first of the corners that it is made of.
    made_of: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    points: Vec<Vec3>,
    found: Vec<[u32; 3]>,
}

/// The values of an attribute.
#[derive(Clone, Copy)]
struct Values<'a, T> {
    values: &'a [T],
    /// As in [`Attribute`].
    indices: Option<&'a [u32]>,
}

impl<'a, T: Copy + PartialEq> Values<'a, T> {
    fn of(attribute: &'a Attribute<'_, T>) -> Self {
        Self { values: &attribute.values, indices: attribute.indices.as_deref() }
    }

    /// The value that a corner has.
    fn at(&self, corner: usize) -> T {
        self.values[self.indices.map_or(corner, |indices| indices[corner] as usize)]
    }

    fn are_equal(&self, a: usize, b: usize) -> bool {
        self.at(a) == self.at(b)
    }

    fn gathered(&self, corners: &[u32]) -> Vec<T> {
        corners.iter().map(|&corner| self.at(corner as usize)).collect()
    }
}

impl Polygons<'_> {
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
            let part = part(faces[0]);
            let mut builder = Builder::new(self, part, &mut latest);
            for &face in faces {
                let face = face as usize;
                builder.face(first[face] as usize..first[face + 1] as usize, &mut done);
            }
            if !builder.triangles.is_empty() {
                let mesh = builder.mesh();
                let (name, material) = (self.name.clone(), self.materials[part as usize]);
                done.meshes.push(Mesh { name, material, ..mesh });
            }
        }
        done
    }
}

impl<'a> Builder<'a> {
    fn new(polygons: &'a Polygons<'_>, part: u32, latest: &'a mut [[u32; 2]]) -> Self {
        let (before, made_of, triangles, points, found) = Default::default();
        Self {
            positions: &polygons.positions,
            corners: &polygons.corners,
            normals: polygons.normals.as_ref().map(Values::of),
            uvs: polygons.uvs.iter().map(Values::of).collect(),
            colors: polygons.colors.as_ref().map(Values::of),
            part,
            latest,
            before,
            made_of,
            triangles,
            points,
            found,
        }
    }

    /// Adds the triangles of the face with these corners.
    fn face(&mut self, corners: Range<usize>, done: &mut Triangulated) {
        let (positions, of_face) = (self.positions, &self.corners[corners.clone()]);
        if let &[a, b, c] = of_face {
            // What large meshes consist of: without a detour through lists.
            if ears::has_area(ears::vector_area(&[a, b, c].map(|position| positions[position as usize]))) {
                let triangle = [0, 1, 2].map(|corner| self.vertex(corners.start + corner));
                self.triangles.push(triangle);
            } else {
                done.degenerate += 1;
            }
            return;
        }
        self.points.clear();
        self.points.extend(of_face.iter().map(|&position| positions[position as usize]));
        let area = ears::vector_area(&self.points);
        if !ears::has_area(area) {
            done.degenerate += 1;
            return;
        }
        let mut found = std::mem::take(&mut self.found);
        done.crossing += usize::from(!ears::triangulate(&self.points, area, &mut found));
        for triangle in found.drain(..) {
            let triangle = triangle.map(|corner| self.vertex(corners.start + corner as usize));
            self.triangles.push(triangle);
        }
        self.found = found;
    }

    /// The vertex of a corner, made if there is none yet.
    fn vertex(&mut self, corner: usize) -> u32 {
        let position = self.corners[corner] as usize;
        let [part, latest] = self.latest[position];
        let latest = if part == self.part { latest } else { NONE };
        let mut vertex = latest;
        for _ in 0..COMPARED {
            if vertex == NONE {
                break;
            }
            if self.are_alike(self.made_of[vertex as usize] as usize, corner) {
                return vertex;
            }
            vertex = self.before[vertex as usize];
        }
        let next = self.before.len() as u32;
        self.before.push(latest);
        self.made_of.push(corner as u32);
        self.latest[position] = [self.part, next];
        next
    }

    /// Whether two corners have the same attributes.
    fn are_alike(&self, a: usize, b: usize) -> bool {
        self.normals.is_none_or(|normals| normals.are_equal(a, b))
            && self.uvs.iter().all(|uvs| uvs.are_equal(a, b))
            && self.colors.is_none_or(|colors| colors.are_equal(a, b))
    }

    /// What was built, without name and material.
    fn mesh(self) -> Mesh {
        let position = |&corner: &u32| self.positions[self.corners[corner as usize] as usize];
        Mesh {
            positions: self.made_of.iter().map(position).collect(),
            normals: self.normals.map(|normals| normals.gathered(&self.made_of)),
            uvs: self.uvs.iter().map(|uvs| uvs.gathered(&self.made_of)).collect(),
            colors: self.colors.map(|colors| colors.gathered(&self.made_of)),
            triangles: self.triangles,
            ..Mesh::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use ajar_scene::Id;

    use super::super::{Attribute, Per, Polygons};
    use super::*;

    /// Two squares side by side, the second with a material of its own.
    fn two() -> Polygons<'static> {
        Polygons {
            positions: [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
                .map(|[x, y]| Vec3::new(x as f32, y as f32, 0.0))
                .to_vec()
                .into(),
            faces: vec![4, 4].into(),
            corners: vec![0, 1, 4, 3, 1, 2, 5, 4].into(),
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
        mesh.uvs = vec![Attribute {
            values: vec![Vec2::ZERO, Vec2::ONE].into(),
            indices: Some(vec![0, 0, 0, 0, 1, 1, 1, 1].into()),
        }];
        assert_eq!(mesh.triangulated().meshes[0].positions.len(), 8);
        mesh.uvs[0].indices = Some(vec![0; 8].into());
        assert_eq!(mesh.triangulated().meshes[0].positions.len(), 6);
        // Equal values count, not where they are.
        mesh.uvs = vec![Attribute { values: vec![Vec2::ONE; 8].into(), indices: None }; 3];
        assert_eq!(mesh.triangulated().meshes[0].positions.len(), 6);
        mesh.uvs[2].values.to_mut()[4..].fill(Vec2::ZERO);
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
            faces: vec![3; count as usize].into(),
            part_of: vec![0; count as usize],
            is_hole: vec![false; count as usize],
            materials: vec![None],
            uvs: vec![Attribute {
                values: (0..corners.len()).map(|i| Vec2::splat((i / 3) as f32)).collect(),
                indices: None,
            }],
            corners: corners.into(),
            ..Polygons::default()
        };
        let made = &mesh.triangulated().meshes[0];
        assert_eq!((made.triangles.len(), made.positions.len()), (count as usize, 3 * count as usize));
    }

    #[test]
    fn holes_and_faces_without_area_are_left_out() {
        let mut mesh = two();
        mesh.is_hole[0] = true;
        mesh.corners.to_mut()[4..].fill(1);
        let done = mesh.triangulated();
        assert_eq!((done.meshes.len(), done.degenerate), (0, 1));
    }

    #[test]
    fn attributes_are_spread_over_corners() {
        let mesh = two();
        let spread = |indices: Option<Vec<u32>>, per, values: usize| {
            mesh.attribute(vec![0.0; values].into(), indices.map(Cow::Owned), per)
                .map(|attribute| attribute.indices.map(Cow::into_owned))
        };
        assert_eq!(spread(None, Per::Face, 2).expect("fits"), Some(vec![0, 0, 0, 0, 1, 1, 1, 1]));
        assert_eq!(spread(None, Per::Mesh, 1).expect("fits"), Some(vec![0; 8]));
        assert_eq!(spread(None, Per::Position, 6).expect("fits"), Some(mesh.corners.to_vec()));
        assert_eq!(spread(Some(vec![1, 0]), Per::Face, 2).expect("fits"), Some(vec![1, 1, 1, 1, 0, 0, 0, 0]));
        assert!(spread(None, Per::Corner, 7).is_err());
        assert!(spread(Some(vec![0, 2]), Per::Face, 2).is_err());
    }
}
