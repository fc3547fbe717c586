//! Meshes of polygons with attributes per corner, into triangles with attributes per vertex.

mod catmull_clark;
pub(crate) mod ears;
mod edges;
mod normals;
mod subdivide;
mod triangles;

use std::borrow::Cow;

use ajar_scene::{Diagnostic, Id, Material};
use glam::{Vec2, Vec3, Vec4};
use serde::Deserialize;

pub(crate) use subdivide::{Boundary, Linear};

/// Values, and which of them each corner has.
#[derive(Clone, Debug, Default)]
pub(crate) struct Attribute<'a, T: Clone> {
    pub values: Cow<'a, [T]>,
    /// One a corner; without, the corners have the values in turn.
    pub indices: Option<Cow<'a, [u32]>>,
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
pub(crate) struct Polygons<'a> {
    pub name: String,
    pub positions: Cow<'a, [Vec3]>,
    /// Number of corners of each face.
    pub faces: Cow<'a, [u32]>,
    /// Position of each corner.
    pub corners: Cow<'a, [u32]>,
    /// One a face: an index into `materials`.
    pub part_of: Vec<u32>,
    /// One a face.
    pub is_hole: Vec<bool>,
    /// That of the faces in no part comes first.
    pub materials: Vec<Option<Id<Material>>>,
    pub normals: Option<Attribute<'a, Vec3>>,
    pub uvs: Vec<Attribute<'a, Vec2>>,
    pub colors: Option<Attribute<'a, Vec4>>,
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

impl Polygons<'_> {
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
    pub fn attribute<'v, T: Clone>(
        &self,
        values: Cow<'v, [T]>,
        indices: Option<Cow<'v, [u32]>>,
        per: Per,
    ) -> Result<Attribute<'v, T>, Diagnostic> {
        let count = match per {
            Per::Corner => self.corners.len(),
            Per::Position => self.positions.len(),
            Per::Face => self.faces.len(),
            Per::Mesh => 1,
        };
        let given = indices.as_ref().map_or(values.len(), |indices| indices.len());
        if given != count {
            return Err(Diagnostic::error(format!("has {given} entries, {count} are needed")));
        }
        if let Some(indices) = &indices {
            within(indices, values.len(), "values")?;
        }
        let index = |entry: u32| indices.as_ref().map_or(entry, |indices| indices[entry as usize]);
        let indices = match per {
            Per::Corner => indices,
            Per::Position => Some(self.corners.iter().map(|&position| index(position)).collect()),
            Per::Face => {
                let corners =
                    |(face, &count): (usize, &u32)| std::iter::repeat_n(index(face as u32), count as usize);
                Some(self.faces.iter().enumerate().flat_map(corners).collect())
            }
            Per::Mesh => Some(vec![index(0); self.corners.len()].into()),
        };
        Ok(Attribute { values, indices })
    }
}

/// Whether all indices are below `count`.
pub(crate) fn within(indices: &[u32], count: usize, of: &str) -> Result<(), Diagnostic> {
    match indices.iter().max().filter(|&&index| index as usize >= count) {
        Some(index) => Err(Diagnostic::error(format!("index {index} reaches beyond the {count} {of}"))),
        None => Ok(()),
    }
}
