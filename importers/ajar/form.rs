//! From JSON to the scene: what is left out has the defaults of the scene graph, what is unknown is an error.

use std::path::PathBuf;

use ajar_scene::{
    Arena, Cause, Diagnostic, Id, Image, ImageSource, ImportRequest, Imported, Material, Node, Scene, Texture,
};
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::{Map, Value, json};

use super::{array::Binary, mesh};
use crate::{budget::Budget, json::cost};

/// Version of the JSON, in its key `ajar`.
pub(super) const VERSION: u64 = 1;

/// An image: a file, or bytes of the binary chunk.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImageForm {
    #[serde(default)]
    name: String,
    file: Option<String>,
    bytes: Option<Value>,
}

/// Reads JSON and binary chunk.
pub(super) fn scene(text: &[u8], bytes: &[u8], request: &ImportRequest) -> Result<Imported, Diagnostic> {
    let cost = cost(text);
    if cost > request.memory_limit {
        let message =
            format!("the JSON takes about {cost} bytes, more than the limit of {}", request.memory_limit);
        return Err(Diagnostic::error(message).because(Cause::Resource));
    }
    let mut top: Map<String, Value> = serde_json::from_slice(text)
        .map_err(|e| Diagnostic::error(format!("broken JSON: {e}")).at(e.line().max(1), e.column().max(1)))?;
    match top.remove("ajar") {
        Some(version) if version.as_u64() == Some(VERSION) => {}
        Some(version) => {
            return Err(
                Diagnostic::error(format!("version {version}, only {VERSION} is known")).element("ajar")
            );
        }
        None => return Err(Diagnostic::error("is no Ajar scene: the key \"ajar\" is missing")),
    }
    let binary = Binary { bytes, budget: Budget::new(request.memory_limit) };
    let mut imported = Imported::default();
    let meshes = mesh::meshes(list(top.remove("meshes"), "meshes")?, &binary, &mut imported.diagnostics)?;
    let mut nodes = completed(top.remove("nodes"), "nodes", &value(&Node::default())?)?;
    meshes.rename(&mut nodes)?;
    imported.render =
        top.remove("render").map(|render| read(render, "render")).transpose()?.unwrap_or_default();
    imported.variants = read(top.remove("variants").unwrap_or_else(|| json!([])), "variants")?;
    imported.scene = Scene {
        nodes,
        meshes: meshes.scene,
        images: images(top.remove("images"), &binary, request, &mut imported.files)?,
        materials: completed(top.remove("materials"), "materials", &value(&Material::default())?)?,
        textures: completed(top.remove("textures"), "textures", &texture()?)?,
        lights: completed(
            top.remove("lights"),
            "lights",
            &json!({ "name": "", "color": [1.0, 1.0, 1.0], "kind": null }),
        )?,
        cameras: completed(
            top.remove("cameras"),
            "cameras",
            &json!({ "name": "", "projection": null, "aspect": null, "exposure": 1.0 }),
        )?,
        roots: read(top.remove("roots").unwrap_or_else(|| json!([])), "roots")?,
    };
    match top.keys().next() {
        Some(key) => Err(unknown(key)),
        None => Ok(imported),
    }
}

fn unknown(element: &str) -> Diagnostic {
    Diagnostic::error("is no key of an Ajar scene").element(element)
}

/// A default as JSON.
fn value<T: serde::Serialize>(default: &T) -> Result<Value, Diagnostic> {
    serde_json::to_value(default).map_err(|e| Diagnostic::error(e.to_string()))
}

fn texture() -> Result<Value, Diagnostic> {
    let mut default = value(&Texture::new(Id::new(0)))?;
    default["image"] = Value::Null;
    Ok(default)
}

/// Reads a value, with the path of what does not fit.
pub(super) fn read<T: DeserializeOwned>(value: Value, element: &str) -> Result<T, Diagnostic> {
    // To follow the path costs more than to read, so only what does not fit is read with it.
    if let Ok(fitting) = T::deserialize(&value) {
        return Ok(fitting);
    }
    serde_path_to_error::deserialize(value).map_err(|e| {
        let path = e.path().to_string();
        let place = match path.as_str() {
            "." => element.to_owned(),
            _ if path.starts_with('[') => format!("{element}{path}"),
            _ => format!("{element}.{path}"),
        };
        Diagnostic::error(e.into_inner().to_string()).element(place)
    })
}

/// The items of a list.
fn list(given: Option<Value>, element: &str) -> Result<Vec<Value>, Diagnostic> {
    match given {
        None => Ok(Vec::new()),
        Some(Value::Array(items)) => Ok(items),
        Some(given) => read(given, element),
    }
}

/// A list whose items may leave out what `default` says.
fn completed<T: DeserializeOwned>(
    given: Option<Value>,
    element: &str,
    default: &Value,
) -> Result<Arena<T>, Diagnostic> {
    let item = |(i, given): (usize, Value)| {
        let (element, mut item) = (format!("{element}[{i}]"), default.clone());
        overlay(&mut item, given, &element)?;
        read(item, &element)
    };
    list(given, element)?.into_iter().enumerate().map(item).collect()
}

/// Puts what is given over a default. A material's input may be written as its value alone.
fn overlay(default: &mut Value, given: Value, element: &str) -> Result<(), Diagnostic> {
    let Value::Object(members) = default else {
        *default = given;
        return Ok(());
    };
    match (given, members.get_mut("value")) {
        (Value::Object(given), _) => given.into_iter().try_for_each(|(key, given)| {
            let element = format!("{element}.{key}");
            let default = members.get_mut(&key).ok_or_else(|| unknown(&element))?;
            overlay(default, given, &element)
        }),
        (given, Some(value)) => {
            *value = given;
            Ok(())
        }
        _ => Err(Diagnostic::error("an object is needed").element(element)),
    }
}

fn images(
    given: Option<Value>,
    binary: &Binary,
    request: &ImportRequest,
    files: &mut Vec<PathBuf>,
) -> Result<Arena<Image>, Diagnostic> {
    let image = |(i, form): (usize, Value)| {
        let element = format!("images[{i}]");
        let form: ImageForm = read(form, &element)?;
        let source = match (form.file, form.bytes) {
            (Some(file), None) => {
                let path = request.resolve(&file).map_err(|e| e.element(&element))?;
                files.push(path.clone());
                ImageSource::File(path)
            }
            (None, Some(bytes)) => {
                ImageSource::Embedded(binary.array::<u8>(bytes, &element)?.into_owned().into())
            }
            _ => return Err(Diagnostic::error("either \"file\" or \"bytes\" is needed").element(element)),
        };
        Ok(Image { name: form.name, source })
    };
    list(given, "images")?.into_iter().enumerate().map(image).collect()
}
