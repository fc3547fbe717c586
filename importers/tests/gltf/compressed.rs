//! Compressed buffer views.

use std::fs;

use ajar_importers::gltf::Gltf;
use ajar_scene::{Choice, ImportRequest, Importer};
use glam::Vec3;
use serde_json::{Value, json};

use crate::{
    assets::{load_as, shared},
    build::{Asset, FLOAT, UNSIGNED_SHORT, floats},
    failure, only_mesh, warnings,
};

const NAME: &str = "EXT_meshopt_compression";

/// Differences of consecutive bytes, zigzag.
fn differences(column: &[u8]) -> Vec<u8> {
    let mut last = 0u8;
    let difference = |&x: &u8| {
        let d = x.wrapping_sub(std::mem::replace(&mut last, x));
        (d << 1) ^ ((d as i8) >> 7) as u8
    };
    column.iter().map(difference).collect()
}

/// Up to sixteen elements, every byte stored as it is but for the difference.
fn attributes(elements: &[u8], stride: usize) -> Vec<u8> {
    let mut stream = vec![0xa0];
    for k in 0..stride {
        let column: Vec<_> = elements.iter().skip(k).step_by(stride).copied().collect();
        let mut group = differences(&column);
        group.resize(16, 0);
        stream.push(3);
        stream.extend(group);
    }
    stream.extend(vec![0; stride.max(32)]);
    stream
}

/// A view of compressed bytes, in place of one that a fallback would fill.
fn compressed(asset: &mut Asset, stream: &[u8], [count, stride]: [usize; 2], mode: &str) -> usize {
    let view = asset.view(stream, json!({}));
    let mut members = asset.json["bufferViews"][view].clone();
    members["mode"] = json!(mode);
    members["count"] = json!(count);
    members["byteStride"] = json!(stride);
    asset.json["bufferViews"][view] =
        json!({"buffer": 0, "byteLength": count * stride, "extensions": {NAME: members}});
    view
}

/// Four vertices and two triangles, compressed.
fn square() -> Asset {
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, -2.5];
    let mut asset = Asset::new();
    let view = compressed(&mut asset, &attributes(&floats(&corners), 12), [4, 12], "ATTRIBUTES");
    asset.push("accessors", json!({"bufferView": view, "componentType": FLOAT, "type": "VEC3", "count": 4}));
    // Against baseline 0 by turns of zigzag: 0, 1, 2, 2, 1, 3.
    let numbers = [0u8, 2, 2, 0, 1, 4].map(|d| d << 1);
    let stream = [&[0xd1][..], &numbers, &[0; 4]].concat();
    let view = compressed(&mut asset, &stream, [6, 2], "INDICES");
    let indices = json!({"bufferView": view, "componentType": UNSIGNED_SHORT, "type": "SCALAR", "count": 6});
    let indices = asset.push("accessors", indices);
    asset.primitive(json!({"indices": indices}));
    asset.json["extensionsRequired"] = json!([NAME]);
    asset
}

#[test]
fn vertices_and_sequences_are_decoded() {
    let mesh = only_mesh(&square());
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, -2.5)]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
}

/// From the extension's description of the codes: fresh vertices, the last edge, a recent vertex, a stored one.
#[test]
fn triangles_are_decoded() {
    let mut asset = square();
    // 0xf0: three fresh vertices 0 1 2 by the table's 0x00. 0x00: edge (2, 0), a fresh vertex 3.
    let stream = [&[0xe1, 0xf0, 0x00][..], &[0; 16]].concat();
    let view = compressed(&mut asset, &stream, [6, 2], "TRIANGLES");
    asset.json["accessors"][1]["bufferView"] = json!(view);
    assert_eq!(only_mesh(&asset).triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn broken_streams_are_errors() {
    let broken = |change: &dyn Fn(&mut Value)| {
        let mut asset = square();
        change(&mut asset.json["bufferViews"][0]["extensions"][NAME]);
        failure(&asset)
    };
    let element = "bufferViews[0].extensions.EXT_meshopt_compression";
    let data = (element.to_string(), "the compressed data are broken".to_string());
    assert_eq!(broken(&|view| view["mode"] = json!("TRIANGLES")), data);
    assert_eq!(broken(&|view| view["mode"] = json!("INDICES")), data);
    assert_eq!(broken(&|view| view["byteStride"] = json!(10)), data);
    assert_eq!(broken(&|view| view["count"] = json!(4000)), data);
    assert_eq!(broken(&|view| view["filter"] = json!("OCTAHEDRAL")), data);
    assert_eq!(broken(&|view| view["byteLength"] = json!(20)), data);
    assert_eq!(broken(&|view| view["byteLength"] = json!(1u64 << 40)).1, "reaches beyond its buffer");
    assert_eq!(broken(&|view| view["buffer"] = json!(7)).1, "points to buffers[7], but there are only 1");
    let bomb = broken(&|view| view["count"] = json!(1u64 << 40));
    assert!(bomb.1.starts_with("needs more memory"), "{bomb:?}");
    assert!(broken(&|view| view["count"] = json!(u64::MAX)).1.contains("impossible size"));
}

#[test]
fn a_real_box_is_a_box() {
    let Some(assets) = shared() else { return };
    let imported = load_as(&assets.join("gltf/BoxMeshopt/BoxMeshopt.glb"), &Choice::default()).unwrap();
    assert_eq!(warnings(&imported), [""; 0]);
    let placed = imported.scene.placed();
    let placed = placed.iter().find(|placed| !placed.node.meshes.is_empty()).unwrap();
    let mesh = &imported.scene.meshes[placed.node.meshes[0]];
    let corners: Vec<_> =
        mesh.positions.iter().map(|p| placed.world.transform_point3(p.as_dvec3())).collect();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (24, 12));
    let reach = corners[0].abs();
    assert!(corners.iter().all(|corner| corner.abs().abs_diff_eq(reach, 1e-3)), "{corners:?}");
    let normals = mesh.normals.as_ref().unwrap();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        let geometric = (b - a).cross(c - a).normalize();
        assert!(triangle.iter().all(|&i| normals[i as usize].abs_diff_eq(geometric, 0.02)));
    }
}

#[test]
fn damaged_streams_never_stop_the_program() {
    let Some(assets) = shared() else { return };
    let whole = fs::read(assets.join("gltf/BoxMeshopt/BoxMeshopt.glb")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.glb");
    let binary = whole.len() - 300;
    for at in 0..300 {
        for value in [0, 1, 0x7f, 0xff, whole[binary + at] ^ 0x10] {
            let mut bytes = whole.clone();
            bytes[binary + at] = value;
            fs::write(&path, bytes).unwrap();
            if let Ok(imported) = Gltf.import(&ImportRequest::new(&path)) {
                let meshes = imported.scene.meshes.iter();
                assert!(meshes.flat_map(|mesh| &mesh.positions).all(|p| p.is_finite()));
            }
        }
    }
}
