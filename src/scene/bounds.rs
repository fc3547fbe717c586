//! Where a scene is.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3};

use crate::{Id, Mesh, Node, Scene};

impl Scene {
    /// The smallest box along the world's axes that holds all triangles of visible meshes: lower and upper corner in
    /// metres. `None` without triangles. Vertices that are not finite or that no triangle uses do not count.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let mut used: HashMap<Id<Mesh>, Vec<bool>> = HashMap::new();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for placed in self.placed().iter().filter(|placed| placed.visible) {
            for &id in &placed.node.meshes {
                let Some(mesh) = self.meshes.get(id) else { continue };
                // Found once: a vertex is a corner of some six triangles, and a mesh may be placed ten thousand times.
                let used = used.entry(id).or_insert_with(|| used_vertices(mesh));
                for (position, _) in mesh.positions.iter().zip(used).filter(|(_, used)| **used) {
                    let point = placed.world.transform_point3(position.as_dvec3());
                    if point.is_finite() {
                        (low, high) = (low.min(point), high.max(point));
                    }
                }
            }
        }
        low.cmple(high).all().then_some((low, high))
    }

    /// Adds a node at the top of the hierarchy.
    pub fn add_root(&mut self, node: Node) -> Id<Node> {
        let id = self.nodes.push(node);
        self.roots.push(id);
        id
    }
}

/// Which vertices have triangles.
fn used_vertices(mesh: &Mesh) -> Vec<bool> {
    let mut used = vec![false; mesh.positions.len()];
    for &index in mesh.triangles.iter().flatten() {
        if let Some(used) = used.get_mut(index as usize) {
            *used = true;
        }
    }
    used
}

/// The rigid motion to `position` that turns −Z along `forward` and +Y as near to `up` as it can; where `up` lies along
/// `forward`, −Z of the world takes its place.
pub fn looking(position: DVec3, forward: DVec3, up: DVec3) -> DAffine3 {
    let back = -forward.normalize_or(DVec3::NEG_Z);
    let right = up.cross(back);
    let right = if right.length() > 1e-9 * up.length() { right } else { DVec3::NEG_Z.cross(back) };
    let right = right.try_normalize().unwrap_or(DVec3::X);
    DAffine3::from_mat3_translation(DMat3::from_cols(right, back.cross(right), back), position)
}
