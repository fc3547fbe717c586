//! Lights and cameras.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use ajar_scene::{Camera, Imported, LightKind, Projection, Severity};
use glam::Vec3;
use serde_json::{Value, json};

use crate::{build::Asset, failure, messages, warnings};

fn lit(lights: Value) -> Imported {
    let mut asset = Asset::triangle(json!({}));
    let count = lights.as_array().unwrap().len();
    asset.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    asset.json["extensions"] = json!({"KHR_lights_punctual": {"lights": lights}});
    for i in 0..count {
        asset.push("nodes", json!({"extensions": {"KHR_lights_punctual": {"light": i}}}));
    }
    asset.import().unwrap()
}

#[test]
fn lights_of_all_types() {
    let imported = lit(json!([
        {"type": "point", "name": "bulb", "color": [1, 0.5, 0], "intensity": 20},
        {"type": "directional", "intensity": 3},
        {"type": "spot", "intensity": 7, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
        {"type": "spot"},
    ]));
    assert_eq!(messages(&imported, Severity::Note), [""; 0]);
    let lights: Vec<_> = imported.scene.lights.iter().collect();
    assert_eq!((lights[0].name.as_str(), lights[0].color), ("bulb", Vec3::new(1.0, 0.5, 0.0)));
    assert_eq!(lights[0].kind, LightKind::Point { intensity: 20.0 });
    assert_eq!(lights[1].kind, LightKind::Directional { illuminance: 3.0, angle: 0.0 });
    assert_eq!(lights[2].kind, LightKind::Spot { intensity: 7.0, inner: 0.25, outer: 0.5 });
    assert_eq!(lights[3].kind, LightKind::Spot { intensity: 1.0, inner: 0.0, outer: FRAC_PI_4 });
    assert_eq!(lights[3].color, Vec3::ONE);
    let placed: Vec<_> = imported.scene.nodes.iter().filter_map(|node| node.light).collect();
    assert_eq!(placed, imported.scene.lights.ids().collect::<Vec<_>>());
}

#[test]
fn the_range_is_a_note() {
    let imported = lit(json!([{"type": "point", "range": 5}, {"type": "point", "range": 6}]));
    assert_eq!(imported.scene.lights.len(), 2);
    let expected = "extensions.KHR_lights_punctual.lights[0].range: the range of lights is ignored, they reach \
                    everything (and at 1 more place)";
    assert_eq!(messages(&imported, Severity::Note), [expected]);
    assert_eq!(warnings(&imported), [""; 0]);
}

#[test]
fn impossible_cones_are_changed() {
    for (inner, outer) in [(0.5, 0.25), (0.5, 0.5), (-1.0, 0.5), (0.0, 3.0), (0.0, 0.0)] {
        let spot = json!({"innerConeAngle": inner, "outerConeAngle": outer});
        let imported = lit(json!([{"type": "spot", "spot": spot}]));
        let LightKind::Spot { inner, outer, .. } = imported.scene.lights.iter().next().unwrap().kind else {
            panic!()
        };
        assert!(0.0 <= inner && inner < outer && outer <= FRAC_PI_2, "{inner} {outer}");
        assert_eq!(warnings(&imported).len(), 1);
    }
}

#[test]
fn broken_lights_are_dropped_with_a_warning() {
    for (light, element) in [
        (json!({"type": "area"}), "extensions.KHR_lights_punctual.lights[0].type"),
        (json!({"type": "point", "intensity": -1}), "extensions.KHR_lights_punctual.lights[0]"),
        (json!({"type": "point", "intensity": 1e300}), "extensions.KHR_lights_punctual.lights[0]"),
        (json!({"type": "point", "color": [1, -1, 1]}), "extensions.KHR_lights_punctual.lights[0]"),
        (json!({"type": "point", "color": [1, 1]}), "extensions.KHR_lights_punctual.lights[0].color"),
    ] {
        let imported = lit(json!([light, {"type": "point"}]));
        assert_eq!(imported.scene.lights.len(), 1);
        let nodes: Vec<_> = imported.scene.nodes.iter().map(|node| node.light.is_some()).collect();
        assert_eq!(nodes, [false, false, true]);
        let found = warnings(&imported);
        assert!(
            found.len() == 1 && found[0].starts_with(&format!("{element}: the light is dropped: ")),
            "{found:?}"
        );
    }
}

#[test]
fn a_light_that_does_not_exist_is_an_error() {
    let mut asset = Asset::triangle(json!({}));
    asset.push("nodes", json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
    let (element, message) = failure(&asset);
    assert_eq!(element, "nodes[1].extensions.KHR_lights_punctual.light");
    assert_eq!(message, "points to lights[0], but there are only 0");
}

fn seen(cameras: Value) -> Imported {
    let mut asset = Asset::triangle(json!({}));
    let count = cameras.as_array().unwrap().len();
    asset.json["cameras"] = cameras;
    for i in 0..count {
        asset.push("nodes", json!({"camera": i}));
    }
    asset.import().unwrap()
}

#[test]
fn cameras_of_both_types() {
    let imported = seen(json!([
        {"type": "perspective", "name": "eye", "perspective": {"yfov": 0.5, "aspectRatio": 1.5, "znear": 0.1}},
        {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1, "zfar": 10}},
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0.1, "zfar": 10}},
    ]));
    assert_eq!(messages(&imported, Severity::Note), [""; 0]);
    let pinhole =
        |yfov| Projection::Perspective { yfov, lens_radius: 0.0, focus_distance: 1.0, shift: [0.0; 2] };
    let camera =
        |name: &str, projection, aspect| Camera { name: name.into(), projection, aspect, exposure: 1.0 };
    assert_eq!(
        imported.scene.cameras.iter().cloned().collect::<Vec<_>>(),
        [
            camera("eye", pinhole(0.5), Some(1.5)),
            camera("cameras[1]", pinhole(1.0), None),
            camera("cameras[2]", Projection::Orthographic { half_height: 2.0 }, Some(1.5)),
        ]
    );
    let placed: Vec<_> = imported.scene.nodes.iter().filter_map(|node| node.camera).collect();
    assert_eq!(placed, imported.scene.cameras.ids().collect::<Vec<_>>());
}

#[test]
fn broken_cameras_are_dropped_with_a_warning() {
    for camera in [
        json!({"type": "perspective"}),
        json!({"type": "perspective", "perspective": {"yfov": 0, "znear": 1}}),
        json!({"type": "perspective", "perspective": {"yfov": 3.2, "znear": 1}}),
        json!({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": -1, "znear": 0, "zfar": 1}}),
        json!({"type": "fisheye"}),
    ] {
        let imported = seen(json!([camera]));
        assert!(imported.scene.cameras.is_empty());
        let expected = "cameras[0]: the camera is dropped: its angle or size is missing or impossible";
        assert_eq!(warnings(&imported), [expected]);
    }
}
