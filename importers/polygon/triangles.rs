//! Polygons into triangle meshes, one a material.

use std::collections::HashMap;

use ajar_scene::Mesh;
use glam::Vec3;

use super::{Polygons, ears};

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

/// A mesh in the making.
struct Builder<'a> {
    polygons: &'a Polygons,
    mesh: Mesh,
    /// Vertices by what they are made of.
    vertices: HashMap<[u32; 5], u32>,
    /// Vertices by position, where all attributes follow the positions.
    by_position: Option<Vec<u32>>,
}

impl Polygons {
    /// Splits all faces. Vertices with the same position and attributes are one.
    pub fn triangulated(&self) -> Triangulated {
        let mut done = Triangulated::default();
        let mut builders: Vec<_> = self
            .materials
            .iter()
            .map(|&material| {
                let mut builder = Builder::new(self);
                builder.mesh.material = material;
                builder
            })
            .collect();
        let (mut points, mut found): (Vec<Vec3>, Vec<[u32; 3]>) = Default::default();
        let mut end = 0;
        for (face, &count) in self.faces.iter().enumerate() {
            let start = end;
            end += count as usize;
            if self.is_hole[face] {
                continue;
            }
            points.clear();
            points.extend(self.corners[start..end].iter().map(|&position| self.positions[position as usize]));
            let Some(normal) = ears::vector_area(&points).try_normalize() else {
                done.degenerate += 1;
                continue;
            };
            found.clear();
            done.crossing += usize::from(!ears::triangulate(&points, normal, &mut found));
            let builder = &mut builders[self.part_of[face] as usize];
            for triangle in &found {
                let triangle = triangle.map(|corner| builder.vertex(start + corner as usize));
                builder.mesh.triangles.push(triangle);
            }
        }
        done.meshes =
            builders.into_iter().map(|b| b.mesh).filter(|mesh| !mesh.triangles.is_empty()).collect();
        done
    }

    /// Whether every attribute has the same vertices as the positions.
    fn follows_positions(&self) -> bool {
        self.normals.iter().all(|it| it.indices == self.corners)
            && self.uvs.iter().all(|it| it.indices == self.corners)
            && self.colors.iter().all(|it| it.indices == self.corners)
    }
}

impl<'a> Builder<'a> {
    fn new(polygons: &'a Polygons) -> Self {
        let mesh = Mesh {
            name: polygons.name.clone(),
            normals: polygons.normals.as_ref().map(|_| Vec::new()),
            uvs: vec![Vec::new(); polygons.uvs.len()],
            colors: polygons.colors.as_ref().map(|_| Vec::new()),
            ..Mesh::default()
        };
        let by_position = polygons.follows_positions().then(|| vec![u32::MAX; polygons.positions.len()]);
        Self { polygons, mesh, vertices: HashMap::new(), by_position }
    }

    /// The vertex of a corner, made if there is none yet.
    fn vertex(&mut self, corner: usize) -> u32 {
        let polygons = self.polygons;
        let next = self.mesh.positions.len() as u32;
        let vertex = if let Some(by_position) = &mut self.by_position {
            let known = &mut by_position[polygons.corners[corner] as usize];
            *known = (*known).min(next);
            *known
        } else {
            let uv = |set: usize| polygons.uvs.get(set).map_or(0, |uvs| uvs.indices[corner]);
            // Meshes with more sets are rare; their corners are not joined.
            let rest = if polygons.uvs.len() > 2 { corner as u32 } else { uv(1) };
            let normal = polygons.normals.as_ref().map_or(0, |normals| normals.indices[corner]);
            let color = polygons.colors.as_ref().map_or(0, |colors| colors.indices[corner]);
            let key = [polygons.corners[corner], normal, color, uv(0), rest];
            *self.vertices.entry(key).or_insert(next)
        };
        if vertex == next {
            self.push(corner);
        }
        vertex
    }

    fn push(&mut self, corner: usize) {
        let Self { polygons, mesh, .. } = self;
        mesh.positions.push(polygons.positions[polygons.corners[corner] as usize]);
        if let (Some(to), Some(from)) = (&mut mesh.normals, &polygons.normals) {
            to.push(from.values[from.indices[corner] as usize]);
        }
        for (to, from) in mesh.uvs.iter_mut().zip(&polygons.uvs) {
            to.push(from.values[from.indices[corner] as usize]);
        }
        if let (Some(to), Some(from)) = (&mut mesh.colors, &polygons.colors) {
            to.push(from.values[from.indices[corner] as usize]);
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
