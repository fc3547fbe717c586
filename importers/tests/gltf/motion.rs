//! Animations at a moment.

use ajar_scene::{Choice, Imported, Moment, Projection};
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use crate::{build::Asset, parts, warnings};

/// A triangle whose node is moved by one channel of these keys.
fn moving(path: &str, kind: &str, interpolation: &str, times: &[f32], values: &[f32]) -> Asset {
    let mut asset = Asset::triangle(json!({}));
    animate(&mut asset, json!({"node": 0, "path": path}), kind, interpolation, times, values);
    asset
}

fn pointed(pointer: &str) -> Value {
    json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}})
}

fn animate(asset: &mut Asset, target: Value, kind: &str, interpolation: &str, times: &[f32], values: &[f32]) {
    let width = ["SCALAR", "", "VEC3", "VEC4"].iter().position(|known| *known == kind).unwrap() + 1;
    let input = asset.float_accessor("SCALAR", 1, times);
    let output = asset.float_accessor(kind, width, values);
    let sampler = json!({"input": input, "output": output, "interpolation": interpolation});
    let channel = json!({"sampler": 0, "target": target});
    asset.push("animations", json!({"samplers": [sampler], "channels": [channel]}));
}

fn at(asset: &Asset, seconds: f64) -> Imported {
    asset.import_as(&Choice { moment: Some(Moment::Seconds(seconds)), ..Choice::default() }).unwrap()
}

fn translation(asset: &Asset, seconds: f64) -> DVec3 {
    at(asset, seconds).scene.nodes.iter().next().unwrap().transform.translation
}

#[test]
fn translations_follow_their_interpolation() {
    let keys = [1.0, 2.0, 4.0];
    let values = [0.0, 0.0, 0.0, 8.0, 0.0, 0.0, 8.0, 4.0, 0.0];
    let linear = moving("translation", "VEC3", "LINEAR", &keys, &values);
    let step = moving("translation", "VEC3", "STEP", &keys, &values);
    for (seconds, expected, stepped) in [
        (-1.0, DVec3::ZERO, DVec3::ZERO),
        (1.25, DVec3::new(2.0, 0.0, 0.0), DVec3::ZERO),
        (2.0, DVec3::new(8.0, 0.0, 0.0), DVec3::new(8.0, 0.0, 0.0)),
        (3.5, DVec3::new(8.0, 3.0, 0.0), DVec3::new(8.0, 0.0, 0.0)),
        (9.0, DVec3::new(8.0, 4.0, 0.0), DVec3::new(8.0, 4.0, 0.0)),
    ] {
        assert_eq!(translation(&linear, seconds), expected, "at {seconds}");
        assert_eq!(translation(&step, seconds), stepped, "at {seconds}");
    }
}

/// Against the polynomials of the specification, written out: t = 2 s between keys, tangents per second.
#[test]
fn splines_are_hermite_with_tangents_over_time() {
    let zero = [0.0; 3];
    let values = [zero, [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [5.0, 0.0, 0.0], zero].concat();
    let asset = moving("translation", "VEC3", "CUBICSPLINE", &[0.0, 2.0], &values);
    for seconds in [0.0, 0.5, 1.0, 1.7, 2.0] {
        let t = seconds / 2.0;
        let expected = (2.0 * t * t * t - 3.0 * t * t + 1.0) * 1.0
            + 2.0 * (t * t * t - 2.0 * t * t + t) * 3.0
            + (-2.0 * t * t * t + 3.0 * t * t) * 5.0
            + 2.0 * (t * t * t - t * t) * -2.0;
        assert!((translation(&asset, seconds).x - expected).abs() < 1e-6, "at {seconds}");
    }
}

#[test]
fn rotations_go_the_short_way_at_constant_speed() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // The second key is written with the other sign: the same rotation.
    let values = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -half, -half];
    let asset = moving("rotation", "VEC4", "LINEAR", &[0.0, 3.0], &values);
    for (seconds, degrees) in [(0.0, 0.0), (1.0, 30.0), (2.0, 60.0), (3.0, 90.0)] {
        let node = at(&asset, seconds).scene.nodes.iter().next().unwrap().clone();
        let expected = DQuat::from_rotation_z(f64::to_radians(degrees)) * DVec3::X;
        assert!(node.transform.transform_vector3(DVec3::X).abs_diff_eq(expected, 1e-6), "at {seconds}");
    }
}

#[test]
fn rotations_may_be_normalized_integers() {
    let mut asset = Asset::triangle(json!({}));
    let input = asset.float_accessor("SCALAR", 1, &[0.0]);
    let bytes: Vec<u8> = [0i16, 0, 23170, 23170].iter().flat_map(|x| x.to_le_bytes()).collect();
    let output = asset.accessor(crate::build::SHORT, "VEC4", 1, &bytes, json!({"normalized": true}));
    let channel = json!({"sampler": 0, "target": {"node": 0, "path": "rotation"}});
    let sampler = json!({"input": input, "output": output});
    asset.json["animations"] = json!([{"samplers": [sampler], "channels": [channel]}]);
    let turned = at(&asset, 0.0).scene.nodes.iter().next().unwrap().transform.transform_vector3(DVec3::X);
    assert!(turned.abs_diff_eq(DVec3::Y, 1e-6), "{turned}");
}

#[test]
fn without_a_moment_the_rest_pose_is_shown() {
    let asset = moving("translation", "VEC3", "STEP", &[0.0], &[5.0, 0.0, 0.0]);
    let imported = asset.import().unwrap();
    assert_eq!(imported.scene.nodes.iter().next().unwrap().transform.translation, DVec3::ZERO);
    assert_eq!(warnings(&imported), [""; 0]);
    assert_eq!(imported.diagnostics[0].element.as_deref(), Some("animations"));
    let choice = Choice { moment: Some(Moment::Frame(48.0)), fps: Some(24.0), ..Choice::default() };
    let linear = moving("translation", "VEC3", "LINEAR", &[0.0, 4.0], &[0.0, 0.0, 0.0, 6.0, 0.0, 0.0]);
    let imported = linear.import_as(&choice).unwrap();
    assert_eq!(imported.scene.nodes.iter().next().unwrap().transform.translation.x, 3.0);
}

#[test]
fn of_several_animations_the_first_counts() {
    let mut asset = moving("translation", "VEC3", "STEP", &[0.0], &[1.0, 0.0, 0.0]);
    animate(&mut asset, json!({"node": 0, "path": "translation"}), "VEC3", "STEP", &[0.0], &[2.0, 0.0, 0.0]);
    animate(&mut asset, json!({"node": 0, "path": "scale"}), "VEC3", "STEP", &[0.0], &[3.0, 3.0, 3.0]);
    let imported = at(&asset, 0.0);
    let place = imported.scene.nodes.iter().next().unwrap().transform;
    assert_eq!(place.transform_point3(DVec3::X), DVec3::new(4.0, 0.0, 0.0));
    let said = "animations[1].channels[0]: several animations move the same thing; the first counts";
    assert_eq!(warnings(&imported), [said]);
}

#[test]
fn pointers_reach_materials_lights_cameras_and_visibility() {
    let mut asset = Asset::with_material(json!({"name": "clay"}));
    asset.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    asset.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    asset.json["nodes"][0]["extensions"] = json!({"KHR_node_visibility": {"visible": true}});
    for (pointer, kind, value) in [
        ("/materials/0/pbrMetallicRoughness/roughnessFactor", "SCALAR", &[0.25][..]),
        ("/materials/0/emissiveFactor", "VEC3", &[1.0, 2.0, 3.0]),
        ("/extensions/KHR_lights_punctual/lights/0/intensity", "SCALAR", &[7.0]),
        ("/cameras/0/perspective/yfov", "SCALAR", &[0.5]),
        ("/nodes/0/extensions/KHR_node_visibility/visible", "SCALAR", &[0.0]),
    ] {
        animate(&mut asset, pointed(pointer), kind, "STEP", &[0.0], value);
    }
    asset.json["extensionsRequired"] = json!(["KHR_animation_pointer"]);
    let imported = at(&asset, 0.0);
    assert_eq!(warnings(&imported), [""; 0]);
    let scene = &imported.scene;
    let material = scene.materials.iter().next().unwrap();
    assert_eq!((material.roughness.value, material.emission.value.to_array()), (0.25, [1.0, 2.0, 3.0]));
    let light = scene.lights.iter().next().unwrap();
    assert_eq!(light.kind, ajar_scene::LightKind::Point { intensity: 7.0 });
    let camera = scene.cameras.iter().next().unwrap();
    assert!(matches!(camera.projection, Projection::Perspective { yfov: 0.5, .. }));
    assert!(!scene.nodes.iter().next().unwrap().visible);
}

#[test]
fn what_cannot_move_is_named() {
    for (target, why) in [
        (pointed("/nodes/0/mesh"), "the animation of /nodes/0/mesh is dropped: a still image cannot show it"),
        (pointed("/nodes/9/scale"), "the animation of /nodes/9/scale is dropped: it points to nothing"),
        (pointed("/materials/0/alphaCutoff"), "dropped: it points to nothing"),
        (pointed(""), "dropped: a still image cannot show it"),
        (json!({"node": 0, "path": "rotation"}), "dropped: its values have the wrong type"),
        (json!({"node": 0, "path": "nothing"}), "dropped: a still image cannot show it"),
    ] {
        let mut asset = Asset::triangle(json!({}));
        animate(&mut asset, target, "VEC3", "STEP", &[0.0], &[1.0, 1.0, 1.0]);
        let said = warnings(&at(&asset, 0.0));
        assert!(said.len() == 1 && said[0].ends_with(why), "{said:?}");
    }
    let infinite = moving("translation", "VEC3", "STEP", &[0.0], &[f32::INFINITY, 0.0, 0.0]);
    assert!(warnings(&at(&infinite, 0.0))[0].ends_with("its value is not finite"));
}

#[test]
fn broken_samplers_are_errors() {
    let fails = |asset: &Asset| {
        let choice = Choice { moment: Some(Moment::Seconds(0.5)), ..Choice::default() };
        parts(asset.import_as(&choice).map(|_| ()).unwrap_err())
    };
    let (three, six) = ([0.0; 3], [0.0; 6]);
    let element = |field: &str| format!("animations[0].samplers[0].{field}");
    for (asset, field) in [
        (moving("translation", "VEC3", "SMOOTH", &[0.0], &three), "interpolation"),
        (moving("translation", "VEC3", "LINEAR", &[1.0, 0.0], &six), "input"),
        (moving("translation", "VEC3", "LINEAR", &[0.0, f32::NAN], &six), "input"),
        (moving("translation", "VEC3", "LINEAR", &[0.0, 1.0], &three), "output"),
        (moving("translation", "VEC3", "CUBICSPLINE", &[0.0], &six), "output"),
    ] {
        assert_eq!(fails(&asset).0, element(field));
    }
    let mut asset = moving("translation", "VEC3", "LINEAR", &[0.0], &three);
    asset.json["animations"][0]["channels"][0]["sampler"] = json!(3);
    assert_eq!(fails(&asset).0, "animations[0].channels[0].sampler");
    // Four thousand million keys without data.
    let mut asset = moving("translation", "VEC3", "LINEAR", &[0.0], &three);
    let keys =
        asset.push("accessors", json!({"componentType": 5126, "type": "SCALAR", "count": 4_000_000_000u32}));
    asset.json["animations"][0]["samplers"][0]["input"] = json!(keys);
    assert!(fails(&asset).1.starts_with("needs more memory"));
}
