//! From JSON text to the crate's types, with the place of what does not fit.
//!
//! Animations are taken out: `gltf-json` 1.4.1 cannot read the targets of KHR_animation_pointer. It also wants `nodes` in every scene, which the specification does not, and `attributes` in
//! every primitive, which only costs that primitive here.

use ajar_scene::Diagnostic;
use gltf::json::Root;
use serde_json::{Map, Value};

use super::{Context, container, extensions};
use crate::{json::cost, report::Report};

/// Values, the types made of them, and the values again where something moves.
const COPIES: u64 = 3;

/// A file taken apart.
pub(super) struct Document {
    /// The JSON but for the animations, ready for [`root`].
    pub json: Map<String, Value>,
    pub animations: Vec<Value>,
    /// The binary chunk.
    pub binary: Option<container::Bytes>,
}

/// Takes a file apart.
///
/// # Errors
/// No glTF 2, or an extension is required that is not supported.
pub(super) fn parse(file: Vec<u8>, context: &mut Context) -> Result<Document, Diagnostic> {
    let container = container::split(file, &mut context.report)?;
    context.charge(cost(&container.json) * COPIES, "the JSON")?;
    let report = &mut context.report;
    let mut json = json(&container)?;
    version(&json)?;
    extensions::check(&json, report)?;
    let animations = match json.remove("animations") {
        Some(Value::Array(animations)) => animations,
        _ => Vec::new(),
    };
    for scene in objects(json.get_mut("scenes")) {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    for skin in objects(json.get_mut("skins")) {
        skin.entry("joints").or_insert_with(|| Value::Array(Vec::new()));
    }
    for mesh in objects(json.get_mut("meshes")) {
        for primitive in objects(mesh.get_mut("primitives")) {
            primitive.entry("attributes").or_insert_with(|| Value::Object(Map::new()));
            check_targets(primitive, report);
        }
    }
    Ok(Document { json, animations, binary: container.binary })
}

/// Warns about morph targets of attributes that the crate's type has not.
fn check_targets(primitive: &mut Map<String, Value>, report: &mut Report) {
    let known = ["POSITION", "NORMAL", "TANGENT"];
    let names =
        objects(primitive.get_mut("targets")).flat_map(|target| target.keys().cloned().collect::<Vec<_>>());
    for name in names.filter(|name| !known.contains(&name.as_str())) {
        let message = format!("morph targets of {} are dropped", name.escape_debug());
        report.warn("meshes", message);
    }
}

/// The JSON in the crate's types.
///
/// # Errors
/// Names the element that does not fit.
pub(super) fn root(json: Map<String, Value>) -> Result<Root, Diagnostic> {
    serde_path_to_error::deserialize(Value::Object(json)).map_err(|error| {
        let path = error.path().to_string();
        let found = Diagnostic::error(error.into_inner().to_string());
        if path == "." { found } else { found.element(path) }
    })
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
