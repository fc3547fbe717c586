//! Scenes that nobody should write.

use ajar_importers::ajar::write;
use ajar_scene::{Preference, Scene};
use serde_json::json;

use super::{failure, import};

#[test]
fn broken_containers_are_named() {
    let whole = write(&Scene::default(), &Preference::default()).unwrap();
    assert!(import(&whole).is_ok());
    for length in 0..whole.len() {
        assert!(import(&whole[..length]).is_err(), "{length}");
    }
    let changed = |at: usize, byte: u8| {
        let mut bytes = whole.clone();
        bytes[at] = byte;
        import(&bytes).unwrap_err().message
    };
    assert!(changed(4, 2).contains("version 2, only 1 is known"));
    assert!(changed(8, 0).contains("bytes announced"));
    assert!(changed(16, b'X').contains("is not JSON"));
    assert!(import(b"PK\x03\x04").unwrap_err().message.contains("is no Ajar scene"));
}

#[test]
fn wrong_json_is_named_with_its_place() {
    let with = |key: &str, value: serde_json::Value| json!({ "ajar": 1, key: value });
    for (scene, place, says) in [
        (json!({}), "", "the key \"ajar\" is missing"),
        (json!({ "ajar": 2 }), "ajar", "version 2"),
        (with("mesh", json!([])), "mesh", "is no key"),
        (with("nodes", json!({})), "nodes", "invalid type"),
        (with("nodes", json!([{ "meshes": [0] }])), "nodes[0].meshes", "mesh 0 is not there"),
        (with("nodes", json!([{ "children": [-1] }])), "nodes[0].children[0]", "invalid value"),
        (with("materials", json!([{ "rough": 1 }])), "materials[0].rough", "is no key"),
        (with("materials", json!([{ "roughness": "high" }])), "materials[0].roughness.value", "invalid type"),
        (with("images", json!([{ "name": "a" }])), "images[0]", "either \"file\" or \"bytes\""),
        (with("images", json!([{ "file": "../../etc/passwd" }])), "images[0]", "outside the scene's folder"),
        (with("images", json!([{ "file": "/etc/passwd" }])), "images[0]", "outside the scene's folder"),
        (with("images", json!([{ "file": "http://localhost/a.png" }])), "images[0]", "is a URL"),
        (
            with("images", json!([{ "bytes": { "offset": 0, "count": 1 } }])),
            "images[0]",
            "beyond the 0 bytes",
        ),
        (
            with(
                "meshes",
                json!([{ "positions": { "offset": u64::MAX, "count": u64::MAX }, "triangles": [] }]),
            ),
            "meshes[0].positions",
            "beyond the 0 bytes",
        ),
    ] {
        let (element, message) = failure(&scene);
        assert_eq!(element, place, "{message}");
        assert!(message.contains(says), "{element}: {message}");
    }
    let error = import(b"{\n  \"ajar\": 1,\n  oops }").unwrap_err();
    assert_eq!(error.place, Some((3, 3)), "{error}");
}
