//! Material extensions.

use ajar_scene::{Channel, ColorSpace, Input, Material};
use glam::Vec3;
use serde_json::{Value, json};

use crate::{
    build::Asset,
    failure,
    materials::{material, texture},
    warnings,
};

pub fn extended(extensions: Value) -> Material {
    material(json!({"extensions": extensions})).0
}

/// The material and the warnings that it causes.
pub fn warned(definition: Value) -> (Material, Vec<String>) {
    let imported = Asset::with_material(definition).import().unwrap();
    (imported.scene.materials.iter().next().unwrap().clone(), warnings(&imported))
}

#[test]
fn emissive_strength_multiplies() {
    let strength = json!({"KHR_materials_emissive_strength": {"emissiveStrength": 1000}});
    let (material, _) = material(json!({"emissiveFactor": [1, 0.5, 0], "extensions": strength}));
    assert_eq!(material.emission.value, Vec3::new(1000.0, 500.0, 0.0));
}

#[test]
fn unlit() {
    assert!(extended(json!({"KHR_materials_unlit": {}})).unlit);
    assert!(!extended(json!({})).unlit);
}

#[test]
fn index_of_refraction() {
    assert_eq!(extended(json!({"KHR_materials_ior": {"ior": 1.33}})).ior, 1.33);
    assert_eq!(extended(json!({"KHR_materials_ior": {}})).ior, 1.5);
    let (material, warnings) = warned(json!({"extensions": {"KHR_materials_ior": {"ior": 0}}}));
    assert_eq!(material.ior, 1000.0);
    let element = "materials[0].extensions.KHR_materials_ior.ior";
    assert_eq!(warnings, [format!("{element}: an index of 0 is approximated by one of 1000")]);
    let (material, warnings) = warned(json!({"extensions": {"KHR_materials_ior": {"ior": 0.9}}}));
    assert_eq!((material.ior, warnings.len()), (1.5, 1));
}

#[test]
fn transmission_is_thin_unless_there_is_a_volume() {
    let transmission = json!({"transmissionFactor": 0.75, "transmissionTexture": {"index": 0}});
    let (thin, imported) = material(json!({"extensions": {"KHR_materials_transmission": transmission}}));
    assert_eq!((thin.transmission.value, thin.thin_walled), (0.75, true));
    let (map, channel) = texture(&imported, &thin.transmission);
    assert_eq!((map.color_space, channel), (ColorSpace::Raw, Channel::R));

    let volume = |thickness: f32| {
        extended(json!({
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {
                "thicknessFactor": thickness, "attenuationDistance": 0.5, "attenuationColor": [0.25, 0.5, 1],
            },
        }))
    };
    let thick = volume(0.1);
    assert!(!thick.thin_walled);
    assert_eq!((thick.attenuation_distance, thick.attenuation_color), (0.5, Vec3::new(0.25, 0.5, 1.0)));
    let thin = volume(0.0);
    assert!(thin.thin_walled);
    assert_eq!((thin.attenuation_distance, thin.attenuation_color), (f32::INFINITY, Vec3::ONE));
    assert!(!extended(json!({})).thin_walled);
}

#[test]
fn a_volume_without_distance_absorbs_nothing() {
    let with = |distance: Value| {
        json!({"extensions": {
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": distance},
        }})
    };
    let (material, warnings) = warned(with(json!(null)));
    assert_eq!((material.attenuation_distance, warnings.len()), (f32::INFINITY, 0));
    let (material, warnings) = warned(with(json!(0)));
    assert_eq!((material.attenuation_distance, warnings.len()), (f32::INFINITY, 1));
}

#[test]
fn specular() {
    let (made, imported) = material(json!({"extensions": {"KHR_materials_specular": {
        "specularFactor": 0.5, "specularTexture": {"index": 0},
        "specularColorFactor": [0.25, 0.5, 1], "specularColorTexture": {"index": 0},
    }}}));
    assert_eq!((made.specular.value, made.specular_color.value), (0.5, Vec3::new(0.25, 0.5, 1.0)));
    let (map, channel) = texture(&imported, &made.specular);
    assert_eq!((map.color_space, channel), (ColorSpace::Raw, Channel::A));
    assert_eq!(texture(&imported, &made.specular_color).0.color_space, ColorSpace::Srgb);
    assert_eq!(extended(json!({"KHR_materials_specular": {}})).specular, Input::constant(1.0));
}

#[test]
fn specular_colours_above_one_keep_their_reflectance() {
    let made = extended(json!({"KHR_materials_specular": {"specularColorFactor": [4, 2, 0]}}));
    let normal = ((made.ior - 1.0) / (made.ior + 1.0)).powi(2);
    // 0.04 · (4, 2, 0)
    assert!((normal * made.specular_color.value).abs_diff_eq(Vec3::new(0.16, 0.08, 0.0), 1e-6));
    assert_eq!(made.specular_color.value, Vec3::new(1.0, 0.5, 0.0));
    let extensions = json!({
        "KHR_materials_specular": {"specularColorFactor": [2, 2, 2]},
        "KHR_materials_transmission": {"transmissionFactor": 1},
    });
    assert_eq!(warned(json!({"extensions": extensions})).1.len(), 1);
}

#[test]
fn clear_coat() {
    let coat = json!({
        "clearcoatFactor": 0.75, "clearcoatTexture": {"index": 0},
        "clearcoatRoughnessFactor": 0.25, "clearcoatRoughnessTexture": {"index": 0},
    });
    let (made, imported) = material(json!({"extensions": {"KHR_materials_clearcoat": coat}}));
    assert_eq!((made.coat.value, made.coat_roughness.value, made.coat_ior), (0.75, 0.25, 1.5));
    assert_eq!(texture(&imported, &made.coat).1, Channel::R);
    assert_eq!(texture(&imported, &made.coat_roughness).1, Channel::G);

    let coat = json!({"clearcoatFactor": 1, "clearcoatNormalTexture": {"index": 0, "scale": 0.5}});
    let (made, warnings) = warned(json!({"extensions": {"KHR_materials_clearcoat": coat}}));
    assert_eq!((made.coat_normal_map.unwrap().scale, made.normal_map, warnings.len()), (0.5, None, 0));
}

#[test]
fn extensions_that_cannot_be_read_are_ignored_with_a_warning() {
    let (made, warnings) =
        warned(json!({"extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": "much"}}}));
    assert_eq!(made.coat, Input::constant(0.0));
    let start = "materials[0].extensions.KHR_materials_clearcoat.clearcoatFactor: the extension is ignored: ";
    assert!(warnings.len() == 1 && warnings[0].starts_with(start), "{warnings:?}");
    let extension = json!({"clearcoatFactor": 1, "clearcoatTexture": {"index": 9}});
    let asset = Asset::with_material(json!({"extensions": {"KHR_materials_clearcoat": extension}}));
    assert_eq!(failure(&asset).0, "materials[0].extensions.KHR_materials_clearcoat.clearcoatTexture.index");
}
