//! Textures as scene files read them.

use glam::{Vec2, Vec4};

use super::{right, wrong};
use crate::{Channel, Texture, TextureInput, Wrap};

/// The texture of `key` in a table about the material "Glass".
fn read(key: &str, table: &str) -> (Texture, TextureInput) {
    let toml =
        format!("[[import]]\nfile = \"a.glb\"\n[material.Glass]\n{key} = {{ file = \"t.png\", {table} }}\n");
    let scene = right(&toml, &["a.glb", "t.png"]).scene;
    let material = scene.materials.iter().find(|it| it.name == "Glass").unwrap();
    let input = match key {
        "base_color_texture" => material.base_color.texture,
        "roughness_texture" => material.roughness.texture,
        _ => material.normal_map.map(|map| TextureInput { texture: map.texture, channel: Channel::R }),
    };
    let input = input.unwrap();
    (scene.textures[input.texture].clone(), input)
}

#[test]
fn coordinates_are_scaled_then_turned_then_moved() {
    let at = |table: &str, uv: [f32; 2]| {
        read("base_color_texture", table).0.transform.transform_point2(Vec2::from(uv))
    };
    assert_eq!(at("uv_scale = 2", [0.25, 0.5]), Vec2::new(0.5, 1.0));
    assert_eq!(at("uv_scale = [2, 3]", [1.0, 1.0]), Vec2::new(2.0, 3.0));
    assert_eq!(at("uv_offset = [0.5, -1]", [0.25, 0.5]), Vec2::new(0.75, -0.5));
    // Counter-clockwise where v points down: from u upwards.
    assert!(at("uv_rotate = 90", [1.0, 0.0]).abs_diff_eq(Vec2::new(0.0, -1.0), 1e-6));
    let all = at("uv_scale = [2, 1], uv_rotate = 90, uv_offset = [10, 0]", [1.0, 0.0]);
    assert!(all.abs_diff_eq(Vec2::new(10.0, -2.0), 1e-6));
}

#[test]
fn directions_wrap_by_themselves() {
    let wraps = |table: &str| {
        let texture = read("base_color_texture", table).0;
        (texture.wrap_u, texture.wrap_v)
    };
    assert_eq!(wraps("wrap = \"clamp\""), (Wrap::Clamp, Wrap::Clamp));
    assert_eq!(wraps("wrap_u = \"clamp\""), (Wrap::Clamp, Wrap::Repeat));
    assert_eq!(wraps("wrap = \"black\", wrap_v = \"mirror\""), (Wrap::Black, Wrap::Mirror));
}

#[test]
fn what_is_read_is_scaled_and_moved() {
    let (gloss, input) = read("roughness_texture", "scale = -1, bias = 1, channel = \"l\"");
    assert_eq!((gloss.scale, gloss.bias, input.channel), (-Vec4::ONE, Vec4::ONE, Channel::L));
    let (map, _) = read("normal_texture", "scale = [1, -1, 1], bias = [0, 1, 0]");
    let down = Vec4::new(0.25, 0.75, 1.0, 1.0) * map.scale + map.bias;
    assert_eq!(down.truncate(), glam::Vec3::new(0.25, 0.25, 1.0));
}

#[test]
fn mistakes_are_named() {
    for (key, table, says) in [
        ("roughness_texture", "scale = [1, 1, 1]", "roughness_texture.scale: expected a number, found array"),
        ("base_color_texture", "uv_scale = [1, 2, 3]", "uv_scale: expected a list of 2 numbers, found 3"),
        ("base_color_texture", "uv_rotate = inf", "uv_rotate: must be finite"),
        ("base_color_texture", "wrap_u = \"tile\"", "wrap_u: \"tile\" is not known here"),
        ("base_color_texture", "channel = \"r\"", "channel: unknown key"),
    ] {
        let toml = format!("[material.\"*\"]\n{key} = {{ file = \"t.png\", {table} }}\n");
        let errors = wrong(&toml, &["t.png"]);
        assert!(errors.iter().any(|error| error.contains(says)), "{toml}\n{errors:#?}");
    }
}
