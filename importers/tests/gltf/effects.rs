//! Anisotropy, sheen, iridescence, dispersion, diffuse transmission.

use ajar_scene::{Channel, ColorSpace, Input};
use glam::{Vec3, Vec4};
use serde_json::json;

use crate::{
    layers::{extended, warned},
    materials::{material, texture},
};

#[test]
fn anisotropy() {
    let found = json!({"anisotropyStrength": 0.5, "anisotropyRotation": 1.25});
    let made = extended(json!({"KHR_materials_anisotropy": found}));
    assert_eq!((made.anisotropy, made.anisotropy_rotation), (Input::constant(0.5), 1.25));
    assert_eq!(made.anisotropy_direction, None);
    let found = json!({"anisotropyStrength": 0.5, "anisotropyTexture": {"index": 0}});
    let (made, warnings) = warned(json!({"extensions": {"KHR_materials_anisotropy": found}}));
    let strength = made.anisotropy.texture.unwrap();
    assert_eq!((strength.channel, made.anisotropy_direction), (Channel::B, Some(strength.texture)));
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn sheen() {
    let found = json!({
        "sheenColorFactor": [0.1, 0.2, 1.0], "sheenColorTexture": {"index": 0},
        "sheenRoughnessFactor": 0.25, "sheenRoughnessTexture": {"index": 0},
    });
    let (made, imported) = material(json!({"extensions": {"KHR_materials_sheen": found}}));
    assert_eq!((made.sheen_color.value, made.sheen_roughness.value), (Vec3::new(0.1, 0.2, 1.0), 0.25));
    assert_eq!(
        imported.scene.textures[made.sheen_color.texture.unwrap().texture].color_space,
        ColorSpace::Srgb
    );
    let (map, channel) = texture(&imported, &made.sheen_roughness);
    assert_eq!((map.color_space, channel), (ColorSpace::Raw, Channel::A));
    assert_eq!(extended(json!({"KHR_materials_sheen": {}})).sheen_color.value, Vec3::ZERO);
}

#[test]
fn iridescence() {
    let found = json!({"iridescenceFactor": 1, "iridescenceIor": 1.8, "iridescenceThicknessMaximum": 550});
    let made = extended(json!({"KHR_materials_iridescence": found}));
    assert_eq!(
        (made.film, made.film_ior, made.film_thickness),
        (Input::constant(1.0), 1.8, Input::constant(550.0))
    );
    let found = json!({"iridescenceFactor": 1, "iridescenceThicknessTexture": {"index": 0}});
    let (made, imported) = material(json!({"extensions": {"KHR_materials_iridescence": found}}));
    let (map, channel) = texture(&imported, &made.film_thickness);
    assert_eq!((made.film_ior, made.film_thickness.value, channel), (1.3, 1.0, Channel::G));
    // 0 is the least thickness, 100 nm, and 1 the greatest, 400 nm.
    assert_eq!((map.scale, map.bias), (Vec4::splat(300.0), Vec4::splat(100.0)));
    let found = json!({"iridescenceFactor": 1, "iridescenceIor": 0.5});
    let (made, warnings) = warned(json!({"extensions": {"KHR_materials_iridescence": found}}));
    assert_eq!((made.film_ior, warnings.len()), (1.3, 1));
}

#[test]
fn dispersion() {
    assert_eq!(extended(json!({"KHR_materials_dispersion": {"dispersion": 0.5}})).dispersion, 0.5);
    let (made, warnings) = warned(json!({"extensions": {"KHR_materials_dispersion": {"dispersion": -1}}}));
    assert_eq!((made.dispersion, warnings.len()), (0.0, 1));
}

#[test]
fn diffuse_transmission_may_bound_a_volume() {
    let found = json!({
        "diffuseTransmissionFactor": 0.75, "diffuseTransmissionTexture": {"index": 0},
        "diffuseTransmissionColorFactor": [1, 0.5, 0.25],
    });
    let volume = json!({"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 1, 1]});
    let (made, imported) = material(json!({"extensions": {
        "KHR_materials_diffuse_transmission": found, "KHR_materials_volume": volume,
    }}));
    assert_eq!(made.diffuse_transmission.value, 0.75);
    assert_eq!(made.diffuse_transmission_color, Input::constant(Vec3::new(1.0, 0.5, 0.25)));
    assert_eq!(texture(&imported, &made.diffuse_transmission).1, Channel::A);
    assert_eq!((made.attenuation_distance, made.transmission.value), (2.0, 0.0));
}
