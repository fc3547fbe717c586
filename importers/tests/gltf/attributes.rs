//! Normals, tangents, texture coordinates, colours.

use ajar_scene::Severity;
use glam::{Vec2, Vec3, Vec4};
use serde_json::json;

use crate::{
    build::{Asset, BYTE, FLOAT, UNSIGNED_BYTE},
    failure, messages, only_mesh, warnings,
};

fn with(attributes: &[(&str, &str, usize, &[f32])]) -> Asset {
    let mut asset = Asset::triangle(json!({}));
    for (name, kind, width, values) in attributes {
        let accessor = asset.float_accessor(kind, *width, values);
        asset.attribute(name, accessor);
    }
    asset
}

const UP: [f32; 9] = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
const RIGHT: [f32; 12] = [1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 1.0];

#[test]
fn absent_normals_stay_absent_and_tangents_without_them_are_ignored() {
    assert_eq!(only_mesh(&with(&[])).normals, None);
    let imported = with(&[("TANGENT", "VEC4", 4, &RIGHT)]).import().unwrap();
    assert_eq!(imported.scene.meshes.iter().next().unwrap().tangents, None);
    let expected = "meshes[0].primitives[0].attributes.TANGENT: tangents without normals are ignored";
    assert_eq!(messages(&imported, Severity::Note), [expected]);
}

#[test]
fn good_normals_and_tangents_are_kept() {
    let asset = with(&[("NORMAL", "VEC3", 3, &UP), ("TANGENT", "VEC4", 4, &RIGHT)]);
    let mesh = only_mesh(&asset);
    assert_eq!(mesh.normals, Some(vec![Vec3::Z; 3]));
    let expected =
        [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(1.0, 0.0, 0.0, -1.0), Vec4::new(1.0, 0.0, 0.0, 1.0)];
    assert_eq!(mesh.tangents, Some(expected.to_vec()));
    assert!(asset.import().unwrap().diagnostics.is_empty());
}

#[test]
fn bad_normals_are_repaired() {
    let values = [0.0, 3.0, 4.0, 0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0];
    let imported = with(&[("NORMAL", "VEC3", 3, &values)]).import().unwrap();
    let normals = imported.scene.meshes.iter().next().unwrap().normals.clone().unwrap();
    // The triangle lies in the plane z = 0, counter-clockwise seen from +Z.
    assert_eq!(normals, [Vec3::new(0.0, 0.6, 0.8), Vec3::Z, Vec3::Z]);
    let name = "meshes[0].primitives[0].attributes.NORMAL";
    assert_eq!(
        warnings(&imported),
        [
            format!("{name}: normals are not of unit length; they are normalized"),
            format!("{name}: normals are zero or not finite; they are replaced by those of the triangles"),
        ]
    );
}

#[test]
fn huge_and_tiny_normals_have_a_direction() {
    let values = [0.0, 3e38, 3e38, 1e-40, 0.0, 0.0, 0.0, 0.0, -1.0];
    let normals = only_mesh(&with(&[("NORMAL", "VEC3", 3, &values)])).normals.unwrap();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    assert_eq!(normals, [Vec3::new(0.0, half, half), Vec3::X, Vec3::NEG_Z]);
}

#[test]
fn byte_normals_are_normalized_without_a_word() {
    let mut asset = Asset::triangle(json!({}));
    let data: Vec<u8> = [90i8, 90, 0, 0].repeat(3).iter().map(|&v| v as u8).collect();
    let view = asset.view(&data, json!({"byteStride": 4}));
    let accessor =
        json!({"bufferView": view, "componentType": BYTE, "type": "VEC3", "count": 3, "normalized": true});
    let accessor = asset.push("accessors", accessor);
    asset.attribute("NORMAL", accessor);
    let normals = only_mesh(&asset).normals.unwrap();
    assert!(normals.iter().all(|n| n.is_normalized() && n.x == n.y && n.z == 0.0));
    assert!(asset.import().unwrap().diagnostics.is_empty());
}

#[test]
fn bad_tangents_are_repaired_or_left_to_be_computed() {
    let sloppy = [2.0, 0.0, 0.0, 0.5, 0.0, 1.0, 0.0, -3.0, 1.0, 0.0, 0.0, 1.0];
    let imported = with(&[("NORMAL", "VEC3", 3, &UP), ("TANGENT", "VEC4", 4, &sloppy)]).import().unwrap();
    let expected =
        [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 1.0, 0.0, -1.0), Vec4::new(1.0, 0.0, 0.0, 1.0)];
    assert_eq!(imported.scene.meshes.iter().next().unwrap().tangents, Some(expected.to_vec()));
    assert!(warnings(&imported)[0].ends_with("not of unit length with a sign of ±1; they are normalized"));

    for (at, bad) in [(0, 0.0), (0, f32::INFINITY), (3, 0.0), (3, f32::NAN)] {
        let mut broken = RIGHT;
        broken[at] = bad;
        let imported = with(&[("NORMAL", "VEC3", 3, &UP), ("TANGENT", "VEC4", 4, &broken)]).import().unwrap();
        assert_eq!(imported.scene.meshes.iter().next().unwrap().tangents, None);
        assert!(warnings(&imported)[0].ends_with("tangents are zero or not finite; they are computed anew"));
    }
}

#[test]
fn all_texture_coordinate_sets_are_read_and_gaps_are_zero() {
    let first = [0.0, 0.25, 0.5, 0.75, 1.0, 2.0];
    let third = [0.5, f32::NAN, -1.0, 0.0, 0.0, 1.0];
    let imported =
        with(&[("TEXCOORD_0", "VEC2", 2, &first), ("TEXCOORD_2", "VEC2", 2, &third)]).import().unwrap();
    let mesh = imported.scene.meshes.iter().next().unwrap();
    assert_eq!(mesh.uvs.len(), 3);
    assert_eq!(mesh.uvs[0], [Vec2::new(0.0, 0.25), Vec2::new(0.5, 0.75), Vec2::new(1.0, 2.0)]);
    assert_eq!(mesh.uvs[1], [Vec2::ZERO; 3]);
    assert_eq!(mesh.uvs[2], [Vec2::ZERO, Vec2::new(-1.0, 0.0), Vec2::new(0.0, 1.0)]);
    let name = "meshes[0].primitives[0].attributes.TEXCOORD_2";
    assert_eq!(
        warnings(&imported),
        [
            format!("{name}: sets of a lower number are missing; they are zero"),
            format!("{name}: texture coordinates that are not finite are set to zero"),
        ]
    );
    let imported = with(&[("TEXCOORD_4000000000", "VEC2", 2, &first)]).import().unwrap();
    assert!(imported.scene.meshes.iter().next().unwrap().uvs.is_empty());
    assert!(warnings(&imported)[0].ends_with("dropped: only 64 sets are read"));
}

#[test]
fn colours_are_clamped_and_alpha_is_one_where_absent() {
    let rgb = [0.25, 0.5, 1.0, 0.0, 0.0, 0.0, -1.0, 2.0, f32::NAN];
    let imported = with(&[("COLOR_0", "VEC3", 3, &rgb)]).import().unwrap();
    let expected = [Vec4::new(0.25, 0.5, 1.0, 1.0), Vec4::new(0.0, 0.0, 0.0, 1.0), Vec4::ONE.with_x(0.0)];
    assert_eq!(imported.scene.meshes.iter().next().unwrap().colors, Some(expected.to_vec()));
    let expected = "meshes[0].primitives[0].attributes.COLOR_0: colours are clamped to between 0 and 1";
    assert_eq!(messages(&imported, Severity::Note), [expected]);

    let mut asset = Asset::triangle(json!({}));
    let data = [255, 0, 51, 102].repeat(3);
    let accessor = asset.accessor(UNSIGNED_BYTE, "VEC4", 3, &data, json!({"normalized": true}));
    asset.attribute("COLOR_0", accessor);
    assert_eq!(only_mesh(&asset).colors, Some(vec![Vec4::new(1.0, 0.0, 0.2, 0.4); 3]));
}

#[test]
fn attributes_of_another_length_are_dropped_and_of_another_type_refused() {
    let imported = with(&[("NORMAL", "VEC3", 3, &UP[..6])]).import().unwrap();
    assert_eq!(imported.scene.meshes.iter().next().unwrap().normals, None);
    let name = "meshes[0].primitives[0].attributes.NORMAL";
    let message = "the attribute is dropped: it has not as many elements as POSITION";
    assert_eq!(warnings(&imported), [format!("{name}: {message}")]);

    let (element, message) = failure(&with(&[("NORMAL", "VEC4", 4, &RIGHT)]));
    assert_eq!((element.as_str(), message), ("accessors[1].type", format!("the type does not suit {name}")));

    let mut asset = Asset::triangle(json!({}));
    asset.json["accessors"][0]["componentType"] = json!(5125);
    assert_eq!(failure(&asset).1, "32-bit integers are no vertex attribute");
    assert_eq!(FLOAT, 5126);
}
