//! What of glTF is supported, and what becomes of a file that uses more.

use std::collections::BTreeMap;

use ajar_scene::{Diagnostic, Feature};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::report::Report;

/// The support table.
pub const FEATURES: &[Feature] = &[
    Feature { name: "containers", support: "GLB, external buffers and images, data URIs" },
    Feature { name: "accessors", support: "all component types, strides, normalized, sparse" },
    Feature { name: "triangles", support: "lists, strips and fans; points and lines are dropped" },
    Feature {
        name: "materials",
        support: "metallic-roughness, normal maps, emission, alpha; occlusion is ignored",
    },
    Feature { name: "textures", support: "PNG, JPEG, WebP, KTX2; all wrapping modes and sets" },
    Feature { name: "cameras", support: "perspective, orthographic; clipping planes are ignored" },
    Feature { name: "scenes", support: "the default scene, else the first, else all nodes" },
    Feature {
        name: "animations",
        support: "at a moment, all interpolations; of several that move the same thing the first counts",
    },
    Feature {
        name: "skins, morph targets",
        support: "full, but morph targets of texture coordinates and colours",
    },
    Feature {
        name: "EXT_lights_image_based",
        support: "the sharpest level of the cube, PNG (RGBD) or JPEG; the rest follows from it",
    },
    Feature { name: "EXT_mesh_gpu_instancing", support: "full; attributes of applications are ignored" },
    Feature { name: "EXT_meshopt_compression", support: "full" },
    Feature { name: "EXT_texture_webp", support: "full" },
    Feature {
        name: "KHR_animation_pointer",
        support: "nodes, visibility, materials, lights, cameras, morph weights; others are dropped",
    },
    Feature { name: "KHR_lights_punctual", support: "full, but range is ignored" },
    Feature { name: "KHR_draco_mesh_compression", support: "full" },
    Feature { name: "KHR_materials_anisotropy", support: "full" },
    Feature { name: "KHR_materials_clearcoat", support: "full" },
    Feature { name: "KHR_materials_diffuse_transmission", support: "full" },
    Feature { name: "KHR_materials_dispersion", support: "red, green and blue have an index each" },
    Feature { name: "KHR_materials_emissive_strength", support: "full" },
    Feature { name: "KHR_materials_ior", support: "full; the special value 0 is approximated" },
    Feature { name: "KHR_materials_iridescence", support: "full" },
    Feature {
        name: "KHR_materials_pbrSpecularGlossiness",
        support: "full; reflection towards grazing is Schlick's where the specular texture is dark",
    },
    Feature { name: "KHR_materials_sheen", support: "full" },
    Feature { name: "KHR_materials_specular", support: "full" },
    Feature { name: "KHR_materials_transmission", support: "full" },
    Feature { name: "KHR_materials_unlit", support: "full" },
    Feature { name: "KHR_materials_variants", support: "full: --variant NAME, or variant = in a scene file" },
    Feature {
        name: "KHR_materials_volume",
        support: "full; the thickness texture is ignored, as is meant for ray tracers",
    },
    Feature { name: "KHR_mesh_quantization", support: "full" },
    Feature { name: "KHR_node_visibility", support: "full" },
    Feature { name: "KHR_texture_basisu", support: "ETC1S, UASTC, ASTC; the first level of the first image" },
    Feature { name: "KHR_texture_transform", support: "full" },
    Feature { name: "KHR_xmp_json_ld", support: "metadata are ignored" },
];

/// What is lost with extensions that are not supported, for the message.
const LOSSES: [(&str, &str); 13] = [
    ("GOOGLE_texture_basis", "its textures are dropped"),
    ("KHR_materials_coat", "its coat is missing"),
    ("KHR_materials_diffuse_roughness", "diffuse reflection is Lambert's"),
    ("KHR_materials_volume_scatter", "nothing is scattered inside volumes"),
    ("KHR_meshopt_compression", "the uncompressed fallback is read where there is one"),
    ("KHR_physics_rigid_bodies", "its physics is ignored"),
    ("KHR_implicit_shapes", "its shapes are missing"),
    ("KHR_audio_emitter", "it is silent"),
    ("KHR_gaussian_splatting", "its splats are missing"),
    ("KHR_techniques_webgl", "the core materials are shown"),
    ("MSFT_lod", "the first level of detail is shown"),
    ("MSFT_texture_dds", "the fallback images are shown where there are any"),
    ("VRMC_vrm", "what it adds is missing"),
];

fn is_supported(name: &str) -> bool {
    FEATURES.iter().any(|feature| feature.name == name)
}

/// Warns about extensions of the document that are not supported, each once with the place where it first occurs.
///
/// # Errors
/// One of them is required.
pub(super) fn check(document: &Map<String, Value>, report: &mut Report) -> Result<(), Diagnostic> {
    let names = |list: &str| {
        let list = document.get(list).and_then(Value::as_array).into_iter().flatten();
        list.filter_map(Value::as_str).map(str::to_string)
    };
    let mut required = names("extensionsRequired").enumerate();
    if let Some((i, name)) = required.find(|(_, name)| !is_supported(name)) {
        return Err(Diagnostic::error(format!(
            "the file requires {}, which is not supported",
            name.escape_debug()
        ))
        .element(format!("extensionsRequired[{i}]"))
        .hint("export the file without this extension"));
    }
    let mut used = BTreeMap::new();
    for (key, value) in document.iter().filter(|(key, _)| *key != "extras") {
        find(value, key.clone(), &mut used);
    }
    if let Some(value) = document.get("extensions") {
        note_names(value, "", &mut used);
    }
    for (i, name) in names("extensionsUsed").enumerate() {
        used.entry(name).or_insert_with(|| format!("extensionsUsed[{i}]"));
    }
    for (name, element) in used {
        if !is_supported(&name) {
            let loss = LOSSES.iter().find(|(known, _)| *known == name);
            let loss = loss.map_or("what it adds is missing", |(_, loss)| loss);
            report.warn(element, format!("{} is not supported: {loss}", name.escape_debug()));
        }
    }
    Ok(())
}

/// Collects the keys of all `extensions` objects below `value`. The depth is that of the parser, at most 128.
fn find(value: &Value, path: String, used: &mut BTreeMap<String, String>) {
    match value {
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate().filter(|(_, item)| item.is_object() || item.is_array())
            {
                find(item, format!("{path}[{i}]"), used);
            }
        }
        Value::Object(fields) => {
            for (key, field) in fields.iter().filter(|(key, _)| *key != "extras") {
                if key == "extensions" {
                    note_names(field, &path, used);
                }
                find(field, format!("{path}.{key}"), used);
            }
        }
        _ => {}
    }
}

fn note_names(extensions: &Value, path: &str, used: &mut BTreeMap<String, String>) {
    let dot = if path.is_empty() { "" } else { "." };
    for name in extensions.as_object().into_iter().flat_map(Map::keys) {
        used.entry(name.clone()).or_insert_with(|| format!("{path}{dot}extensions.{name}"));
    }
}

/// The extension `name` of the element at `element`; one that cannot be read is ignored with a warning.
pub(super) fn read<T: DeserializeOwned>(
    extensions: Option<&Map<String, Value>>,
    name: &str,
    element: &str,
    report: &mut Report,
) -> Option<T> {
    let value = extensions?.get(name)?;
    serde_path_to_error::deserialize(value)
        .map_err(|error| {
            let element = below(&format!("{element}.extensions.{name}"), error.path());
            report.warn(element, format!("the extension is ignored: {}", error.inner()));
        })
        .ok()
}

/// The element at `path` below the one at `element`.
pub(super) fn below(element: &str, path: &serde_path_to_error::Path) -> String {
    if path.iter().len() == 0 { element.to_string() } else { format!("{element}.{path}") }
}
