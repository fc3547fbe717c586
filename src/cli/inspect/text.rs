//! The contents of a scene for people. Names come from files, so they are printed with control characters escaped.

use std::collections::BTreeSet;

use ajar_scene::{Loss, Setting};
use serde_json::Value;

use super::contents::{Bounds, Contents, Counts, MaterialEntry, NodeEntry, TextureEntry};
use super::optics::{CameraEntry, LightEntry};
use crate::words::{bytes, grouped, many, number, plain, quoted, vector};

/// Children of one node, levels, and lines of the hierarchy that are shown unless all are asked for.
const SIBLINGS: usize = 12;
const LEVELS: usize = 12;
const LINES: usize = 200;

/// Levels that are indented: deeper ones would only fill the screen with blanks.
const INDENTED: usize = 40;

/// Everything, in sections with a blank line between.
pub(super) fn describe(contents: &Contents<'_>, all: bool) -> String {
    let Contents { counts, materials, textures, lights, cameras, diagnostics, .. } = contents;
    let materials = materials.iter().map(|it| material(it, textures));
    let lights = lights.iter().map(|it| light(it, textures));
    let mut sections = vec![
        format!("{}\nscene {}", contents.file, contents.scene_hash),
        section("hierarchy", hierarchy(contents, all)),
        section("counts", tally(counts)),
        section("bounds", contents.bounds.iter().map(bounds)),
        section("materials", materials),
        section("lights", lights),
        section("cameras", cameras.iter().map(camera)),
        section("textures", textures.iter().map(texture)),
        section("settings", settings(contents.settings)),
    ];
    let told = |loss| diagnostics.iter().filter(move |it| it.loss == loss).map(|it| it.to_string());
    sections.push(section("approximated", told(Some(Loss::Approximated))));
    sections.push(section("dropped", told(Some(Loss::Dropped))));
    sections.push(told(None).collect::<Vec<_>>().join("\n"));
    sections.retain(|section| !section.is_empty());
    sections.join("\n\n")
}

/// Who set what, where more than one could.
fn settings(settings: &[Setting]) -> Vec<String> {
    let sources: BTreeSet<_> = settings.iter().map(|setting| &setting.by).collect();
    if sources.len() < 2 {
        return Vec::new();
    }
    let line = |Setting { key, value, by, over, .. }: &Setting| {
        let value = value.split_whitespace().collect::<Vec<_>>().join(" ");
        let over = if over.is_empty() { String::new() } else { format!(", over {}", over.join(", ")) };
        format!("{key} = {value} ({by}{over})")
    };
    settings.iter().map(line).collect()
}

/// A title and indented lines; nothing without lines.
fn section(title: &str, lines: impl IntoIterator<Item = String>) -> String {
    let lines: String = lines.into_iter().map(|line| format!("\n  {line}")).collect();
    if lines.is_empty() { lines } else { format!("{title}{lines}") }
}

fn hierarchy(contents: &Contents<'_>, all: bool) -> Vec<String> {
    let roots = contents.nodes.iter().filter(|node| node.depth == 0).count();
    let mut lines: Vec<String> = Vec::new();
    // What follows on this level or deeper is left out, until the walk comes up again.
    let mut left_out = None;
    for (index, node) in contents.nodes.iter().enumerate() {
        if left_out.is_some_and(|depth| node.depth >= depth) {
            continue;
        }
        left_out = None;
        let indent = "  ".repeat(node.depth.min(INDENTED));
        if !all && lines.len() >= LINES {
            lines.push(format!("… and {} more nodes", contents.nodes.len() - index));
            break;
        }
        let siblings = node.parent.map_or(roots, |parent| contents.nodes[parent].children);
        if !all && node.sibling >= SIBLINGS && siblings > SIBLINGS + 1 {
            lines.push(format!("{indent}… and {} more", siblings - SIBLINGS));
            left_out = Some(node.depth);
        } else if !all && node.depth >= LEVELS {
            lines.push(format!("{indent}… and what is below"));
            left_out = Some(node.depth);
        } else {
            lines.push(format!("{indent}{}", one_node(node, contents)));
        }
    }
    lines
}

fn one_node(node: &NodeEntry<'_>, contents: &Contents<'_>) -> String {
    let mut holds: Vec<String> = Vec::new();
    for mesh in node.meshes.iter().take(SIBLINGS).filter_map(|&index| contents.meshes.get(index)) {
        let times = if mesh.placed > 1 { format!(", placed {} times", mesh.placed) } else { String::new() };
        let material = node.material.or(mesh.material).and_then(|index| contents.materials.get(index));
        let material = material.map_or(String::new(), |it| format!(" of {}", quoted(it.name)));
        holds.push(format!(
            "mesh {}{material} ({}{times})",
            quoted(mesh.name),
            many(mesh.triangles, "triangle")
        ));
    }
    if node.meshes.len() > SIBLINGS {
        holds.push(format!("{} more meshes", node.meshes.len() - SIBLINGS));
    }
    holds.extend(
        node.light
            .and_then(|i| contents.lights.get(i))
            .map(|it| format!("{} light {}", it.kind, quoted(it.name))),
    );
    holds.extend(
        node.camera.and_then(|i| contents.cameras.get(i)).map(|it| format!("camera {}", quoted(it.name))),
    );
    if !node.visible {
        holds.push("hidden".into());
    }
    let name = if node.name.is_empty() { "(no name)".into() } else { plain(node.name) };
    if holds.is_empty() { name } else { format!("{name}: {}", holds.join(", ")) }
}

fn tally(counts: &Counts) -> [String; 3] {
    [
        format!(
            "{}, {}, {}",
            many(counts.nodes, "node"),
            many(counts.meshes, "mesh"),
            many(counts.instances, "instance")
        ),
        format!(
            "{} ({} placed), {}",
            many(counts.triangles, "triangle"),
            grouped(counts.placed_triangles),
            many(counts.vertices, "vertex")
        ),
        format!(
            "{}, {}, {}, {}, {}",
            many(counts.materials, "material"),
            many(counts.textures, "texture"),
            many(counts.images, "image"),
            many(counts.lights, "light"),
            many(counts.cameras, "camera")
        ),
    ]
}

fn bounds(bounds: &Bounds) -> String {
    let size = bounds.size.map(number).join(" × ");
    format!("{size} m, from {} to {}", vector(&bounds.low), vector(&bounds.high))
}

fn material(material: &MaterialEntry<'_>, textures: &[TextureEntry<'_>]) -> String {
    let parameters: Vec<_> = material
        .parameters
        .iter()
        .map(|(key, value)| format!("{key} {}", parameter(value, textures)))
        .collect();
    let parameters = if parameters.is_empty() { "as the default".into() } else { parameters.join(", ") };
    let place = material.path.as_deref().map_or("shown nowhere".into(), plain);
    let more = match material.shown {
        0 | 1 => String::new(),
        shown => format!(" and {}", many(shown - 1, "more place")),
    };
    format!("{} ({place}{more}): {parameters}", quoted(material.name))
}

/// A parameter: a plain value, or an input or normal map with its texture.
fn parameter(value: &Value, textures: &[TextureEntry<'_>]) -> String {
    let Value::Object(fields) = value else { return plain_value(value) };
    // An input nests the texture with its channel; a normal map has it right here.
    let image = |fields: &serde_json::Map<String, Value>| {
        let index = fields.get("texture")?.as_u64()? as usize;
        Some(quoted(textures.get(index)?.image))
    };
    match (fields.get("value"), fields.get("texture")) {
        (Some(value), Some(Value::Object(texture))) => {
            let channel = texture.get("channel").and_then(Value::as_str).filter(|_| value.is_number());
            let channel = channel.map_or(String::new(), |c| format!(".{c}"));
            let image = image(texture).unwrap_or_default();
            if is_one(value) {
                format!("{image}{channel}")
            } else {
                format!("{} × {image}{channel}", plain_value(value))
            }
        }
        (Some(value), _) => plain_value(value),
        (None, Some(_)) => {
            let scale = fields.get("scale").filter(|scale| !is_one(scale));
            let scale = scale.map_or(String::new(), |scale| format!("{} × ", plain_value(scale)));
            format!("{scale}{}", image(fields).unwrap_or_default())
        }
        (None, None) => fields
            .iter()
            .map(|(key, value)| format!("{key} {}", plain_value(value)))
            .collect::<Vec<_>>()
            .join(" "),
    }
}

fn is_one(value: &Value) -> bool {
    match value {
        Value::Array(items) => items.iter().all(is_one),
        other => other.as_f64() == Some(1.0),
    }
}

fn plain_value(value: &Value) -> String {
    match value {
        Value::Null => "infinite".into(),
        Value::Bool(flag) => if *flag { "yes" } else { "no" }.into(),
        Value::Number(n) => number(n.as_f64().unwrap_or_default()),
        Value::String(text) => plain(text),
        Value::Array(items) => format!("({})", items.iter().map(plain_value).collect::<Vec<_>>().join(", ")),
        Value::Object(_) => String::new(),
    }
}

fn light(light: &LightEntry<'_>, textures: &[TextureEntry<'_>]) -> String {
    let strength = number(light.strength.into());
    let mut text = format!("{}: {}, {strength} {}", quoted(light.name), light.kind, light.unit);
    if light.color != [1.0; 3] {
        text.push_str(&format!(", colour {}", vector(&light.color.map(f64::from))));
    }
    for (name, value) in &light.shape {
        let unit = if name.ends_with("angle") { "°" } else { " m" };
        text.push_str(&format!(", {name} {}{unit}", number(*value)));
    }
    if let Some(texture) = light.texture.and_then(|index| textures.get(index)) {
        text.push_str(&format!(", × {}", quoted(texture.image)));
    }
    text
}

fn camera(camera: &CameraEntry<'_>) -> String {
    let mut text = format!("{}: {}", quoted(camera.name), camera.kind);
    if let Some(fov) = camera.fov {
        text.push_str(&format!(", {}° high", number(fov)));
    }
    if let Some(height) = camera.height {
        text.push_str(&format!(", {} m high", number(height.into())));
    }
    match (camera.lens_radius, camera.focus_distance) {
        (Some(radius), Some(distance)) if radius > 0.0 => {
            let (radius, distance) = (number(radius.into()), number(distance.into()));
            text.push_str(&format!(", lens radius {radius} m focused at {distance} m"));
        }
        (Some(_), _) => text.push_str(", pinhole"),
        (None, _) => {}
    }
    if camera.exposure != 1.0 {
        text.push_str(&format!(", exposure {}", number(camera.exposure.into())));
    }
    text
}

fn texture(texture: &TextureEntry<'_>) -> String {
    let place = match &texture.file {
        Some(path) => plain(path),
        None => "embedded".into(),
    };
    let size = texture.bytes.map_or("missing".into(), bytes);
    let uv_set = if texture.uv_set > 0 { format!(", UV set {}", texture.uv_set) } else { String::new() };
    let others = texture.parameters.iter().map(|(key, value)| format!(", {key} {}", plain_value(value)));
    let color_space = plain_value(&texture.color_space);
    format!("{}: {place}, {size}, {color_space}{uv_set}{}", quoted(texture.image), others.collect::<String>())
}
