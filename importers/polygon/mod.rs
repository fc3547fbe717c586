//! Meshes of polygons with attributes per corner, into triangles with attributes per vertex.

mod catmull_clark;
pub(crate) mod ears;
mod edges;
mod normals;
mod subdivide;
mod triangles;

use ajar_scene::{Diagnostic, Id, Material};
use glam::{Vec2, Vec3, Vec4};
use serde::Deserialize;

pub(crate) use subdivide::{Boundary, Linear};

/// Values, and which of them each corner has.
#[derive(Clone, Debug, Default)]
pub(crate) struct Attribute<T> {
    pub values: Vec<T>,
    /// One a corner.
    pub indices: Vec<u32>,
}

impl<T: Copy> Attribute<T> {
    /// The value that a corner has.
    fn at(&self, corner: usize) -> T {
        self.values[self.indices[corner] as usize]
    }
}

/// How a mesh is subdivided; keys and defaults are those of `docs/ajar-scene.md`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Subdivision {
    pub levels: u32,
    pub boundary: Boundary,
    pub linear: Linear,
    /// Edges by their positions.
    pub creases: Vec<[u32; 2]>,
    /// One a crease.
    pub crease_sharpness: Vec<f32>,
    pub sharp_positions: Vec<u32>,
    /// One a sharp position.
    pub position_sharpness: Vec<f32>,
}

/// A mesh of polygons.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polygons {
    pub name: String,
    pub positions: Vec<Vec3>,
    /// Number of corners of each face.
    pub faces: Vec<u32>,
    /// Position of each corner.
    pub corners: Vec<u32>,
    /// One a face: an index into `materials`.
    pub part_of: Vec<u32>,
    /// One a face.
    pub is_hole: Vec<bool>,
    /// That of the faces in no part comes first.
    pub materials: Vec<Option<Id<Material>>>,
    pub normals: Option<Attribute<Vec3>>,
    pub uvs: Vec<Attribute<Vec2>>,
    pub colors: Option<Attribute<Vec4>>,
    pub subdivision: Option<Subdivision>,
}

/// What has one index each.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Per {
    #[default]
    Corner,
    Position,
    Face,
    Mesh,
}

impl Polygons {
    /// Whether faces, corners and positions fit each other; faces with less than three corners are dropped.
    ///
    /// # Errors
    /// What does not fit.
    pub fn check(&self) -> Result<(), Diagnostic> {
        let sum: u64 = self.faces.iter().map(|&count| u64::from(count)).sum();
        if sum != self.corners.len() as u64 {
            let message = format!("faces have {sum} corners, but there are {}", self.corners.len());
            return Err(Diagnostic::error(message));
        }
        within(&self.corners, self.positions.len(), "positions")
    }

    /// First corner of each face, and the number of corners.
    fn first(&self) -> Vec<u32> {
        let mut sum = 0;
        std::iter::once(0)
            .chain(self.faces.iter().map(|&count| {
                sum += count;
                sum
            }))
            .collect()
    }

    /// An attribute with an index for each corner.
    ///
    /// # Errors
    /// A number of indices that does not fit, or an index beyond the values.
    pub fn attribute<T>(
        &self,
        values: Vec<T>,
        indices: Option<Vec<u32>>,
        per: Per,
    ) -> Result<Attribute<T>, Diagnostic> {
        let count = match per {
            Per::Corner => self.corners.len(),
            Per::Position => self.positions.len(),
            Per::Face => self.faces.len(),
            Per::Mesh => 1,
        };
        let given = indices.as_ref().map_or(values.len(), Vec::len);
        if given != count {
            return Err(Diagnostic::error(format!("has {given} entries, {count} are needed")));
        }
        if let Some(indices) = &indices {
            within(indices, values.len(), "values")?;
        }
        let index = |entry: u32| indices.as_ref().map_or(entry, |indices| indices[entry as usize]);
        let indices = match per {
            Per::Corner => indices.unwrap_or_else(|| (0..count as u32).collect()),
            Per::Position => self.corners.iter().map(|&position| index(position)).collect(),
            Per::Face => {
                let corners =
                    |(face, &count): (usize, &u32)| std::iter::repeat_n(index(face as u32), count as usize);
                self.faces.iter().enumerate().flat_map(corners).collect()
            }
            Per::Mesh => vec![index(0); self.corners.len()],
        };
        Ok(Attribute { values, indices })
    }
}

/// Whether all indices are below `count`.
pub(crate) fn within(indices: &[u32], count: usize, of: &str) -> Result<(), Diagnostic> {
    match indices.iter().find(|&&index| index as usize >= count) {
        Some(index) => Err(Diagnostic::error(format!("index {index} reaches beyond the {count} {of}"))),
        None => Ok(()),
    }
}
