//! `[node]`, and cameras that are copies.

use glam::{DVec3, Vec3};

use super::{right, wrong};
use crate::{LightKind, Node, Projection, Scene};

const IMPORT: &str = "[[import]]\nfile = \"a.glb\"\n";

fn with(toml: &str) -> Scene {
    right(&format!("{IMPORT}{toml}"), &["a.glb"]).scene
}

fn node(scene: &Scene, name: &str) -> Node {
    scene.nodes.iter().find(|node| node.name == name).unwrap().clone()
}

#[test]
fn nodes_are_found_by_name_and_by_path() {
    for pattern in ["part", "p*", "a/part", "a/*", "*art"] {
        let scene = with(&format!("[node.\"{pattern}\"]\nvisible = false\n"));
        assert!(!node(&scene, "part").visible, "{pattern}");
    }
    assert!(node(&with("[node.\"b/*\"]\nvisible = false\n"), "part").visible);
}

#[test]
fn nodes_move_turn_and_grow_in_place() {
    let scene = with("[node.part]\ntranslate = [1, 2, 3]\nrotate = [0, 90, 0]\nscale = 2\n");
    let transform = node(&scene, "part").transform;
    assert_eq!(transform.translation, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(transform.matrix3.x_axis, DVec3::NEG_Z * 2.0);
}

#[test]
fn lights_and_materials_of_nodes_change_for_them_alone() {
    let scene = with("[node.part]\nlight_scale = 3\nlight_color = [1, 0, 0]\nmaterial = \"Glass\"\n");
    let part = node(&scene, "part");
    let light = &scene.lights[part.light.unwrap()];
    let LightKind::Rect { radiance, .. } = light.kind else { panic!() };
    assert_eq!((radiance, light.color), (3.0, Vec3::X));
    assert_eq!(scene.lights.len(), 2, "the light as it was stays for others");
    assert_eq!(scene.materials[part.material.unwrap()].name, "Glass");
}

#[test]
fn what_fits_nothing_is_named() {
    for (toml, says) in [
        (
            "[node.prt]\nvisible = false",
            "node.\"prt\": no import has a node of this name\n  hint: did you mean \"part\"?",
        ),
        (
            "[node.part]\nmaterial = \"Gloss\"",
            "material: no material has this name\n  hint: did you mean \"Glass\"?",
        ),
        ("[node.a]\nlight_scale = 2", "light_scale: no node that fits has a light"),
        ("[node.a]\nscale = 0", "scale: must not be zero"),
        ("[[camera]]\ncopy = \"main\"", "camera[0].copy: no camera has this name"),
    ] {
        let errors = wrong(&format!("{IMPORT}{toml}\n"), &["a.glb"]);
        assert!(errors.iter().any(|error| error.contains(says)), "{toml}\n{errors:#?}");
    }
    let file = right(&format!("{IMPORT}[node.\"x*\"]\nvisible = false\n"), &["a.glb"]);
    assert!(file.diagnostics.iter().any(|d| d.message == "no imported node fits this pattern"));
}

#[test]
fn a_copied_camera_begins_as_the_other() {
    let scene = with(
        "[[camera]]\nname = \"wide\"\nposition = [1, 2, 3]\ntarget = [0, 0, 0]\nlens_radius = 0.1\nexposure = 2\n\
         [[camera]]\nname = \"tele\"\ncopy = \"wide\"\nyfov = 10\n\
         [[camera]]\nname = \"aside\"\ncopy = \"wide\"\nposition = [9, 2, 3]\n\
         [[camera]]\nname = \"flat\"\ncopy = \"wide\"\nhalf_height = 2\n\
         [[camera]]\nname = \"flat too\"\ncopy = \"flat\"\n",
    );
    let camera = |name: &str| scene.cameras.iter().find(|camera| camera.name == name).unwrap();
    let Projection::Perspective { yfov, lens_radius, focus_distance, .. } = camera("tele").projection else {
        panic!()
    };
    assert!((yfov.to_degrees() - 10.0).abs() < 1e-4 && lens_radius == 0.1);
    assert!((focus_distance - 14_f32.sqrt()).abs() < 1e-5);
    assert_eq!(camera("tele").exposure, 2.0);
    assert_eq!(node(&scene, "tele").transform, node(&scene, "wide").transform);
    let aside = node(&scene, "aside").transform;
    assert_eq!(aside.matrix3, node(&scene, "wide").transform.matrix3);
    assert_eq!(aside.translation, DVec3::new(9.0, 2.0, 3.0));
    for flat in ["flat", "flat too"] {
        assert_eq!(camera(flat).projection, Projection::Orthographic { half_height: 2.0 });
    }
}

#[test]
fn paths_may_begin_where_the_asset_does() {
    for pattern in ["/part", "/a/part", "/a/*"] {
        assert!(
            !node(&with(&format!("[node.\"{pattern}\"]\nvisible = false\n")), "part").visible,
            "{pattern}"
        );
    }
    assert!(node(&with("[node.\"/art*\"]\nvisible = false\n"), "part").visible);
}

#[test]
fn lights_of_nodes_get_other_shapes() {
    let folder = super::folder(
        &format!(
            "{IMPORT}[node.part]\nlight_width = 2\nlight_height = 0.5\n\
             light_texture = {{ file = \"gobo.png\", uv_scale = 2 }}\n"
        ),
        &["a.glb", "gobo.png"],
    );
    let scene = super::read(folder.path()).unwrap().scene;
    let light = &scene.lights[node(&scene, "part").light.unwrap()];
    let LightKind::Rect { radiance: 1.0, width: 2.0, height: 0.5, texture: Some(gobo) } = light.kind else {
        panic!("{light:?}")
    };
    assert_eq!(scene.textures[gobo].transform.matrix2.x_axis.x, 2.0);
}

/// Each key changes the lights that can have it, and is an error where none can.
#[test]
fn keys_of_lights_go_with_their_types() {
    let lights = "[[light]]\nname = \"spot\"\ntype = \"spot\"\n[[light]]\nname = \"sun\"\ntype = \"directional\"\n\
                  [[light]]\nname = \"tube\"\ntype = \"cylinder\"\n[[light]]\nname = \"ball\"\ntype = \"sphere\"\n\
                  [[light]]\nname = \"disk\"\ntype = \"disk\"\n[[light]]\nname = \"bulb\"\ntype = \"point\"\n";
    let all = "light_inner = 5\nlight_outer = 10\nlight_angle = 2\nlight_radius = 3\nlight_length = 4\n";
    let scene = right(&format!("{lights}[node.\"*\"]\n{all}"), &[]).scene;
    let kind = |name: &str| scene.lights[node(&scene, name).light.unwrap()].kind.clone();
    let radians = |degrees: f64| degrees.to_radians() as f32;
    let (inner, outer) = (radians(5.0), radians(10.0));
    assert_eq!(kind("spot"), LightKind::Spot { intensity: 1.0, inner, outer });
    assert_eq!(kind("sun"), LightKind::Directional { illuminance: 1.0, angle: radians(2.0) });
    assert_eq!(kind("tube"), LightKind::Cylinder { radiance: 1.0, radius: 3.0, length: 4.0 });
    assert_eq!(kind("ball"), LightKind::Sphere { radiance: 1.0, radius: 3.0 });
    assert_eq!(kind("disk"), LightKind::Disk { radiance: 1.0, radius: 3.0 });
    assert_eq!(kind("bulb"), LightKind::Point { intensity: 1.0 });

    for (key, says) in [
        ("light_radius = 2", "with it: disk, sphere and cylinder lights have"),
        ("light_angle = 181", "must be at least 0 and at most 180"),
        ("light_width = 0", "must be greater than 0"),
        ("light_texture = \"none.png\"", "cannot be read"),
        ("light_outer = 15", "the inner angle must not exceed the outer, as it would for light \"spot\""),
    ] {
        let errors = wrong(&format!("{lights}[node.spot]\n{key}\n"), &[]);
        assert!(errors.len() == 1 && errors[0].contains(says), "{key}\n{errors:#?}");
    }
}
