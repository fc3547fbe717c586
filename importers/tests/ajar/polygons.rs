//! Meshes of polygons.

use ajar_scene::{Id, Mesh};
use glam::{Vec2, Vec3};
use serde_json::{Value, json};

use super::{failure, import_json};

/// Two squares, one of them in a part, and what a test adds.
fn scene(more: &Value) -> Value {
    let mut mesh = json!({
        "positions": [[0,0,0], [1,0,0], [2,0,0], [0,1,0], [1,1,0], [2,1,0]],
        "faces": [4, 4],
        "corners": [0, 1, 4, 3, 1, 2, 5, 4],
    });
    for (key, value) in more.as_object().unwrap() {
        mesh[key] = value.clone();
    }
    json!({ "ajar": 1, "roots": [0], "nodes": [{ "meshes": [1, 0] }], "materials": [{}, {}],
        "meshes": [mesh, { "positions": [], "triangles": [] }] })
}

fn meshes(more: &Value) -> Vec<Mesh> {
    import_json(&scene(more)).unwrap().scene.meshes.iter().cloned().collect()
}

#[test]
fn nodes_get_all_meshes_that_parts_make() {
    let parts = json!({ "material": 0, "parts": [{ "material": 1, "faces": [1] }] });
    let scene = import_json(&scene(&parts)).unwrap().scene;
    let materials: Vec<_> = scene.meshes.iter().map(|mesh| mesh.material).collect();
    assert_eq!(materials, [Some(Id::new(0)), Some(Id::new(1)), None]);
    assert_eq!(scene.nodes[Id::new(0)].meshes, [2, 0, 1].map(Id::new));
}

#[test]
fn attributes_of_all_kinds_reach_the_vertices() {
    let mesh = &meshes(&json!({
        "normals": { "values": [[0,0,1]], "per": "mesh" },
        "uvs": [{ "values": [[0,0], [1,0], [1,1], [0,1]], "indices": [0,1,2,3, 0,1,2,3] },
                { "values": [[0,0], [0.5,0]], "per": "face" }],
        "colors": { "values": [[1,1,1,1], [0,0,0,1], [1,1,1,1], [1,1,1,1], [0,0,0,1], [1,1,1,1]], "per": "position" },
    }))[0];
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 4));
    assert_eq!(mesh.normals.as_ref().unwrap(), &[Vec3::Z; 8]);
    for (i, position) in mesh.positions.iter().enumerate() {
        let square = if mesh.uvs[1][i] == Vec2::ZERO { 0.0 } else { 1.0 };
        assert_eq!(mesh.uvs[0][i], position.truncate() - Vec2::X * square);
        assert_eq!(mesh.colors.as_ref().unwrap()[i].x == 0.0, position.x == 1.0);
    }
}

#[test]
fn subdivision_refines_and_keeps_parts() {
    let parts = json!({ "parts": [{ "material": 1, "faces": [1] }], "subdivision": { "levels": 3 } });
    let made = meshes(&parts);
    assert_eq!(made[0].triangles.len(), 2 * 64);
    assert_eq!((made[1].material, made[1].triangles.len()), (Some(Id::new(1)), 2 * 64));
    assert!(made[1].positions.iter().all(|p| p.x >= 1.0 - 1e-6));
}

#[test]
fn what_does_not_fit_is_an_error_with_its_place() {
    for (more, place, says) in [
        (json!({ "faces": [4, 5] }), "meshes[0]", "9 corners, but there are 8"),
        (
            json!({ "corners": [0, 1, 4, 3, 1, 2, 5, 9] }),
            "meshes[0]",
            "index 9 reaches beyond the 6 positions",
        ),
        (json!({ "holes": [2] }), "meshes[0].holes", "beyond the 2 faces"),
        (
            json!({ "parts": [{ "material": 0, "faces": [7] }] }),
            "meshes[0].parts[0].faces",
            "beyond the 2 faces",
        ),
        (json!({ "uvs": [{ "values": [[0, 0]] }] }), "meshes[0].uvs[0]", "1 entries, 8 are needed"),
        (json!({ "subdivision": { "levels": 7 } }), "meshes[0].subdivision", "7 levels are more than 6"),
        (
            json!({ "subdivision": { "creases": [[0, 1]] } }),
            "meshes[0].subdivision",
            "1 creases have 0 values",
        ),
        (
            json!({ "subdivision": { "creases": [[0, 8]], "crease_sharpness": [1] } }),
            "meshes[0].subdivision",
            "index 8 reaches beyond",
        ),
        (json!({ "triangles": [] }), "meshes[0].triangles", "unknown field `triangles`"),
    ] {
        let (element, message) = failure(&scene(&more));
        assert_eq!(element, place, "{message}");
        assert!(message.contains(says), "{message}");
    }
}

#[test]
fn faces_without_area_are_named() {
    let imported = import_json(&scene(&json!({ "corners": [0, 1, 4, 3, 1, 1, 1, 1] }))).unwrap();
    let said: Vec<_> = imported.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(said, ["1 face without area dropped"]);
}
