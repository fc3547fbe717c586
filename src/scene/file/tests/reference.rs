//! `docs/scene-file.md` against the readers.

use std::collections::{BTreeMap, BTreeSet};

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

/// Every kind of table, with a key that it does not know, and the path of its definition in the schema.
const TABLES: [(&str, &str); 15] = [
    ("[x]", ""),
    ("[[import]]\nx = 1", "/properties/import/items"),
    ("[[camera]]\nx = 1", "/properties/camera/items"),
    ("[[light]]\ntype = \"point\"\nx = 1", "/properties/light/items"),
    ("[[light]]\ntype = \"spot\"\nx = 1", "/properties/light/items"),
    ("[[light]]\ntype = \"directional\"\nx = 1", "/properties/light/items"),
    ("[[light]]\ntype = \"rect\"\nx = 1", "/properties/light/items"),
    ("[[light]]\ntype = \"cylinder\"\nx = 1", "/properties/light/items"),
    ("[[light]]\ntype = \"environment\"\nx = 1", "/properties/light/items"),
    ("[material.\"*\"]\nxxxxxx = 1", "/properties/material/additionalProperties"),
    ("[material.\"*\"]\nroughness_texture = { x = 1 }", "/$defs/scalar_texture/oneOf/1"),
    ("[material.\"*\"]\nemission_texture = { x = 1 }", "/$defs/color_texture/oneOf/1"),
    ("[node.\"*\"]\nxxxxxx = 1", "/properties/node/additionalProperties"),
    ("[render]\nx = 1", "/properties/render"),
    ("[output]\nx = 1", "/properties/output"),
];

/// The keys that a table may have, as the hint offers them.
fn keys_of(toml: &str) -> Vec<String> {
    let keys = |message: String| message.split("hint: one of ").nth(1).map(str::to_owned);
    let all = wrong(toml, &[]).into_iter().filter_map(keys);
    all.flat_map(|keys| keys.split(", ").map(str::to_owned).collect::<Vec<_>>()).collect()
}

/// The schema knows the keys that the readers know, no more and no less.
#[test]
fn schema_has_every_key() {
    let schema: serde_json::Value = serde_json::from_str(crate::SCHEMA).unwrap();
    let mut wanted: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    for (toml, path) in TABLES {
        wanted.entry(path).or_default().extend(keys_of(toml));
    }
    for (path, keys) in wanted {
        let table = schema.pointer(path).unwrap();
        assert_eq!(table["additionalProperties"], false, "{path}");
        let found: BTreeSet<_> = table["properties"].as_object().unwrap().keys().cloned().collect();
        assert_eq!(found, keys, "{path}");
    }
}

/// Every `key` that a hint can offer stands in the reference, and every field of a material has a key.
#[test]
fn reference_names_every_key() {
    let keys: BTreeSet<String> = TABLES.iter().flat_map(|(toml, _)| keys_of(toml)).collect();
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
            "coat_normal_map" => "coat_normal_texture",
            "anisotropy_direction" => "anisotropy_direction_texture",
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
    assert_eq!(DeTable::parse(example()).unwrap().get_ref().len(), 7);
}
