//! Materials by name, by their path in their own file, or by the path that they are shown at: the path of a node, `/`, and
//! the name of the material.

use super::glob;
use crate::{Id, Material, Mesh, Node, Scene};

/// A mesh of a node that shows a material.
struct Shown {
    node: Id<Node>,
    mesh: Id<Mesh>,
    /// Whether this place fits.
    fits: bool,
}

/// The materials that fit `pattern`. One that fits in some of the places where it is shown, and not by itself, is split:
/// those places get a copy, which stands for it here.
pub(super) fn fitting(pattern: &str, scene: &mut Scene) -> Vec<Id<Material>> {
    let mut places: Vec<Vec<Shown>> = scene.materials.iter().map(|_| Vec::new()).collect();
    if pattern.contains('/') {
        find_places(pattern, scene, &mut places);
    }
    let mut found = Vec::new();
    for (index, places) in places.into_iter().enumerate() {
        let id = Id::new(index);
        let (fits, others): (Vec<_>, Vec<_>) = places.into_iter().partition(|place| place.fits);
        let Material { name, path, .. } = &scene.materials[id];
        let is_meant = glob::matches(pattern, name) || !path.is_empty() && glob::matches_path(pattern, path);
        if is_meant || others.is_empty() && !fits.is_empty() {
            found.push(id);
        } else if !fits.is_empty() {
            let copy = scene.materials.push(scene.materials[id].clone());
            fits.into_iter().for_each(|place| show(copy, &place, scene));
            found.push(copy);
        }
    }
    found
}

/// Sorts all meshes of all nodes by the material that they show.
fn find_places(pattern: &str, scene: &Scene, places: &mut [Vec<Shown>]) {
    scene.paths(|placed, path| {
        for &id in &placed.node.meshes {
            let Some(mesh) = scene.meshes.get(id) else { continue };
            let Some(material) = placed.node.material.or(mesh.material) else { continue };
            let Some(name) = scene.materials.get(material).map(|material| &material.name) else { continue };
            let fits = glob::matches_path(pattern, &format!("{path}/{name}"));
            places[material.index()].push(Shown { node: placed.id, mesh: id, fits });
        }
    });
}

/// Gives a mesh of a node another material. Other nodes may share the mesh and this one may have more, so that it gets a
/// node of its own unless it is alone.
fn show(material: Id<Material>, at: &Shown, scene: &mut Scene) {
    let node = &mut scene.nodes[at.node];
    let Some(position) = node.meshes.iter().position(|&mesh| mesh == at.mesh) else { return };
    if node.meshes.len() == 1 {
        node.material = Some(material);
        return;
    }
    node.meshes.remove(position);
    let name = scene.meshes[at.mesh].name.clone();
    let below = Node { name, meshes: vec![at.mesh], material: Some(material), ..Node::default() };
    let below = scene.nodes.push(below);
    scene.nodes[at.node].children.push(below);
}
