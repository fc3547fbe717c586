//! Primitives compressed by Draco.

use std::fs;

use ajar_importers::gltf::Gltf;
use ajar_scene::{Choice, ImportRequest, Importer};
use base64::{Engine, prelude::BASE64_STANDARD};
use glam::{Vec2, Vec3};
use serde_json::{Value, json};

use crate::{
    assets::{load_as, shared},
    build::{Asset, FLOAT, UNSIGNED_SHORT},
    failure, only_mesh, warnings,
};

const NAME: &str = "KHR_draco_mesh_compression";

/// Two triangles of four corners, a unit square with one corner raised to z = 2, by Google's encoder: texture
/// coordinates are attribute 0, positions of 12 bits attribute 1.
const SQUARE: &str = "RFJBQ08CAgEBAAAABAIBAgAAAR//ARH/ARECAAAA/wAAAQMJAgEAAAEACQMAAQIAAAAAAAAAAAAAgD8AAIA/AAAAAAAAgD8A\
AIA/AAAAAAEBAQANAwEgJwEgAwDwg/j//weA/weAAAAAAAAA/w8AAAAAAAAAAAAAAAAAAAAAAEAM";

/// The square, with these changes to the extension.
fn square(change: impl Fn(&mut Value)) -> Asset {
    let mut asset = Asset::new();
    let view = asset.view(&BASE64_STANDARD.decode(SQUARE).unwrap(), json!({}));
    for (component, kind, count) in [(FLOAT, "VEC3", 4), (FLOAT, "VEC2", 4), (UNSIGNED_SHORT, "SCALAR", 6)] {
        asset.push("accessors", json!({"componentType": component, "type": kind, "count": count}));
    }
    let mut extension = json!({"bufferView": view, "attributes": {"POSITION": 1, "TEXCOORD_0": 0}});
    change(&mut extension);
    asset.primitive(json!({"indices": 2, "extensions": {NAME: extension}}));
    asset.attribute("TEXCOORD_0", 1);
    asset.json["extensionsRequired"] = json!([NAME]);
    asset
}

#[test]
fn vertices_and_triangles_are_decoded() {
    let mesh = only_mesh(&square(|_| {}));
    let area: f32 = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            (b - a).cross(c - a).length() / 2.0
        })
        .sum();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 2));
    // A flat triangle of half a square and one with its corner at (0, 1, 2).
    let raised = (Vec3::new(1.0, 1.0, 0.0).cross(Vec3::new(0.0, 1.0, 2.0)).length() + 1.0) / 2.0;
    assert!((area - raised).abs() < 2e-3, "{area} {raised}");
    for (position, uv) in mesh.positions.iter().zip(&mesh.uvs[0]) {
        assert!((position.truncate() - *uv).length() < 1e-3, "{position} {uv}");
    }
    assert!(mesh.uvs[0].contains(&Vec2::ONE));
}

#[test]
fn broken_streams_are_errors_unless_there_is_a_fallback() {
    let element = format!("meshes[0].primitives[0].extensions.{NAME}");
    let missing = failure(&square(|extension| extension["attributes"]["POSITION"] = json!(7)));
    assert_eq!(missing, (element.clone(), "the stream has no attribute 7 for POSITION".into()));
    let mut broken = square(|_| {});
    broken.data[5] = 9;
    let (at, why) = failure(&broken);
    assert!(at == element && why.starts_with("the Draco stream is broken"), "{at}: {why}");
    assert!(failure(&square(|extension| extension["bufferView"] = json!(8))).1.contains("bufferViews[8]"));

    let positions = broken.positions(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    broken.json["accessors"][0] = broken.json["accessors"][positions].clone();
    let primitive = &mut broken.json["meshes"][0]["primitives"][0];
    primitive["indices"].take();
    primitive["attributes"].as_object_mut().unwrap().remove("TEXCOORD_0");
    primitive.as_object_mut().unwrap().remove("indices");
    let imported = broken.import().unwrap();
    let said = warnings(&imported);
    assert!(said.iter().any(|warning| warning.contains("fallback is used")), "{said:?}");
    assert_eq!(imported.scene.meshes.iter().next().unwrap().positions.len(), 3);
}

#[test]
fn a_real_box_is_a_box() {
    let Some(assets) = shared() else { return };
    let imported = load_as(&assets.join("gltf/Box_Draco/Box_Draco.glb"), &Choice::default()).unwrap();
    assert_eq!(warnings(&imported), [""; 0]);
    let mesh = imported.scene.meshes.iter().next().unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (24, 12));
    let normals = mesh.normals.as_ref().unwrap();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        let geometric = (b - a).cross(c - a).normalize();
        assert!(triangle.iter().all(|&i| normals[i as usize].abs_diff_eq(geometric, 0.02)));
    }
}

#[test]
fn damaged_streams_never_stop_the_program() {
    let whole = square(|_| {});
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.gltf");
    for at in 0..129 {
        for value in [0, 1, 0x7f, 0xff, whole.data[at] ^ 0x10] {
            let mut damaged = square(|_| {});
            damaged.data[at] = value;
            fs::write(&path, damaged.text()).unwrap();
            if let Ok(imported) = Gltf.import(&ImportRequest::new(&path)) {
                let meshes = imported.scene.meshes.iter();
                assert!(meshes.flat_map(|mesh| &mesh.positions).all(|p| p.is_finite()));
            }
        }
    }
}
