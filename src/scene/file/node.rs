//! `[node."Lamp*"]`: changes to imported nodes.

use glam::{DAffine3, DMat3, DVec3};

use super::{
    glob,
    keys::Keys,
    lamp, placement,
    report::{Complaint, advice},
    texture::Assets,
    value::{flag, text, vector},
};
use crate::{Id, Material, Node, Scene};

/// What a table says about nodes.
struct Edit {
    visible: Option<bool>,
    translate: DVec3,
    turn: DMat3,
    material: Option<Id<Material>>,
}

/// Reads one table and applies it to the nodes that fit `pattern`. `complete` says that all imports were read, so that a
/// name which fits nothing is the file's mistake.
pub(super) fn read(pattern: &str, mut keys: Keys<'_>, assets: &mut Assets, complete: bool) {
    let edit = edit(&mut keys, &assets.scene, complete);
    let of_lights = lamp::read(&mut keys, assets);
    let scene = &mut assets.scene;
    let found = fitting(pattern, scene);
    if found.is_empty() && complete {
        unmatched(pattern, &keys, scene);
    }
    for &id in &found {
        edit.apply(&mut scene.nodes[id]);
    }
    if !found.is_empty() && !of_lights.is_empty() {
        relight(&found, &of_lights, &keys, scene);
    }
    keys.finish();
}

/// Gives nodes changed lights of their own: others may share those that they had.
fn relight(nodes: &[Id<Node>], edit: &lamp::LightEdit, keys: &Keys<'_>, scene: &mut Scene) {
    let light = |&id: &Id<Node>| Some((id, scene.lights.get(scene.nodes[id].light?)?.clone()));
    let (lit, mut lights): (Vec<_>, Vec<_>) = nodes.iter().filter_map(light).unzip();
    edit.apply(&mut lights, keys);
    for (id, light) in lit.into_iter().zip(lights) {
        scene.nodes[id].light = Some(scene.lights.push(light));
    }
}

fn edit(keys: &mut Keys<'_>, scene: &Scene, complete: bool) -> Edit {
    let material = keys.optional("material", text).and_then(|name| {
        let found = scene.materials.ids().find(|&id| scene.materials[id].name == name);
        if found.is_none() && complete {
            let names: Vec<_> = scene.materials.iter().map(|material| material.name.as_str()).collect();
            keys.complain("material", Complaint::new("no material has this name").hint(advice(&name, names)));
        }
        found
    });
    let rotate = keys.optional("rotate", vector).map_or(DMat3::IDENTITY, placement::rotation);
    let scale = keys.optional("scale", placement::scale).unwrap_or(DVec3::ONE);
    Edit {
        visible: keys.optional("visible", flag),
        translate: keys.optional("translate", vector).unwrap_or(DVec3::ZERO),
        turn: rotate * DMat3::from_diagonal(scale),
        material,
    }
}

/// The nodes whose name or path fits.
fn fitting(pattern: &str, scene: &Scene) -> Vec<Id<Node>> {
    let mut found = Vec::new();
    scene.paths(|placed, path| {
        if glob::matches(pattern, &placed.node.name) || glob::matches_path(pattern, path) {
            found.push(placed.id);
        }
    });
    found
}

fn unmatched(pattern: &str, keys: &Keys<'_>, scene: &Scene) {
    if glob::is_glob(pattern) {
        keys.warn("no imported node fits this pattern");
        return;
    }
    let mut names: Vec<_> =
        scene.nodes.iter().map(|node| node.name.as_str()).filter(|n| !n.is_empty()).collect();
    names.sort_unstable();
    names.dedup();
    keys.reject(Complaint::new("no import has a node of this name").hint(advice(pattern, names)));
}

impl Edit {
    fn apply(&self, node: &mut Node) {
        node.visible = self.visible.unwrap_or(node.visible);
        node.material = self.material.or(node.material);
        let DAffine3 { matrix3, translation } = node.transform;
        node.transform = DAffine3 { matrix3: self.turn * matrix3, translation: translation + self.translate };
    }
}
