//! Accessors and primitives.

use ajar_scene::Severity;
use glam::Vec3;
use serde_json::json;

use crate::{
    build::{Asset, BYTE, FLOAT, SHORT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT, floats},
    failure, messages, only_mesh, warnings,
};

/// Five points on a parabola.
fn parabola() -> Asset {
    let mut asset = Asset::new();
    let points: Vec<_> = (0..5).map(|i| [i as f32, (i * i) as f32, 0.0]).collect();
    asset.positions(&points);
    asset
}

fn points(mesh: &ajar_scene::Mesh) -> Vec<f32> {
    mesh.positions.iter().map(|p| p.x).collect()
}

#[test]
fn lists_strips_and_fans_become_triangles() {
    for (mode, expected) in [
        (4, vec![[0, 1, 2]]),
        (5, vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]]),
        (6, vec![[1, 2, 0], [2, 3, 0], [3, 4, 0]]),
    ] {
        let mut asset = parabola();
        asset.primitive(json!({"mode": mode}));
        assert_eq!(only_mesh(&asset).triangles, expected, "mode {mode}");
    }
}

#[test]
fn points_and_lines_are_dropped_with_a_warning() {
    for (mode, what) in [(0, "points"), (1, "lines"), (2, "lines"), (3, "lines")] {
        let mut asset = parabola();
        asset.primitive(json!({"mode": mode}));
        let imported = asset.import().unwrap();
        assert!(imported.scene.meshes.is_empty());
        let expected = format!("meshes[0].primitives[0]: {what} are dropped, only triangles are rendered");
        assert_eq!(warnings(&imported), [expected]);
    }
    let mut asset = parabola();
    asset.primitive(json!({"mode": 7}));
    assert_eq!(failure(&asset), ("meshes[0].primitives[0].mode".into(), "unknown mode".into()));
}

#[test]
fn indices_of_all_types_are_read() {
    let indices = [4u32, 0, 2, 2, 0, 1];
    let bytes: Vec<u8> = indices.iter().map(|&i| i as u8).collect();
    let shorts: Vec<u8> = indices.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect();
    let words: Vec<u8> = indices.iter().flat_map(|&i| i.to_le_bytes()).collect();
    for (component, data) in [(UNSIGNED_BYTE, bytes), (UNSIGNED_SHORT, shorts), (UNSIGNED_INT, words)] {
        let mut asset = parabola();
        let accessor = asset.accessor(component, "SCALAR", 6, &data, json!({}));
        asset.primitive(json!({"indices": accessor}));
        let mesh = only_mesh(&asset);
        // Vertex 3 is unused and gone.
        assert_eq!(points(&mesh), [0.0, 1.0, 2.0, 4.0]);
        assert_eq!(mesh.triangles, [[3, 0, 2], [2, 0, 1]]);
    }
}

#[test]
fn primitives_that_share_an_array_keep_only_their_part() {
    let mut asset = Asset::new();
    let points: Vec<_> = (0..1000).map(|i| [i as f32, 0.0, (i % 7) as f32]).collect();
    asset.positions(&points);
    let accessor = asset.accessor(UNSIGNED_SHORT, "SCALAR", 3, &[0xe7, 3, 5, 0, 0x2c, 1], json!({}));
    asset.primitive(json!({"indices": accessor}));
    let mesh = only_mesh(&asset);
    assert_eq!(
        mesh.positions,
        [Vec3::new(5.0, 0.0, 5.0), Vec3::new(300.0, 0.0, 6.0), Vec3::new(999.0, 0.0, 5.0)]
    );
    assert_eq!(mesh.triangles, [[2, 0, 1]]);
}

#[test]
fn an_index_without_vertex_is_an_error() {
    let mut asset = parabola();
    let accessor = asset.accessor(UNSIGNED_BYTE, "SCALAR", 3, &[0, 1, 5], json!({}));
    asset.primitive(json!({"indices": accessor}));
    let (element, message) = failure(&asset);
    assert_eq!(element, "meshes[0].primitives[0].indices[2]");
    assert_eq!(message, "points to vertex 5, but there are only 5");
}

#[test]
fn signed_and_float_indices_are_errors() {
    for (component, bytes) in [(BYTE, vec![0, 1, 2]), (FLOAT, floats(&[0.0, 1.0, 2.0]))] {
        let mut asset = parabola();
        let accessor = asset.accessor(component, "SCALAR", 3, &bytes, json!({}));
        asset.primitive(json!({"indices": accessor}));
        assert_eq!(failure(&asset).1, "indices must be unsigned integers");
    }
}

#[test]
fn leftover_corners_are_named() {
    let mut asset = parabola();
    let accessor = asset.accessor(UNSIGNED_BYTE, "SCALAR", 5, &[0, 1, 2, 3, 4], json!({}));
    asset.primitive(json!({"indices": accessor}));
    let imported = asset.import().unwrap();
    assert_eq!(imported.scene.meshes.iter().next().unwrap().triangles, [[0, 1, 2]]);
    let expected =
        "meshes[0].primitives[0]: the number of corners is no multiple of three; the rest is dropped";
    assert_eq!(warnings(&imported), [expected]);
}

#[test]
fn interleaved_attributes_are_read_at_their_stride() {
    let mut asset = Asset::new();
    let (a, b) = ([0.0, 0.0, 0.0, 0.25, 0.5], [1.0, 0.0, 0.0, 0.75, 0.125]);
    let rows = [a, b, [0.0, 1.0, 0.0, 1.5, -2.0]];
    let view = asset.view(&floats(rows.as_flattened()), json!({"byteStride": 20}));
    asset.push("accessors", json!({"bufferView": view, "componentType": FLOAT, "type": "VEC3", "count": 3}));
    let uv =
        json!({"bufferView": view, "byteOffset": 12, "componentType": FLOAT, "type": "VEC2", "count": 3});
    asset.push("accessors", uv);
    asset.primitive(json!({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}}));
    let mesh = only_mesh(&asset);
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(
        mesh.uvs[0].iter().map(|uv| uv.to_array()).collect::<Vec<_>>(),
        [[0.25, 0.5], [0.75, 0.125], [1.5, -2.0]]
    );
}

#[test]
fn sparse_accessors_replace_elements_or_start_from_zero() {
    for with_base in [true, false] {
        let mut asset = Asset::new();
        let base = asset.view(&floats(&[9.0; 12]), json!({}));
        let indices = asset.view(&[1, 0, 3, 0], json!({}));
        let values = asset.view(&floats(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), json!({}));
        let mut accessor = json!({
            "componentType": FLOAT, "type": "VEC3", "count": 4,
            "sparse": {
                "count": 2,
                "indices": {"bufferView": indices, "componentType": UNSIGNED_SHORT},
                "values": {"bufferView": values},
            },
        });
        if with_base {
            accessor["bufferView"] = json!(base);
        }
        asset.push("accessors", accessor);
        asset.primitive(json!({"mode": 5}));
        let rest = Vec3::splat(if with_base { 9.0 } else { 0.0 });
        let expected = [rest, Vec3::new(1.0, 2.0, 3.0), rest, Vec3::new(4.0, 5.0, 6.0)];
        assert_eq!(only_mesh(&asset).positions, expected);
    }
}

#[test]
fn sparse_indices_must_stay_inside_and_should_increase() {
    let with = |indices: [u8; 3]| {
        let mut asset = Asset::new();
        let view = asset.view(&indices, json!({}));
        let values = asset.view(&floats(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0]), json!({}));
        let indices = json!({"bufferView": view, "componentType": UNSIGNED_BYTE});
        let sparse = json!({"count": 3, "indices": indices, "values": {"bufferView": values}});
        asset
            .push("accessors", json!({"componentType": FLOAT, "type": "VEC3", "count": 4, "sparse": sparse}));
        asset.primitive(json!({"mode": 5}));
        asset
    };
    for (indices, expected) in [([3, 0, 1], [2.0, 3.0, 0.0, 1.0]), ([2, 1, 2], [0.0, 2.0, 3.0, 0.0])] {
        let asset = with(indices);
        assert_eq!(points(&only_mesh(&asset)), expected);
        let expected =
            "accessors[0].sparse.indices: the indices do not increase; the last of equal ones counts";
        assert_eq!(warnings(&asset.import().unwrap()), [expected]);
    }
    let expected = "points to element 4, but there are only 4";
    assert_eq!(failure(&with([1, 2, 4])), ("accessors[0].sparse.indices".into(), expected.into()));
}

#[test]
fn quantized_positions_of_all_types_are_read() {
    let (bytes, shorts) = ([127i8, -128, -127, 64, 0, 1], [32767i16, -32768, -32767, 100, 0, 1]);
    let signed: Vec<u8> = bytes.iter().map(|&v| v as u8).collect();
    let words: Vec<u8> = shorts.iter().flat_map(|v| v.to_le_bytes()).collect();
    let cases = [
        (BYTE, signed.clone(), true, [1.0, -1.0, -1.0, 64.0 / 127.0, 0.0, 1.0 / 127.0]),
        (BYTE, signed.clone(), false, [127.0, -128.0, -127.0, 64.0, 0.0, 1.0]),
        (UNSIGNED_BYTE, signed, true, [127.0, 128.0, 129.0, 64.0, 0.0, 1.0].map(|v| v / 255.0)),
        (SHORT, words.clone(), true, [1.0, -1.0, -1.0, 100.0 / 32767.0, 0.0, 1.0 / 32767.0]),
        (SHORT, words.clone(), false, [32767.0, -32768.0, -32767.0, 100.0, 0.0, 1.0]),
        (UNSIGNED_SHORT, words, true, [32767.0, 32768.0, 32769.0, 100.0, 0.0, 1.0].map(|v| v / 65535.0)),
    ];
    for (component, data, normalized, expected) in cases {
        let mut asset = Asset::new();
        let stride = data.len() / 2;
        let view = asset.view(&data, json!({"byteStride": stride}));
        let accessor = json!({
            "bufferView": view, "componentType": component, "type": "VEC3", "count": 2, "normalized": normalized,
        });
        asset.push("accessors", accessor);
        let indices = asset.accessor(UNSIGNED_BYTE, "SCALAR", 3, &[0, 1, 1], json!({}));
        asset.primitive(json!({"indices": indices}));
        let found: Vec<_> = only_mesh(&asset).positions.iter().flat_map(|p| p.to_array()).collect();
        assert_eq!(found, expected, "{component} normalized: {normalized}");
    }
}

#[test]
fn accessors_that_reach_beyond_their_data_are_errors() {
    let reach = [
        (json!({"count": 4}), "accessors[0]"),
        (json!({"byteOffset": 4}), "accessors[0]"),
        (json!({"byteOffset": u64::MAX}), "accessors[0]"),
        (json!({"count": 0}), "accessors[0].count"),
        (json!({"count": u64::MAX}), "accessors[0].count"),
        (json!({"count": 4294967294u32}), "accessors[0]"),
        (json!({"type": "VEC4"}), "accessors[0].type"),
        (json!({"type": "MAT2"}), "accessors[0].type"),
        (json!({"type": "VEC5"}), "accessors[0].type"),
        (json!({"componentType": 5124}), "accessors[0].componentType"),
    ];
    for (members, element) in reach {
        let mut asset = Asset::triangle(json!({}));
        for (key, value) in members.as_object().unwrap() {
            asset.json["accessors"][0][key] = value.clone();
        }
        assert_eq!(failure(&asset).0, element, "{members}");
    }
    let mut asset = Asset::triangle(json!({}));
    asset.json["bufferViews"][0]["byteStride"] = json!(8);
    let expected = "a stride of 8 bytes is less than the element's 12";
    assert_eq!(failure(&asset), ("accessors[0]".into(), expected.into()));
    for (key, value) in [("byteLength", 40u64), ("byteOffset", 4), ("byteOffset", u64::MAX)] {
        let mut asset = Asset::triangle(json!({}));
        asset.json["bufferViews"][0][key] = json!(value);
        assert_eq!(failure(&asset).0, "bufferViews[0]");
    }
}

#[test]
fn positions_must_be_finite() {
    for bad in [f32::INFINITY, f32::NAN] {
        let mut asset = Asset::new();
        asset.positions(&[[0.0; 3], [1.0; 3], [0.0, bad, 0.0]]);
        asset.primitive(json!({}));
        let (element, message) = failure(&asset);
        assert_eq!(element, "meshes[0].primitives[0].attributes.POSITION[2]");
        assert_eq!(message, "the position is not finite");
    }
}

#[test]
fn a_primitive_without_positions_or_triangles_is_dropped() {
    let mut asset = Asset::triangle(json!({}));
    asset.json["meshes"][0]["primitives"][0]["attributes"] = json!({"NORMAL": 0});
    let imported = asset.import().unwrap();
    assert!(imported.scene.meshes.is_empty());
    assert_eq!(
        warnings(&imported),
        ["meshes[0].primitives[0]: the primitive has no POSITION and is dropped"]
    );

    let mut asset = Asset::new();
    asset.positions(&[[0.0; 3], [1.0; 3]]);
    asset.primitive(json!({"mode": 5}));
    let imported = asset.import().unwrap();
    assert_eq!(warnings(&imported), ["meshes[0].primitives[0]: the primitive has no triangles"]);
}

#[test]
fn zeros_without_data_are_named_and_limited() {
    let mut asset = Asset::triangle(json!({}));
    asset.json["accessors"][0] = json!({"componentType": FLOAT, "type": "VEC3", "count": 3});
    let imported = asset.import().unwrap();
    let message =
        "meshes[0].primitives[0].attributes.POSITION: the accessor has no data, all its elements are zero";
    assert_eq!(warnings(&imported), [message]);

    asset.json["accessors"][0]["count"] = json!(4_000_000_000u32);
    let (element, message) = failure(&asset);
    assert_eq!(element, "meshes[0].primitives[0]");
    assert!(message.starts_with("needs more memory than the limit of 8589934592 bytes"), "{message}");
}

#[test]
fn one_mesh_a_primitive() {
    let mut asset = Asset::triangle(json!({}));
    asset.json["meshes"][0]["name"] = json!("both");
    let second = json!({"attributes": {"POSITION": 0}});
    asset.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    let imported = asset.import().unwrap();
    let node = imported.scene.nodes.iter().next().unwrap();
    assert_eq!(node.meshes, imported.scene.meshes.ids().collect::<Vec<_>>());
    assert!(imported.scene.meshes.iter().all(|mesh| mesh.name == "both"));
    assert_eq!(messages(&imported, Severity::Note), [""; 0]);
}
