//! What extensions add to materials: transmission, volume, index of refraction, specular, clear coat, anisotropy.
//! Sources: the README of each extension in the repository of the specification.

use ajar_scene::{Channel, Diagnostic, Input, Material};
use glam::Vec3;
use serde::Deserialize;

use super::{material::Reader, texture::TextureInfo};

/// Stands for the special index 0 of KHR_materials_ior, which reflects everything: F₀ = 0.996.
const MIRROR_IOR: f32 = 1000.0;

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Transmission {
    transmission_factor: f32,
    transmission_texture: Option<TextureInfo>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Volume {
    thickness_factor: f32,
    attenuation_distance: Option<f32>,
    attenuation_color: Option<[f32; 3]>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Ior {
    ior: Option<f32>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Specular {
    specular_factor: Option<f32>,
    specular_texture: Option<TextureInfo>,
    specular_color_factor: Option<[f32; 3]>,
    specular_color_texture: Option<TextureInfo>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<TextureInfo>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<TextureInfo>,
    clearcoat_normal_texture: Option<TextureInfo>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Anisotropy {
    anisotropy_strength: f32,
    anisotropy_rotation: f32,
    anisotropy_texture: Option<TextureInfo>,
}

/// Adds the layers that the material's extensions describe.
pub(super) fn add(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    ior(reader, material);
    transmission(reader, material)?;
    specular(reader, material)?;
    clearcoat(reader, material)?;
    anisotropy(reader, material)
}

fn ior(reader: &mut Reader, material: &mut Material) {
    let Some(Ior { ior: Some(ior) }) = reader.extension("KHR_materials_ior") else { return };
    let element = format!("{}.extensions.KHR_materials_ior.ior", reader.element);
    material.ior = if ior == 0.0 {
        reader
            .context
            .report
            .approximate(element, format!("an index of 0 is approximated by one of {MIRROR_IOR}"));
        MIRROR_IOR
    } else if ior.is_finite() && ior >= 1.0 {
        ior
    } else {
        reader
            .context
            .report
            .approximate(element, "the index of refraction is less than 1 or not finite; 1.5 is used");
        1.5
    };
}

fn transmission(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    const NAME: &str = "extensions.KHR_materials_transmission";
    let volume: Volume = reader.extension("KHR_materials_volume").unwrap_or_default();
    let Some(Transmission { transmission_factor, transmission_texture }) =
        reader.extension("KHR_materials_transmission")
    else {
        return Ok(());
    };
    let fields = [&*format!("{NAME}.transmissionFactor"), &*format!("{NAME}.transmissionTexture")];
    material.transmission = reader.scalar(transmission_factor, transmission_texture, Channel::R, fields)?;
    material.thin_walled = volume.thickness_factor.is_nan() || volume.thickness_factor <= 0.0;
    if material.thin_walled {
        return Ok(());
    }
    if let Some(color) = volume.attenuation_color {
        let field = "extensions.KHR_materials_volume.attenuationColor";
        material.attenuation_color = Vec3::from(color.map(|channel| reader.unit(channel, field)));
    }
    if let Some(distance) = volume.attenuation_distance {
        if distance > 0.0 {
            material.attenuation_distance = distance;
        } else {
            let element = format!("{}.extensions.KHR_materials_volume.attenuationDistance", reader.element);
            reader.context.report.approximate(element, "the distance is not positive; nothing is absorbed");
        }
    }
    Ok(())
}

fn specular(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    const NAME: &str = "extensions.KHR_materials_specular";
    let Some(specular): Option<Specular> = reader.extension("KHR_materials_specular") else { return Ok(()) };
    let fields = [&*format!("{NAME}.specularFactor"), &*format!("{NAME}.specularTexture")];
    let factor = specular.specular_factor.unwrap_or(1.0);
    material.specular = reader.scalar(factor, specular.specular_texture, Channel::A, fields)?;
    let mut color = Vec3::from(specular.specular_color_factor.unwrap_or([1.0; 3]));
    if !(color.is_finite() && color.min_element() >= 0.0) {
        let element = format!("{}.{NAME}.specularColorFactor", reader.element);
        reader.context.report.approximate(element, "the colour is negative or not finite; white is used");
        color = Vec3::ONE;
    }
    let field = format!("{NAME}.specularColorTexture");
    material.specular_color = reader.color(color, specular.specular_color_texture, &field)?;
    if color.max_element() > 1.0 {
        raise_index(reader, material, color.max_element());
    }
    Ok(())
}

/// Colours above 1 raise the reflectance at normal incidence F₀ = ((n − 1) / (n + 1))². The same reflection comes from a
/// higher index and a colour within 1; only refraction tells them apart.
fn raise_index(reader: &mut Reader, material: &mut Material, brightest: f32) {
    material.ior = index_of(reflectance(material.ior) * brightest);
    material.specular_color.value /= brightest;
    if material.transmission.value > 0.0 {
        let element = format!("{}.extensions.KHR_materials_specular.specularColorFactor", reader.element);
        reader
            .context
            .report
            .approximate(element, "a colour above 1 is approximated by a higher index of refraction");
    }
}

/// What a boundary of this index reflects at normal incidence.
fn reflectance(ior: f32) -> f32 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

/// The index of refraction that reflects this much at normal incidence.
pub(super) fn index_of(normal: f32) -> f32 {
    let root = normal.min(reflectance(MIRROR_IOR)).sqrt();
    (1.0 + root) / (1.0 - root)
}

fn clearcoat(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    const NAME: &str = "extensions.KHR_materials_clearcoat";
    let Some(coat): Option<Clearcoat> = reader.extension("KHR_materials_clearcoat") else { return Ok(()) };
    let fields = [&*format!("{NAME}.clearcoatFactor"), &*format!("{NAME}.clearcoatTexture")];
    material.coat = reader.scalar(coat.clearcoat_factor, coat.clearcoat_texture, Channel::R, fields)?;
    let fields =
        [&*format!("{NAME}.clearcoatRoughnessFactor"), &*format!("{NAME}.clearcoatRoughnessTexture")];
    let (factor, map) = (coat.clearcoat_roughness_factor, coat.clearcoat_roughness_texture);
    material.coat_roughness = reader.scalar(factor, map, Channel::G, fields)?;
    if coat.clearcoat_normal_texture.is_some() {
        let element = format!("{}.{NAME}.clearcoatNormalTexture", reader.element);
        reader.context.report.warn(element, "normal maps of coats are dropped");
    }
    Ok(())
}

fn anisotropy(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    const NAME: &str = "extensions.KHR_materials_anisotropy";
    let Some(found): Option<Anisotropy> = reader.extension("KHR_materials_anisotropy") else { return Ok(()) };
    if found.anisotropy_texture.is_some() {
        let element = format!("{}.{NAME}.anisotropyTexture", reader.element);
        reader
            .context
            .report
            .warn(element, "the directions of the anisotropy texture are dropped, its strength is used");
    }
    let fields = [&*format!("{NAME}.anisotropyStrength"), &*format!("{NAME}.anisotropyTexture")];
    material.anisotropy =
        reader.scalar(found.anisotropy_strength, found.anisotropy_texture, Channel::B, fields)?;
    if found.anisotropy_rotation.is_finite() {
        material.anisotropy_rotation = found.anisotropy_rotation;
    } else {
        material.anisotropy = Input::constant(0.0);
        let element = format!("{}.{NAME}.anisotropyRotation", reader.element);
        reader.context.report.warn(element, "the rotation is not finite; the anisotropy is dropped");
    }
    Ok(())
}
