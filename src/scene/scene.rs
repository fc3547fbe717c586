//! The whole scene.

use glam::DAffine3;
use serde::{Deserialize, Serialize};

use crate::{Arena, Camera, Id, Image, Light, Material, Mesh, Node, Texture};

/// What a scene is: plain data in metres, right-handed, +Y up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// All nodes; those that no other node names as child are reached only through `roots`.
    pub nodes: Arena<Node>,
    /// Nodes without parent that belong to the scene.
    pub roots: Vec<Id<Node>>,
    /// Meshes.
    pub meshes: Arena<Mesh>,
    /// Materials.
    pub materials: Arena<Material>,
    /// Textures.
    pub textures: Arena<Texture>,
    /// Images.
    pub images: Arena<Image>,
    /// Lights.
    pub lights: Arena<Light>,
    /// Cameras.
    pub cameras: Arena<Camera>,
}

/// A node met on a walk through the hierarchy.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// Its handle.
    pub id: Id<Node>,
    /// The node.
    pub node: &'a Node,
    /// From the node's space to the world.
    pub world: DAffine3,
    /// Whether it and all nodes above are visible and its transform can be inverted: a scale of zero hides (glTF 2.0,
    /// 3.5.3).
    pub visible: bool,
    /// Number of nodes above it.
    pub depth: usize,
}

impl Scene {
    /// All nodes below the roots with their world transforms, parents before children, in a stable order. Dangling
    /// handles are left out and no node is met twice, so it ends on malformed scenes too.
    pub fn placed(&self) -> Vec<Placed<'_>> {
        let mut met = vec![false; self.nodes.len()];
        let mut found = Vec::with_capacity(self.nodes.len());
        let mut open: Vec<_> = self.roots.iter().rev().map(|&id| (id, DAffine3::IDENTITY, true, 0)).collect();
        while let Some((id, parent, visible, depth)) = open.pop() {
            let Some(node) = self.nodes.get(id) else { continue };
            if std::mem::replace(&mut met[id.index()], true) {
                continue;
            }
            let world = parent * node.transform;
            let visible = visible && node.visible && !is_singular(&node.transform);
            found.push(Placed { id, node, world, visible, depth });
            open.extend(node.children.iter().rev().map(|&child| (child, world, visible, depth + 1)));
        }
        found
    }

    /// Calls `visit` for every node that [`placed`](Self::placed) finds, with its path: the names from a root down to it,
    /// joined by `/`.
    pub fn paths<'a>(&'a self, mut visit: impl FnMut(&Placed<'a>, &str)) {
        // One text for all, of which a node takes over what is above it: hierarchies may be deep.
        let (mut path, mut ends) = (String::new(), Vec::new());
        for placed in self.placed() {
            ends.truncate(placed.depth);
            path.truncate(ends.last().copied().unwrap_or(0));
            if placed.depth > 0 {
                path.push('/');
            }
            path.push_str(&placed.node.name);
            ends.push(path.len());
            visit(&placed, &path);
        }
    }
}

/// Whether a transform flattens space, to within rounding, or is not finite.
pub(crate) fn is_singular(transform: &DAffine3) -> bool {
    let m = transform.matrix3;
    let size = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    // Written so that NaN counts as singular; `size` may overflow or vanish where the determinant does too.
    !(transform.is_finite() && m.determinant().abs() > 1e-14 * size)
}
