//! Files, containers, versions, extensions.

use std::path::Path;

use ajar_importers::{find, import, importers};
use ajar_scene::ImportRequest;
use serde_json::json;

use crate::{
    build::{Asset, data_uri, import_files},
    failure, parts, warnings,
};

#[test]
fn syntax_errors_have_line_and_column() {
    let error = import_files(&[("a.gltf", b"{\n  \"asset\": {\"version\": \"2.0\"},\n  \"nodes\": [,]\n}")])
        .unwrap_err();
    assert_eq!(error.place, Some((3, 13)));
    assert_eq!(error.message, "not valid JSON: expected value");
    assert!(error.to_string().contains("a.gltf:3:13: error: not valid JSON"));
    let (_, message) = parts(import_files(&[("a.gltf", b"")]).unwrap_err());
    assert_eq!(message, "the file is empty");
    let (_, message) = parts(import_files(&[("a.gltf", b"[]")]).unwrap_err());
    assert_eq!(message, "not a glTF document: the JSON is not an object");
}

#[test]
fn deep_nesting_is_an_error() {
    let deep = format!("{{\"extras\": {}", "[".repeat(100_000));
    assert!(import_files(&[("a.gltf", deep.as_bytes())]).unwrap_err().message.contains("recursion limit"));
}

#[test]
fn wrong_types_have_a_path() {
    let mut asset = Asset::triangle(json!({}));
    asset.json["meshes"][0]["primitives"][0]["indices"] = json!("none");
    let (element, message) = failure(&asset);
    assert_eq!(element, "meshes[0].primitives[0].indices");
    assert!(message.starts_with("invalid type: string \"none\""), "{message}");
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let text = ["\u{feff}".as_bytes(), &Asset::triangle(json!({})).text()].concat();
    assert_eq!(import_files(&[("a.gltf", &text)]).unwrap().scene.meshes.len(), 1);
}

#[test]
fn versions() {
    for (asset, element) in [
        (json!({"version": "1.0"}), "asset.version"),
        (json!({"version": "3.0"}), "asset.version"),
        (json!({"version": "2.1", "minVersion": "2.1"}), "asset.minVersion"),
        (json!({"version": 2}), "asset"),
        (json!({}), "asset"),
    ] {
        let mut document = Asset::new();
        document.json["asset"] = asset;
        assert_eq!(failure(&document).0, element);
    }
    let mut document = Asset::triangle(json!({}));
    document.json["asset"] = json!({"version": "2.1"});
    assert!(document.import().is_ok());
}

#[test]
fn binary_files_give_the_same_scene_whatever_they_are_called() {
    let asset = Asset::triangle(json!({}));
    let text = asset.import().unwrap();
    for name in ["a.glb", "a.GLTF", "a.bin"] {
        let binary = import_files(&[(name, &asset.glb())]).unwrap();
        assert_eq!(binary.scene, text.scene);
        assert!(binary.diagnostics.is_empty());
    }
    assert_eq!(import_files(&[("a.json", &asset.text())]).unwrap().scene, text.scene);
}

#[test]
fn broken_containers_are_errors() {
    let file = Asset::triangle(json!({})).glb();
    let json_length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let changed = |at: usize, bytes: &[u8]| {
        let mut file = file.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        import_files(&[("a.glb", &file)]).map(|_| ()).unwrap_err().message
    };
    assert!(changed(4, &[1]).contains("version 1, only 2 is known"));
    assert!(changed(8, &[0xff, 0xff]).contains("bytes announced"));
    assert!(changed(12, &[0xff; 4]).contains("a chunk of 4294967295 bytes reaches beyond the end"));
    assert!(changed(16, b"BIN\0").contains("the first chunk is not JSON"));
    // Without its binary chunk the buffer has no source.
    assert!(changed(20 + json_length + 4, b"ABCD").contains("neither URI nor binary chunk"));
    for length in (0..file.len()).step_by(7) {
        assert!(import_files(&[("a.glb", &file[..length])]).is_err(), "{length}");
    }
    let longer = [&file[..], b"more"].concat();
    let imported = import_files(&[("a.glb", &longer)]).unwrap();
    assert_eq!(warnings(&imported), ["-: 4 bytes after the end of the GLB are ignored"]);
}

#[test]
fn buffers_come_from_percent_encoded_files_and_unpadded_base64() {
    let asset = Asset::triangle(json!({}));
    let expected = asset.import().unwrap().scene;
    let mut document = asset.json.clone();
    document["buffers"] = json!([{"byteLength": 36, "uri": "my%20data.bin"}]);
    let text = serde_json::to_vec(&document).unwrap();
    let imported = import_files(&[("a.gltf", &text), ("my data.bin", &asset.data)]).unwrap();
    assert_eq!(imported.scene, expected);
    let names: Vec<_> = imported.files.iter().filter_map(|path| path.file_name()?.to_str()).collect();
    assert_eq!(names, ["a.gltf", "my data.bin"]);

    let longer = [&asset.data[..], &[0, 0]].concat();
    document["buffers"][0]["uri"] = json!(data_uri(&longer).trim_end_matches('='));
    let text = serde_json::to_vec(&document).unwrap();
    assert_eq!(import_files(&[("a.gltf", &text)]).unwrap().scene, expected);
}

#[test]
fn missing_and_short_buffers_are_errors_if_they_are_used() {
    let asset = Asset::triangle(json!({}));
    for (buffer, element, message) in [
        (json!({"byteLength": 36, "uri": "no.bin"}), "buffers[0].uri", "\"no.bin\" cannot be read"),
        (json!({"byteLength": 36}), "buffers[0]", "neither URI nor binary chunk"),
        (json!({"byteLength": 36, "uri": "../up.bin"}), "buffers[0].uri", "\"../up.bin\" "),
        (json!({"byteLength": 36, "uri": "http://a/b.bin"}), "buffers[0].uri", "is a URL"),
        (json!({"byteLength": 36, "uri": "data:,abc"}), "buffers[0].uri", "is not base64"),
        (json!({"byteLength": 36, "uri": data_uri(&asset.data[..35])}), "buffers[0]", "35 of 36 bytes"),
        (
            json!({"byteLength": u64::MAX, "uri": data_uri(&asset.data)}),
            "buffers[0]",
            "36 of 18446744073709551615",
        ),
        (
            json!({"byteLength": 35, "uri": data_uri(&asset.data)}),
            "bufferViews[0]",
            "beyond buffers[0] of 35 bytes",
        ),
        (json!({"byteLength": 36, "uri": "."}), "buffers[0].uri", "is not a file"),
    ] {
        let mut document = asset.json.clone();
        document["buffers"] = json!([buffer]);
        let error = import_files(&[("a.gltf", &serde_json::to_vec(&document).unwrap())]).unwrap_err();
        let (found, text) = parts(error);
        assert!(found == element && text.contains(message), "{found}: {text}");
    }
    let document =
        json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 1, "uri": "no.bin"}], "nodes": [{}]});
    let imported = import_files(&[("a.gltf", &serde_json::to_vec(&document).unwrap())]).unwrap();
    assert!(warnings(&imported)[0].starts_with("buffers[0].uri: \"no.bin\" cannot be read"));
    assert!(imported.files.iter().any(|path| path.ends_with("no.bin")));
}

#[test]
fn the_memory_limit_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let text = Asset::triangle(json!({})).text();
    std::fs::write(&path, &text).unwrap();
    let with =
        |memory_limit| import(&ImportRequest { memory_limit, ..ImportRequest::new(&path) }).map(|_| ());
    assert!(
        with(text.len() as u64 - 1).unwrap_err().message.starts_with("needs more memory than the limit of ")
    );
    assert!(with(text.len() as u64 + 10).is_err());
    assert!(with(text.len() as u64 + 100_000).is_ok());
}

#[test]
fn required_extensions_must_be_supported() {
    let mut asset = Asset::triangle(json!({}));
    asset.json["extensionsRequired"] = json!(["KHR_mesh_quantization", "KHR_materials_volume_scatter"]);
    let (element, message) = failure(&asset);
    assert_eq!(element, "extensionsRequired[1]");
    assert_eq!(message, "the file requires KHR_materials_volume_scatter, which is not supported");
    for feature in importers()[0].features().iter().filter(|feature| feature.name.contains('_')) {
        asset.json["extensionsRequired"] = json!([feature.name]);
        assert!(asset.import().is_ok(), "{}", feature.name);
    }
}

#[test]
fn unsupported_extensions_are_named_once_with_what_is_lost() {
    let mut asset = Asset::with_material(json!({"extensions": {"KHR_materials_coat": {}}}));
    asset.push("materials", json!({"extensions": {"KHR_materials_coat": {}, "ACME_glow": {}}}));
    asset.json["extensionsUsed"] = json!(["KHR_materials_coat", "MSFT_lod", "KHR_materials_unlit"]);
    asset.json["extras"] = json!({"extensions": {"NOT_ONE": {}}});
    assert_eq!(
        warnings(&asset.import().unwrap()),
        [
            "materials[1].extensions.ACME_glow: ACME_glow is not supported: what it adds is missing",
            "materials[0].extensions.KHR_materials_coat: KHR_materials_coat is not supported: its coat is missing",
            "extensionsUsed[1]: MSFT_lod is not supported: the first level of detail is shown",
        ]
    );
}

#[test]
fn files_are_found_by_extension_then_by_content() {
    assert_eq!(find(Path::new("nowhere/a.GLB")).unwrap().name(), "gltf");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    std::fs::write(&path, "  {\"accessors\": [").unwrap();
    assert_eq!(find(&path).unwrap().name(), "gltf");
    std::fs::write(&path, "some text").unwrap();
    let Err(error) = find(&path) else { panic!("it was recognized") };
    assert_eq!(error.message, "is of no known format");
    assert!(error.hint.unwrap().contains(".gltf, .glb"));
    let Err(error) = find(&folder.path().join("absent.xyz")) else { panic!("it was recognized") };
    assert!(error.message.starts_with("cannot be read"));
    let (_, message) = parts(import(&ImportRequest::new(folder.path().join("absent.glb"))).unwrap_err());
    assert!(message.starts_with("cannot be read"), "{message}");
}
