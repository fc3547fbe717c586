//! What a world may take over from one that was prepared before it.

use std::{collections::BTreeSet, path::PathBuf, sync::Arc};

use ajar_scene::{Id, Mesh};
use bytemuck::NoUninit;
use glam::{Vec2, Vec3, Vec4};

use super::World;
use crate::tangents;

/// A world that was prepared before.
#[derive(Clone, Copy, Debug)]
pub struct Previous<'a> {
    /// It.
    pub world: &'a World,
    /// Files that may hold something else since then.
    pub changed: &'a BTreeSet<PathBuf>,
}

/// Generated tangents of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Tangents {
    /// The texture coordinate set that they follow.
    uv_set: u32,
    /// For each triangle those of its corners.
    pub corners: Arc<Vec<[Vec4; 3]>>,
}

impl Tangents {
    pub fn new(mesh: &Mesh, uv_set: u32) -> Option<Self> {
        let corners = Arc::new(tangents::generate(mesh, uv_set as usize)?);
        Some(Self { uv_set, corners })
    }

    /// Those of the old world, if they would come out the same.
    pub fn kept(old: &World, id: Id<Mesh>, mesh: &Mesh, uv_set: u32) -> Option<Self> {
        let kept = old.tangents.get(id.index())?.as_ref().filter(|kept| kept.uv_set == uv_set)?;
        let before = old.scene.meshes.get(id)?;
        let same = same_shape(mesh, before)
            && same_bits(normals(mesh), normals(before))
            && same_bits(uvs(mesh, uv_set), uvs(before, uv_set));
        same.then(|| kept.clone())
    }
}

fn normals(mesh: &Mesh) -> &[Vec3] {
    mesh.normals.as_deref().unwrap_or_default()
}

fn uvs(mesh: &Mesh, set: u32) -> &[Vec2] {
    mesh.uvs.get(set as usize).map(Vec::as_slice).unwrap_or_default()
}

/// Whether rays cannot tell the meshes apart.
pub(super) fn same_shape(a: &Mesh, b: &Mesh) -> bool {
    same_bits(&a.positions, &b.positions) && a.triangles == b.triangles
}

/// Stricter than `==`, under which zeros of both signs are one and NaN is none.
fn same_bits<T: NoUninit>(a: &[T], b: &[T]) -> bool {
    let bytes: [&[u8]; 2] = [a, b].map(bytemuck::cast_slice);
    bytes[0] == bytes[1]
}
