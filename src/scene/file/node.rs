//! `[node."Lamp*"]`: changes to imported nodes.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::{
    glob,
    keys::Keys,
    placement,
    report::{Complaint, advice},
    texture::Assets,
    value::{flag, number, numbers, text, vector},
};
use crate::{Id, LightKind, Material, Node, Scene};

/// What a table says.
struct Edit {
    visible: Option<bool>,
    translate: DVec3,
    turn: DMat3,
    material: Option<Id<Material>>,
    light_scale: Option<f32>,
    light_color: Option<Vec3>,
}

/// Reads one table and applies it to the nodes that fit `pattern`. `complete` says that all imports were read, so that a
/// name which fits nothing is the file's mistake.
pub(super) fn read(pattern: &str, mut keys: Keys<'_>, assets: &mut Assets, complete: bool) {
    let scene = &mut assets.scene;
    let edit = edit(&mut keys, scene, complete);
    let found = fitting(pattern, scene);
    if found.is_empty() && complete {
        unmatched(pattern, &keys, scene);
    }
    let lit = found.iter().any(|&id| scene.nodes[id].light.is_some());
    if !lit && !found.is_empty() {
        for key in ["light_scale", "light_color"].into_iter().filter(|key| keys.has(key)) {
            keys.complain(key, Complaint::new("no node that fits has a light"));
        }
    }
    for id in found {
        edit.apply(id, scene);
    }
    keys.finish();
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
    let color = keys.optional("light_color", numbers::<3>(0.0..));
    Edit {
        visible: keys.optional("visible", flag),
        translate: keys.optional("translate", vector).unwrap_or(DVec3::ZERO),
        turn: rotate * DMat3::from_diagonal(scale),
        material,
        light_scale: keys.optional("light_scale", number(0.0..)).map(|scale| scale as f32),
        light_color: color.map(|color| Vec3::from_array(color.map(|channel| channel as f32))),
    }
}

/// The nodes whose name, or names from a root down joined by `/`, fits.
fn fitting(pattern: &str, scene: &Scene) -> Vec<Id<Node>> {
    let mut paths: Vec<String> = Vec::new();
    let mut found = Vec::new();
    for placed in scene.placed() {
        paths.truncate(placed.depth);
        let path = match paths.last() {
            Some(above) => format!("{above}/{}", placed.node.name),
            None => placed.node.name.clone(),
        };
        if glob::matches(pattern, &placed.node.name) || glob::matches(pattern, &path) {
            found.push(placed.id);
        }
        paths.push(path);
    }
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
    fn apply(&self, id: Id<Node>, scene: &mut Scene) {
        let node = &mut scene.nodes[id];
        node.visible = self.visible.unwrap_or(node.visible);
        node.material = self.material.or(node.material);
        let DAffine3 { matrix3, translation } = node.transform;
        node.transform = DAffine3 { matrix3: self.turn * matrix3, translation: translation + self.translate };
        if self.light_scale.is_none() && self.light_color.is_none() {
            return;
        }
        // Other nodes may share the light.
        let Some(mut light) = node.light.and_then(|light| scene.lights.get(light)).cloned() else { return };
        light.color = self.light_color.unwrap_or(light.color);
        *strength(&mut light.kind) *= self.light_scale.unwrap_or(1.0);
        node.light = Some(scene.lights.push(light));
    }
}

/// What a light's colour is multiplied with.
fn strength(kind: &mut LightKind) -> &mut f32 {
    match kind {
        LightKind::Point { intensity } | LightKind::Spot { intensity, .. } => intensity,
        LightKind::Directional { illuminance, .. } => illuminance,
        LightKind::Rect { radiance, .. }
        | LightKind::Disk { radiance, .. }
        | LightKind::Sphere { radiance, .. }
        | LightKind::Cylinder { radiance, .. }
        | LightKind::Environment { radiance, .. } => radiance,
    }
}
