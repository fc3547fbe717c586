//! Variants and instances.

use ajar_scene::{Cause, Choice, Imported};
use glam::DVec3;
use serde_json::json;

use crate::{
    assets::{load_as, shared},
    build::Asset,
    failure, messages, warnings,
};

fn chosen(names: &[&str]) -> Choice {
    Choice { variants: names.iter().map(|name| name.to_string()).collect(), ..Choice::default() }
}

/// A triangle that is plain, red in one variant and blue in two others.
fn colorful() -> Asset {
    let mappings = json!([{"material": 1, "variants": [0]}, {"material": 2, "variants": [1, 2]}]);
    let extension = json!({"KHR_materials_variants": {"mappings": mappings}});
    let mut asset = Asset::triangle(json!({"material": 0, "extensions": extension}));
    asset.json["materials"] = json!([{"name": "plain"}, {"name": "red"}, {"name": "blue"}]);
    let names = json!({"variants": [{"name": "Fire"}, {"name": "Sky"}, {"name": "Sea"}, {"name": "Air"}]});
    asset.json["extensions"] = json!({"KHR_materials_variants": names});
    asset.json["extensionsRequired"] = json!(["KHR_materials_variants"]);
    asset
}

fn material(imported: &Imported) -> String {
    let mesh = imported.scene.meshes.iter().next().unwrap();
    imported.scene.materials[mesh.material.unwrap()].name.clone()
}

#[test]
fn variants_choose_materials() {
    for (names, expected) in [
        (&[][..], "plain"),
        (&["Fire"], "red"),
        (&["Sky"], "blue"),
        (&["Sea"], "blue"),
        (&["Air"], "plain"),
        (&["Air", "Fire"], "red"),
        (&["Sea", "Fire"], "blue"),
    ] {
        let imported = colorful().import_as(&chosen(names)).unwrap();
        assert_eq!(material(&imported), expected, "{names:?}");
        assert_eq!(warnings(&imported), [""; 0]);
    }
    let said = messages(&colorful().import().unwrap(), ajar_scene::Severity::Note);
    assert!(said[0].contains("Fire, Sky, Sea, Air"), "{said:?}");
}

#[test]
fn unknown_variants_are_errors_that_name_the_known_ones() {
    let error = colorful().import_as(&chosen(&["fire"])).map(|_| ()).unwrap_err();
    assert_eq!((error.cause, error.message.as_str()), (Cause::Usage, "there is no variant \"fire\""));
    assert_eq!(error.hint.as_deref(), Some("variants: Fire, Sky, Sea, Air"));
    let none = Asset::triangle(json!({})).import_as(&chosen(&["Fire"])).map(|_| ()).unwrap_err();
    assert_eq!(none.hint.as_deref(), Some("the file has none"));
    let mut asset = colorful();
    asset.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"][0]["material"] =
        json!(9);
    let error = asset.import_as(&chosen(&["Fire"])).map(|_| ()).unwrap_err();
    assert_eq!(error.message, "points to materials[9], but there are only 3");
}

#[test]
fn a_real_file_changes_with_its_variants() {
    let Some(assets) = shared() else { return };
    let path = assets.join("gltf/blender_18_variants/18_variants.gltf");
    let hint = load_as(&path, &chosen(&["?"])).map(|_| ()).unwrap_err().hint.unwrap();
    let names: Vec<_> = hint.strip_prefix("variants: ").unwrap().split(", ").collect();
    let looks = |names: &[&str]| {
        let imported = load_as(&path, &chosen(names)).unwrap();
        imported.scene.meshes.iter().map(|mesh| mesh.material).collect::<Vec<_>>()
    };
    assert!(names.len() > 1 && looks(&names[..1]) != looks(&names[1..2]), "{names:?}");
}

/// A node at (10, 0, 0) with three instances.
fn instanced() -> Asset {
    let mut asset = Asset::triangle(json!({}));
    let places = asset.float_accessor("VEC3", 3, &[1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 0.0, 0.0]);
    let turns: Vec<u8> =
        [[0i8, 0, 0, 127], [0, 0, 90, 90], [0, 0, 127, 0]].concat().iter().map(|x| *x as u8).collect();
    let turns = asset.accessor(crate::build::BYTE, "VEC4", 3, &turns, json!({"normalized": true}));
    let sizes = asset.float_accessor("VEC3", 3, &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0]);
    let attributes = json!({"TRANSLATION": places, "ROTATION": turns, "SCALE": sizes, "_ID": sizes});
    asset.json["nodes"] = json!([
        {"name": "tree", "mesh": 0, "translation": [10, 0, 0],
         "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}},
        {"name": "rock", "mesh": 0},
    ]);
    asset.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    asset
}

#[test]
fn instances_lie_below_their_node() {
    let imported = instanced().import().unwrap();
    assert_eq!(warnings(&imported), [""; 0]);
    let placed = imported.scene.placed();
    let shown: Vec<_> = placed.iter().filter(|placed| !placed.node.meshes.is_empty()).collect();
    let names: Vec<_> = shown.iter().map(|placed| placed.node.name.as_str()).collect();
    assert_eq!(names, ["tree[0]", "tree[1]", "tree[2]", "rock"]);
    let ends = [[12.0, 0.0], [12.0, 2.0], [10.0, 0.0], [1.0, 0.0]];
    for (placed, [x, y]) in shown.iter().zip(ends) {
        let found = placed.world.transform_point3(DVec3::X);
        assert!(found.abs_diff_eq(DVec3::new(x, y, 0.0), 1e-6), "{found}");
    }
    assert_eq!(imported.scene.meshes.len(), 1);
}

#[test]
fn broken_instances_are_errors() {
    let attributes = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes";
    let mut asset = instanced();
    let one = asset.float_accessor("VEC3", 3, &[1.0; 3]);
    asset.json.pointer_mut(attributes).unwrap()["SCALE"] = json!(one);
    assert!(failure(&asset).1.contains("not the same number"));
    let many =
        asset.push("accessors", json!({"componentType": 5126, "type": "VEC3", "count": 4_000_000_000u32}));
    *asset.json.pointer_mut(attributes).unwrap() = json!({"TRANSLATION": many});
    assert!(failure(&asset).1.starts_with("needs more memory"));
    let infinite = asset.float_accessor("VEC3", 3, &[f32::INFINITY, 0.0, 0.0]);
    *asset.json.pointer_mut(attributes).unwrap() = json!({"TRANSLATION": infinite});
    assert_eq!(failure(&asset).1, "the transform of instance 0 is not finite");
    *asset.json.pointer_mut(attributes).unwrap() = json!({"_ID": infinite});
    assert!(warnings(&asset.import().unwrap())[0].contains("no attribute places the instances"));
}
