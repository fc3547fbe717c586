//! `docs/scene-file.md` against the readers.

use toml::de::DeTable;

use super::{right, wrong};
use crate::Material;

const REFERENCE: &str = include_str!("../../../../docs/scene-file.md");

/// The first example of the reference.
fn example() -> &'static str {
    REFERENCE.split("```toml\n").nth(1).unwrap().split("```").next().unwrap()
}

const FILES: [&str; 6] =
    ["assets/room.glb", "assets/statue.obj", "sky.hdr", "wood.png", "wood_orm.png", "wood_normal.png"];

#[test]
fn example_is_right() {
    let toml = example().replace("material.\"Floor\"", "material.\"Glass\"");
    let file = right(&toml, &FILES);
    assert_eq!(file.scene.cameras.len(), 1);
    assert_eq!(file.scene.lights.len(), 2 + 2);
    assert_eq!(
        file.scene.materials.iter().filter(|m| m.name == "Chrome" && m.roughness.value == 0.1).count(),
        2
    );
    assert!(file.scene.validate().is_empty(), "{:#?}", file.scene.validate());
}

/// Every `key` that a hint can offer stands in the reference, and every field of a material has a key.
#[test]
fn reference_names_every_key() {
    let mut keys: Vec<String> = [
        "[x]",
        "[[import]]\nx = 1",
        "[[camera]]\nx = 1",
        "[[camera]]\nhalf_height = 1\nx = 1",
        "[[light]]\ntype = \"point\"\nx = 1",
        "[[light]]\ntype = \"spot\"\nx = 1",
        "[[light]]\ntype = \"directional\"\nx = 1",
        "[[light]]\ntype = \"rect\"\nx = 1",
        "[[light]]\ntype = \"cylinder\"\nx = 1",
        "[[light]]\ntype = \"environment\"\nx = 1",
        "[material.\"*\"]\nxxxxxx = 1",
        "[material.\"*\"]\nroughness_texture = { x = 1 }",
        "[render]\nx = 1",
        "[output]\nx = 1",
    ]
    .iter()
    .flat_map(|toml| wrong(toml, &[]))
    .filter_map(|message| message.split("hint: one of ").nth(1).map(str::to_owned))
    .flat_map(|keys| keys.split(", ").map(str::to_owned).collect::<Vec<_>>())
    .collect();
    keys.sort();
    keys.dedup();
    assert!(keys.len() > 80, "{keys:?}");
    for key in &keys {
        let named = [format!("`{key}`"), format!("[{key}]"), format!("[{key}.")];
        assert!(named.iter().any(|name| REFERENCE.contains(name)), "{key}");
    }

    let material = serde_json::to_value(Material::default()).unwrap();
    for (field, value) in material.as_object().unwrap() {
        let key = match field.as_str() {
            "name" => continue,
            "normal_map" => "normal_texture",
            other => other,
        };
        assert!(keys.iter().any(|known| known == key), "{key}");
        if value.get("texture").is_some() {
            assert!(keys.iter().any(|known| *known == format!("{key}_texture")), "{key}_texture");
        }
    }
}

/// The example is TOML that any reader takes.
#[test]
fn example_is_toml() {
    assert_eq!(DeTable::parse(example()).unwrap().get_ref().len(), 6);
}
