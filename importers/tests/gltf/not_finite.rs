//! Numbers that are none: JSON has only those too large for a float, buffers have all. Each is an error with the path of its
//! element, or a repair that is told with it.

use ajar_scene::{AlphaMode, Scene, Severity};
use serde_json::{Value, json};

use crate::{build::Asset, failure, warnings};

/// What a float cannot hold.
const HUGE: f64 = 1e39;

/// A triangle with a material, two cameras and three lights.
fn asset() -> Asset {
    let mut asset = Asset::with_material(json!({
        "alphaMode": "MASK", "alphaCutoff": 0.5, "emissiveFactor": [1, 1, 1],
        "pbrMetallicRoughness": {"baseColorTexture": {
            "index": 0, "extensions": {"KHR_texture_transform": {"offset": [0, 0], "scale": [1, 1]}},
        }},
        "extensions": {"KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 1}},
    }));
    asset.json["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 2, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 10}},
    ]);
    asset.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "color": [1, 1, 1], "intensity": 1, "spot": {"innerConeAngle": 0, "outerConeAngle": 1}},
        {"type": "directional", "intensity": 1},
    ]}});
    for light in [0, 1] {
        asset
            .push("nodes", json!({"camera": light, "extensions": {"KHR_lights_punctual": {"light": light}}}));
    }
    asset
}

fn with(pointer: &str, value: Value) -> Asset {
    let mut asset = asset();
    *asset.json.pointer_mut(pointer).unwrap() = value;
    asset
}

fn sound(scene: &Scene) -> bool {
    scene.validate().iter().all(|found| found.severity < Severity::Error)
}

#[test]
fn in_the_json_they_are_told() {
    assert_eq!(warnings(&asset().import().unwrap()), Vec::<String>::new());
    let light = "/extensions/KHR_lights_punctual/lights/0";
    for (pointer, element) in [
        ("/cameras/0/perspective/yfov", "cameras[0]: the camera is dropped"),
        ("/cameras/0/perspective/aspectRatio", "cameras[0]: its width over its height is impossible"),
        ("/cameras/1/orthographic/xmag", "cameras[1]: its width over its height is impossible"),
        ("/cameras/1/orthographic/ymag", "cameras[1]: the camera is dropped"),
        (&format!("{light}/intensity"), "extensions.KHR_lights_punctual.lights[0]: the light is dropped"),
        (&format!("{light}/color/1"), "extensions.KHR_lights_punctual.lights[0]: the light is dropped"),
        (
            &format!("{light}/spot/outerConeAngle"),
            "extensions.KHR_lights_punctual.lights[0].spot: the cone's angles",
        ),
        (
            &format!("{light}/spot/innerConeAngle"),
            "extensions.KHR_lights_punctual.lights[0].spot: the cone's angles",
        ),
        ("/materials/0/alphaCutoff", "materials[0].alphaCutoff: the cutoff is not finite"),
        (
            "/materials/0/emissiveFactor/0",
            "materials[0].emissiveFactor: the emission is negative or not finite",
        ),
        (
            "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/scale/0",
            "materials[0].pbrMetallicRoughness.baseColorTexture: the texture transform is not finite",
        ),
    ] {
        let imported = with(pointer, json!(HUGE)).import().unwrap();
        let said = warnings(&imported);
        assert!(said.len() == 1 && said[0].starts_with(element), "{pointer}: {said:?}");
        assert!(sound(&imported.scene), "{pointer}");
    }
    let imported = with("/materials/0/alphaCutoff", json!(-HUGE)).import().unwrap();
    assert_eq!(imported.scene.materials.iter().next().unwrap().alpha_mode, AlphaMode::Mask(0.5));
}

#[test]
fn in_transforms_they_are_errors() {
    for (key, value) in [
        ("translation", json!([0, HUGE, 0])),
        ("scale", json!([-HUGE, 1, 1])),
        ("rotation", json!([0, 0, HUGE, 1])),
        ("matrix", json!([HUGE, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])),
    ] {
        let mut asset = asset();
        asset.json["nodes"][0][key] = value;
        assert_eq!(failure(&asset), ("nodes[0]".into(), "the transform is not finite".into()), "{key}");
    }
}

#[test]
fn in_buffers_they_are_errors_or_told() {
    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut asset = Asset::new();
        asset.positions(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, wrong, 0.0]]);
        asset.primitive(json!({}));
        let element = "meshes[0].primitives[0].attributes.POSITION[2]".to_owned();
        assert_eq!(failure(&asset), (element, "the position is not finite".into()));

        let mut asset = Asset::triangle(json!({}));
        let normals = asset.float_accessor("VEC3", 3, &[0.0, 0.0, 1.0, wrong, 0.0, 1.0, 0.0, 0.0, 1.0]);
        let uvs = asset.float_accessor("VEC2", 2, &[0.0, 0.0, 1.0, 0.0, 0.0, wrong]);
        asset.attribute("NORMAL", normals);
        asset.attribute("TEXCOORD_0", uvs);
        let imported = asset.import().unwrap();
        let said = warnings(&imported);
        assert!(
            said.iter().any(|it| it.contains("attributes.NORMAL: normals are zero or not finite")),
            "{said:?}"
        );
        assert!(
            said.iter().any(|it| it.contains("attributes.TEXCOORD_0: texture coordinates that")),
            "{said:?}"
        );
        assert!(sound(&imported.scene));
    }
}

/// Bounds that a file states are not trusted: whatever they say, the vertices count.
#[test]
fn bounds_of_accessors_change_nothing() {
    let wanted = Asset::triangle(json!({})).import().unwrap().scene;
    for bounds in [json!([HUGE, -HUGE, 0]), json!([null, null, null]), json!("x"), json!([])] {
        let mut asset = Asset::triangle(json!({}));
        asset.json["accessors"][0]["min"] = bounds.clone();
        asset.json["accessors"][0]["max"] = bounds;
        assert_eq!(asset.import().unwrap().scene.content_hash(), wanted.content_hash());
    }
}

/// Literals that JSON has not are errors with line and column.
#[test]
fn literals_are_no_json() {
    for literal in ["NaN", "Infinity", "-Infinity", "1e999", "nan"] {
        let text = format!(
            "{{\"asset\": {{\"version\": \"2.0\"}},\n\"nodes\": [{{\"scale\": [1, 1, {literal}]}}]}}"
        );
        let error = crate::build::import_files(&[("a.gltf", text.as_bytes())]).map(drop).unwrap_err();
        assert!(error.message.starts_with("not valid JSON"), "{literal}: {error}");
        assert_eq!(error.place.map(|(line, _)| line), Some(2), "{literal}: {error}");
    }
}
