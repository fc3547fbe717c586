//! From JSON text to the crate's types, with the place of what does not fit.
//!
//! Animations and skins are taken out first: they are not used yet, and `gltf-json` 1.4.1 cannot read the targets of
//! KHR_animation_pointer. It also wants `nodes` in every scene, which the specification does not, and `attributes` in
//! every primitive, which only costs that primitive here.

use ajar_scene::Diagnostic;
use gltf::json::Root;
use serde_json::{Map, Value};

use super::{container, extensions};
use crate::report::Report;

/// The document and the binary chunk of a file.
pub(super) fn parse(file: Vec<u8>, report: &mut Report) -> Result<(Root, Option<Vec<u8>>), Diagnostic> {
    let container = container::split(file, report)?;
    let mut document = json(&container)?;
    version(&document)?;
    extensions::check(&document, report)?;
    for (list, what) in [("animations", "animations are ignored"), ("skins", "skins are ignored")] {
        if document.remove(list).is_some_and(|v| v.as_array().is_some_and(|items| !items.is_empty())) {
            report.warn(list, format!("{what}; the scene is shown in its rest pose"));
        }
    }
    for scene in objects(document.get_mut("scenes")) {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    for mesh in objects(document.get_mut("meshes")) {
        for primitive in objects(mesh.get_mut("primitives")) {
            primitive.entry("attributes").or_insert_with(|| Value::Object(Map::new()));
        }
    }
    let root = serde_path_to_error::deserialize(Value::Object(document)).map_err(|error| {
        let path = error.path().to_string();
        let found = Diagnostic::error(error.into_inner().to_string());
        if path == "." { found } else { found.element(path) }
    })?;
    Ok((root, container.binary))
}

/// The objects in a list.
fn objects(list: Option<&mut Value>) -> impl Iterator<Item = &mut Map<String, Value>> {
    list.and_then(Value::as_array_mut).into_iter().flatten().filter_map(Value::as_object_mut)
}

fn json(container: &container::Container) -> Result<Map<String, Value>, Diagnostic> {
    let text = container.json.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&container.json);
    let value = serde_json::from_slice(text).map_err(|error| {
        let whole = error.to_string();
        let message = whole.split(" at line ").next().unwrap_or(&whole);
        let found = Diagnostic::error(format!("not valid JSON: {message}"));
        if container.is_binary { found } else { found.at(error.line(), error.column().max(1)) }
    })?;
    match value {
        Value::Object(document) => Ok(document),
        _ => Err(Diagnostic::error("not a glTF document: the JSON is not an object")),
    }
}

/// Refuses what is not glTF 2; a higher minor version is read as 2.0 unless it says that it must not be.
fn version(document: &Map<String, Value>) -> Result<(), Diagnostic> {
    let field = |name: &str| document.get("asset").and_then(|asset| asset.get(name)).and_then(Value::as_str);
    let Some(version) = field("version") else {
        return Err(Diagnostic::error("not a glTF document: asset.version is missing").element("asset"));
    };
    let refuse = |element: &str, found: &str| {
        Err(Diagnostic::error(format!(
            "glTF version \"{}\" is not supported, only 2.0 is",
            found.escape_debug()
        ))
        .element(element)
        .hint("convert glTF 1.0 files to 2.0 with gltf-pipeline"))
    };
    match field("minVersion") {
        Some(least) if least != "2.0" => refuse("asset.minVersion", least),
        _ if version.split('.').next() != Some("2") => refuse("asset.version", version),
        _ => Ok(()),
    }
}
