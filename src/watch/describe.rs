//! What can be changed of a scene, as pages are told.

use ajar_render::World;
use ajar_scene::{Camera, Diagnostic, Input, LightKind, Material, Projection, Scene, Setting, VariedImport};
use glam::{DAffine3, DVec3, Vec3};
use serde_json::{Value, json};

use super::opened::Opened;

/// Most materials and lights that a page lists.
const MOST: usize = 500;

/// Everything about a scene that stays as it is while it is rendered.
pub(super) fn scene(opened: &Opened, pivot: DVec3, messages: &[Diagnostic]) -> Value {
    let scene = &opened.world.scene;
    let cameras: Vec<_> = scene.cameras.iter().map(|camera| &camera.name).collect();
    json!({
        "type": "scene",
        "camera": camera(&opened.camera, pivot),
        "cameras": cameras,
        "materials": materials(&opened.world),
        "lights": opened.lights,
        "imports": imports(&opened.varied),
        "view": { "tone_map": opened.form.tone_map, "exposure": opened.form.exposure },
        "notes": notes(messages),
    })
}

/// What was said about it, the worst first.
fn notes(messages: &[Diagnostic]) -> Vec<&Diagnostic> {
    let mut notes: Vec<_> = messages.iter().collect();
    notes.sort_by_key(|message| std::cmp::Reverse(message.severity));
    notes.truncate(MOST);
    notes
}

fn imports(varied: &[VariedImport]) -> Vec<Value> {
    let import = |it: &VariedImport| json!({ "name": it.name, "variants": &it.variants[..it.variants.len().min(MOST)] });
    varied.iter().take(MOST).map(import).collect()
}

fn camera((camera, place): &(Camera, DAffine3), pivot: DVec3) -> Value {
    let (yfov, half_height) = match camera.projection {
        Projection::Perspective { yfov, .. } => (Some(yfov.to_degrees()), None),
        Projection::Orthographic { half_height } => (None, Some(half_height)),
    };
    json!({
        "name": camera.name,
        "position": place.translation.to_array(),
        "target": pivot.to_array(),
        "up": place.matrix3.y_axis.normalize_or(DVec3::Y).to_array(),
        "yfov": yfov,
        "half_height": half_height,
    })
}

/// The materials of what is placed, by their names, which are what changes go by.
fn materials(world: &World) -> Vec<Value> {
    let mut used: Vec<_> = world.instances().iter().map(|instance| instance.material as usize).collect();
    used.sort_unstable();
    used.dedup();
    let mut names = std::collections::BTreeSet::new();
    let materials = used.into_iter().filter_map(|index| world.scene.materials.iter().nth(index));
    let named = materials.filter(|material| !material.name.is_empty() && names.insert(&material.name));
    named.take(MOST).map(material).collect()
}

fn material(material: &Material) -> Value {
    let number = |input: &Input<f32>| json!({ "value": input.value, "textured": input.texture.is_some() });
    let color =
        |input: &Input<Vec3>| json!({ "value": input.value.to_array(), "textured": input.texture.is_some() });
    json!({
        "name": material.name,
        "base_color": color(&material.base_color),
        "roughness": number(&material.roughness),
        "metallic": number(&material.metallic),
        "specular": number(&material.specular),
        "ior": { "value": material.ior },
        "transmission": number(&material.transmission),
        "coat": number(&material.coat),
        "coat_roughness": number(&material.coat_roughness),
        "opacity": number(&material.opacity),
        "emission": color(&material.emission),
    })
}

/// Lights of scene files change by their own keys, those of assets through their nodes.
pub(super) fn lights(scene: &Scene, settings: &[Setting]) -> Vec<Value> {
    let lamps = scene.placed().into_iter().filter_map(|placed| {
        let light = scene.lights.get(placed.node.light?)?;
        let name = &placed.node.name;
        let can_change = !name.is_empty() && !is_nameless("light", name, settings);
        can_change.then(|| {
            let (key, strength) = strength(&light.kind);
            let table = if is_of_file("light", name, settings) { "light" } else { "node" };
            let scale = light_scale(name, settings);
            json!({
                "name": name, "table": table, "key": key, "strength": strength, "scale": scale,
                "color": light.color.to_array(), "shape": shape(&light.kind),
            })
        })
    });
    lamps.take(MOST).collect()
}

/// What scene files and pages say that a light of an asset is multiplied by, under its own name.
fn light_scale(name: &str, settings: &[Setting]) -> f64 {
    let key = format!("node.\"{}\".light_scale", name.escape_debug());
    // The last one is said by the highest layer.
    let said = settings.iter().rev().find(|it| it.key == key);
    said.and_then(|it| it.value.parse().ok()).unwrap_or(1.0)
}

/// Whether a scene file has a table of this kind and name in a list.
pub(super) fn is_of_file(kind: &str, name: &str, settings: &[Setting]) -> bool {
    let is_name = |key: &str| key.starts_with(&format!("{kind}[")) && key.ends_with("].name");
    let quoted = toml::Value::from(name).to_string();
    settings.iter().any(|it| is_name(&it.key) && it.value == quoted)
}

/// Whether it is one of a list in a scene file that says no name, and has got this one: `light 2`.
pub(super) fn is_nameless(kind: &str, name: &str, settings: &[Setting]) -> bool {
    let number = name.strip_prefix(kind).and_then(|number| number.trim_start().parse::<usize>().ok());
    let key = number.and_then(|number| number.checked_sub(1)).map(|index| format!("{kind}[{index}]."));
    key.is_some_and(|key| settings.iter().any(|it| it.key.starts_with(&key)))
}

/// What a light's strength is called in scene files, and what it is.
fn strength(kind: &LightKind) -> (&'static str, f32) {
    match *kind {
        LightKind::Point { intensity } | LightKind::Spot { intensity, .. } => ("intensity", intensity),
        LightKind::Directional { illuminance, .. } => ("illuminance", illuminance),
        LightKind::Rect { radiance, .. }
        | LightKind::Disk { radiance, .. }
        | LightKind::Sphere { radiance, .. }
        | LightKind::Cylinder { radiance, .. }
        | LightKind::Environment { radiance, .. } => ("radiance", radiance),
    }
}

/// The other numbers of a light as scene files say them, angles in degrees, lengths in metres.
fn shape(kind: &LightKind) -> Value {
    match *kind {
        LightKind::Point { .. } | LightKind::Environment { .. } => json!({}),
        LightKind::Spot { inner, outer, .. } => {
            json!({ "inner": inner.to_degrees(), "outer": outer.to_degrees() })
        }
        LightKind::Directional { angle, .. } => json!({ "angle": angle.to_degrees() }),
        LightKind::Rect { width, height, .. } => json!({ "width": width, "height": height }),
        LightKind::Disk { radius, .. } | LightKind::Sphere { radius, .. } => json!({ "radius": radius }),
        LightKind::Cylinder { radius, length, .. } => json!({ "radius": radius, "length": length }),
    }
}
