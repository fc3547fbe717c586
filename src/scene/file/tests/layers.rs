//! Scene files that extend others.

use std::fs;

use glam::DVec3;

use super::{folder, import};
use crate::{ImportRequest, LightKind, Overrides, Projection, SceneFile, file::load};

const BASE: &str = r#"
[[import]]
file = "a.glb"
translate = [1, 0, 0]

[[camera]]
name = "main"
position = [0, 0, 5]
yfov = 30

[[light]]
name = "sun"
type = "directional"
illuminance = 3

[material."Chrome"]
roughness = 0.1
metallic = 1

[render]
spp = 8
seed = 3
"#;

/// `scene.toml` of this text over `base.toml`, with changes from the command line.
fn over(toml: &str, changes: &[&str]) -> Result<SceneFile, Vec<String>> {
    let folder = folder(toml, &["a.glb", "b.glb", "sky.hdr"]);
    fs::write(folder.path().join("base.toml"), BASE).unwrap();
    let found = load(
        &ImportRequest::new(folder.path().join("scene.toml")),
        &Overrides::parse(changes).unwrap(),
        &import,
    );
    let prefix = format!("{}/", folder.path().display());
    found.map_err(|errors| errors.iter().map(|error| error.to_string().replace(&prefix, "")).collect())
}

#[test]
fn keys_that_are_said_count_and_others_stay() {
    let file = over("extends = \"base.toml\"\n[render]\nspp = 2\n", &[]).unwrap();
    assert_eq!((file.render.spp, file.render.seed), (Some(2), Some(3)));
    let file = over("extends = \"base.toml\"\n[render]\nspp = 2\n", &["render.spp=1"]).unwrap();
    assert_eq!(file.render.spp, Some(1));
    assert_eq!(file.files.len(), 4, "{:?}", file.files);
}

#[test]
fn items_are_changed_by_name_added_or_removed() {
    let file = over(
        "extends = \"base.toml\"\n[[camera]]\nname = \"main\"\nlens_radius = 0.1\n[[camera]]\nname = \"new\"\n\
         [[light]]\nname = \"sun\"\nremove = true\n[[light]]\ntype = \"environment\"\nradiance = 2\n\
         [[import]]\nfile = \"b.glb\"\n[[import]]\nname = \"a\"\nscale = 2\n",
        &[],
    );
    // The import has no name of its own, so its file names it.
    let scene = file.unwrap().scene;
    let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["main", "new"]);
    let main = scene.cameras.iter().next().unwrap();
    let Projection::Perspective { yfov, lens_radius, .. } = main.projection else { panic!() };
    assert!((yfov.to_degrees() - 30.0).abs() < 1e-4 && lens_radius == 0.1);
    let lights: Vec<_> = scene.lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!(lights, ["bulb", "bulb", "light 1"]);
    let LightKind::Environment { radiance, .. } = scene.lights.iter().last().unwrap().kind else { panic!() };
    assert_eq!(radiance, 2.0);
    let roots: Vec<_> = scene.roots.iter().map(|&id| &scene.nodes[id]).collect();
    assert_eq!((roots[0].name.as_str(), roots[1].name.as_str()), ("a", "b"));
    assert_eq!(roots[0].transform.translation, DVec3::X);
    assert_eq!(roots[0].transform.matrix3.x_axis, DVec3::X * 2.0);
}

#[test]
fn materials_are_changed_in_turn() {
    let file = over("extends = \"base.toml\"\n[material.\"C*\"]\nroughness = 0.7\n", &[]).unwrap();
    let chrome = file.scene.materials.iter().find(|material| material.name == "Chrome").unwrap();
    assert_eq!((chrome.roughness.value, chrome.metallic.value), (0.7, 1.0));
}

#[test]
fn it_is_known_who_set_what() {
    let file = over("extends = \"base.toml\"\n[render]\nspp = 2\n", &["render.spp=1"]).unwrap();
    let set = |key: &str| {
        let setting = file.settings.iter().find(|setting| setting.key == key).unwrap();
        (setting.value.as_str(), setting.by.as_str(), setting.over.join(" "))
    };
    assert_eq!(set("render.spp"), ("1", "--set", "scene.toml base.toml".to_owned()));
    assert_eq!(set("render.seed"), ("3", "base.toml", String::new()));
    assert_eq!(set("material.\"Chrome\".roughness"), ("0.1", "base.toml", String::new()));
}

#[test]
fn mistakes_are_told_of_the_file_that_makes_them() {
    for (toml, says) in [
        ("extends = \"missing.toml\"", "scene.toml:1:11: error: extends: \"missing.toml\" cannot be read"),
        ("extends = \"scene.toml\"", "scene.toml:1:11: error: extends: extends itself"),
        ("extends = \"../other.toml\"", "scene.toml:1:11: error: extends:"),
        ("extends = 3", "scene.toml:1:11: error: extends: expected the name of a file, found integer"),
        (
            "extends = \"base.toml\"\n[render]\nspp = -1",
            "scene.toml:3:7: error: render.spp: must be at least 1",
        ),
        (
            "extends = \"base.toml\"\n[[light]]\nname = \"sun\"\nradiance = 1",
            "light[0].radiance: unknown key",
        ),
    ] {
        let errors = over(toml, &[]).unwrap_err();
        assert!(errors[0].contains(says), "{toml}\n{errors:#?}");
    }
    // A mistake below is told of the file below.
    let folder = folder("extends = \"base.toml\"", &[]);
    fs::write(folder.path().join("base.toml"), "\n[render]\nspp = \"many\"").unwrap();
    let errors = super::read(folder.path()).unwrap_err();
    assert!(errors[0].to_string().contains("base.toml:3:7: error: render.spp"), "{errors:#?}");
}

#[test]
fn circles_and_towers_end() {
    let folder = folder("extends = \"0.toml\"", &[]);
    for i in 0..40 {
        let next = (i + 1) % 40;
        fs::write(folder.path().join(format!("{i}.toml")), format!("extends = \"{next}.toml\"")).unwrap();
    }
    let errors = super::read(folder.path()).unwrap_err();
    assert!(errors[0].to_string().contains("more than 16 files extend each other"), "{errors:#?}");
    fs::write(folder.path().join("3.toml"), "extends = \"0.toml\"").unwrap();
    let errors = super::read(folder.path()).unwrap_err();
    assert!(errors[0].to_string().contains("extends itself"), "{errors:#?}");
}
