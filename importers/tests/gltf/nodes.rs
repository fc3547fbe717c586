//! The hierarchy.

use ajar_scene::{Id, Imported, Severity};
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use crate::{build::Asset, failure, messages, warnings};

fn scene(nodes: Value) -> Asset {
    let mut asset = Asset::triangle(json!({}));
    asset.json["nodes"] = nodes;
    asset
}

fn world(imported: &Imported, node: usize, point: DVec3) -> DVec3 {
    let placed = imported.scene.placed();
    placed.iter().find(|placed| placed.id == Id::new(node)).unwrap().world.transform_point3(point)
}

#[test]
fn translation_rotation_and_scale_apply_in_this_order_from_the_left() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let asset = scene(json!([
        {"translation": [10, 0, 0], "children": [1]},
        {"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, half, half], "scale": [2, 3, 4]},
    ]));
    let imported = asset.import().unwrap();
    // Scaled to (2, 3, 4), turned by 90° about Z to (−3, 2, 4), moved.
    let found = world(&imported, 1, DVec3::ONE);
    assert!(found.abs_diff_eq(DVec3::new(8.0, 4.0, 7.0), 1e-6), "{found}");
    assert_eq!(imported.scene.roots, [Id::new(0)]);
    assert_eq!(messages(&imported, Severity::Note), [""; 0]);
}

#[test]
fn matrices_are_column_major() {
    let matrix = json!([0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]);
    let imported = scene(json!([{"mesh": 0, "matrix": matrix}])).import().unwrap();
    assert_eq!(world(&imported, 0, DVec3::new(1.0, 2.0, 3.0)), DVec3::new(3.0, 7.0, 13.0));
}

#[test]
fn odd_transforms_are_named() {
    let matrix = [1.0, 0.0, 0.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    for (node, expected) in [
        (json!({"mesh": 0, "matrix": matrix}), "nodes[0].matrix: the last row is not 0 0 0 1 and is ignored"),
        (
            json!({"mesh": 0, "rotation": [0, 0, 0, 0]}),
            "nodes[0].rotation: the rotation is zero and is ignored",
        ),
    ] {
        assert_eq!(warnings(&scene(json!([node])).import().unwrap()), [expected]);
    }
    let node = json!({"mesh": 0, "translation": [1e300, 0, 0]});
    assert_eq!(failure(&scene(json!([node]))), ("nodes[0]".into(), "the transform is not finite".into()));
}

#[test]
fn rotations_are_normalized() {
    let imported = scene(json!([{"mesh": 0, "rotation": [0, 2, 0, 2]}])).import().unwrap();
    let expected = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2) * DVec3::X;
    assert!(world(&imported, 0, DVec3::X).abs_diff_eq(expected, 1e-12));
}

#[test]
fn a_mesh_of_two_nodes_is_shared() {
    let imported = scene(json!([{"mesh": 0}, {"mesh": 0}])).import().unwrap();
    assert_eq!(imported.scene.meshes.len(), 1);
    assert!(imported.scene.nodes.iter().all(|node| node.meshes == [Id::new(0)]));
}

#[test]
fn the_default_scene_the_first_or_all_roots() {
    let nodes = json!([{"mesh": 0, "name": "a"}, {"children": [2]}, {"mesh": 0}]);
    let roots = |asset: &Asset| {
        let imported = asset.import().unwrap();
        (
            imported.scene.roots.iter().map(|id| id.index()).collect::<Vec<_>>(),
            messages(&imported, Severity::Note),
        )
    };
    let mut asset = scene(nodes);
    assert_eq!(roots(&asset), (vec![0, 1], vec![]));
    asset.json["scenes"] = json!([{"nodes": [0]}, {"nodes": [1]}]);
    assert_eq!(roots(&asset), (vec![0], vec!["scenes[0]: this one of 2 scenes is read".into()]));
    asset.json["scene"] = json!(1);
    assert_eq!(roots(&asset), (vec![1], vec!["scenes[1]: this one of 2 scenes is read".into()]));
    asset.json["scenes"] = json!([{"nodes": [1, 2, 1]}]);
    asset.json["scene"] = json!(0);
    assert_eq!(
        roots(&asset),
        (
            vec![1],
            vec![
                "scenes[0].nodes[1]: the node is a child of another node; this entry is ignored".into(),
                "scenes[0].nodes[2]: the node is listed twice; this entry is ignored".into(),
            ]
        )
    );
    asset.json["scenes"] = json!([{"name": "empty"}]);
    assert_eq!(roots(&asset), (vec![], vec!["-: the scene places no nodes, there is nothing to see".into()]));
}

#[test]
fn hidden_nodes_stay_but_are_invisible() {
    let hidden = json!({"extensions": {"KHR_node_visibility": {"visible": false}}, "children": [1]});
    let imported = scene(json!([hidden, {"mesh": 0}, {"mesh": 0}])).import().unwrap();
    let visible: Vec<_> = imported.scene.placed().iter().map(|placed| placed.visible).collect();
    assert_eq!(visible, [false, false, true]);
}

#[test]
fn cycles_and_second_parents_are_errors() {
    for (nodes, element) in [
        (json!([{"children": [0]}]), "nodes[0]"),
        (json!([{}, {"children": [2]}, {"children": [3]}, {"children": [1]}]), "nodes[1]"),
        (json!([{"children": [2]}, {"children": [2]}, {}]), "nodes[1].children[0]"),
        (json!([{"children": [1, 1]}, {}]), "nodes[0].children[1]"),
    ] {
        assert_eq!(failure(&scene(nodes)).0, element);
    }
}

#[test]
fn a_long_chain_is_no_problem() {
    let count = 20_000;
    let nodes =
        (0..count).map(|i| if i + 1 < count { json!({"children": [i + 1]}) } else { json!({"mesh": 0}) });
    let imported = scene(nodes.collect()).import().unwrap();
    assert_eq!(imported.scene.placed().last().unwrap().depth, count - 1);
}

#[test]
fn indices_must_exist() {
    for (path, value, element) in [
        ("nodes", json!([{"mesh": 1}]), "nodes[0].mesh"),
        ("nodes", json!([{"camera": 0}]), "nodes[0].camera"),
        ("nodes", json!([{"children": [1]}]), "nodes[0].children[0]"),
        ("scenes", json!([{"nodes": [1]}]), "scenes[0].nodes[0]"),
        ("scene", json!(0), "scene"),
        ("textures", json!([{"source": 0}]), "textures[0].source"),
        ("textures", json!([{"sampler": 0}]), "textures[0].sampler"),
        ("images", json!([{"bufferView": 1}]), "images[0].bufferView"),
        ("bufferViews", json!([{"buffer": 1, "byteLength": 1}]), "bufferViews[0].buffer"),
        (
            "accessors",
            json!([{"bufferView": 1, "count": 1, "type": "VEC3", "componentType": 5126}]),
            "accessors[0].bufferView",
        ),
        (
            "meshes",
            json!([{"primitives": [{"attributes": {"POSITION": 1}}]}]),
            "meshes[0].primitives[0].attributes",
        ),
        (
            "meshes",
            json!([{"primitives": [{"attributes": {}, "indices": 1}]}]),
            "meshes[0].primitives[0].indices",
        ),
        (
            "meshes",
            json!([{"primitives": [{"attributes": {}, "material": 0}]}]),
            "meshes[0].primitives[0].material",
        ),
    ] {
        let mut asset = Asset::triangle(json!({}));
        asset.json[path] = value;
        let (found, message) = failure(&asset);
        assert_eq!(found, element);
        assert!(message.starts_with("points to "), "{message}");
    }
}
