//! What extensions add to materials: anisotropy, sheen, iridescence, dispersion, diffuse transmission.
//! Sources: the README of each extension in the repository of the specification.

use ajar_scene::{Channel, ColorSpace, Diagnostic, Input, Material, TextureInput};
use glam::{Vec3, Vec4};
use serde::Deserialize;

use super::{material::Reader, texture::TextureInfo};

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Anisotropy {
    anisotropy_strength: f32,
    anisotropy_rotation: f32,
    anisotropy_texture: Option<TextureInfo>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Sheen {
    sheen_color_factor: [f32; 3],
    sheen_color_texture: Option<TextureInfo>,
    sheen_roughness_factor: f32,
    sheen_roughness_texture: Option<TextureInfo>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Iridescence {
    iridescence_factor: f32,
    iridescence_texture: Option<TextureInfo>,
    iridescence_ior: Option<f32>,
    iridescence_thickness_minimum: Option<f32>,
    iridescence_thickness_maximum: Option<f32>,
    iridescence_thickness_texture: Option<TextureInfo>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Dispersion {
    dispersion: f32,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct DiffuseTransmission {
    diffuse_transmission_factor: f32,
    diffuse_transmission_texture: Option<TextureInfo>,
    diffuse_transmission_color_factor: Option<[f32; 3]>,
    diffuse_transmission_color_texture: Option<TextureInfo>,
}

/// Adds the effects that the material's extensions describe.
pub(super) fn add(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    anisotropy(reader, material)?;
    sheen(reader, material)?;
    iridescence(reader, material)?;
    dispersion(reader, material);
    diffuse_transmission(reader, material)
}

fn anisotropy(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    const NAME: &str = "extensions.KHR_materials_anisotropy";
    let Some(found): Option<Anisotropy> = reader.extension("KHR_materials_anisotropy") else { return Ok(()) };
    let fields = [&*format!("{NAME}.anisotropyStrength"), &*format!("{NAME}.anisotropyTexture")];
    let strength = found.anisotropy_strength;
    material.anisotropy = reader.scalar(strength, found.anisotropy_texture, Channel::B, fields)?;
    material.anisotropy_direction = material.anisotropy.texture.map(|input| input.texture);
    if found.anisotropy_rotation.is_finite() {
        material.anisotropy_rotation = found.anisotropy_rotation;
    } else {
        material.anisotropy = Input::constant(0.0);
        material.anisotropy_direction = None;
        let element = format!("{}.{NAME}.anisotropyRotation", reader.element);
        reader.context.report.warn(element, "the rotation is not finite; the anisotropy is dropped");
    }
    Ok(())
}

fn sheen(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    const NAME: &str = "extensions.KHR_materials_sheen";
    let Some(sheen): Option<Sheen> = reader.extension("KHR_materials_sheen") else { return Ok(()) };
    let field = format!("{NAME}.sheenColorFactor");
    let color = Vec3::from(sheen.sheen_color_factor.map(|channel| reader.unit(channel, &field)));
    let field = format!("{NAME}.sheenColorTexture");
    material.sheen_color = reader.color(color, sheen.sheen_color_texture, &field)?;
    let fields = [&*format!("{NAME}.sheenRoughnessFactor"), &*format!("{NAME}.sheenRoughnessTexture")];
    let (factor, map) = (sheen.sheen_roughness_factor, sheen.sheen_roughness_texture);
    material.sheen_roughness = reader.scalar(factor, map, Channel::A, fields)?;
    Ok(())
}

fn iridescence(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    const NAME: &str = "extensions.KHR_materials_iridescence";
    let Some(found): Option<Iridescence> = reader.extension("KHR_materials_iridescence") else {
        return Ok(());
    };
    let fields = [&*format!("{NAME}.iridescenceFactor"), &*format!("{NAME}.iridescenceTexture")];
    material.film = reader.scalar(found.iridescence_factor, found.iridescence_texture, Channel::R, fields)?;
    let mut positive = |value: Option<f32>, default: f32, least: f32, field: &str| {
        let value = value.unwrap_or(default);
        if value.is_finite() && value >= least {
            return value;
        }
        let element = format!("{}.{NAME}.{field}", reader.element);
        let message = format!("the value is less than {least} or not finite; {default} is used");
        reader.context.report.warn(element, message);
        default
    };
    material.film_ior = positive(found.iridescence_ior, 1.3, 1.0, "iridescenceIor");
    let low = positive(found.iridescence_thickness_minimum, 100.0, 0.0, "iridescenceThicknessMinimum");
    let high = positive(found.iridescence_thickness_maximum, 400.0, 0.0, "iridescenceThicknessMaximum");
    let field = format!("{NAME}.iridescenceThicknessTexture");
    let map = reader.texture(found.iridescence_thickness_texture, ColorSpace::Raw, &field)?;
    material.film_thickness = match map {
        None => Input::constant(high),
        Some(map) => {
            let texture = reader.scaled(map, Vec4::splat(high - low), Vec4::splat(low));
            Input { value: 1.0, texture: Some(TextureInput { texture, channel: Channel::G }) }
        }
    };
    Ok(())
}

fn dispersion(reader: &mut Reader, material: &mut Material) {
    let Some(Dispersion { dispersion }) = reader.extension("KHR_materials_dispersion") else { return };
    if dispersion.is_finite() && dispersion >= 0.0 {
        material.dispersion = dispersion;
    } else {
        let element = format!("{}.extensions.KHR_materials_dispersion.dispersion", reader.element);
        reader.context.report.warn(element, "the dispersion is negative or not finite and is dropped");
    }
}

fn diffuse_transmission(reader: &mut Reader, material: &mut Material) -> Result<(), Diagnostic> {
    const NAME: &str = "extensions.KHR_materials_diffuse_transmission";
    let Some(found): Option<DiffuseTransmission> = reader.extension("KHR_materials_diffuse_transmission")
    else {
        return Ok(());
    };
    let fields =
        [&*format!("{NAME}.diffuseTransmissionFactor"), &*format!("{NAME}.diffuseTransmissionTexture")];
    let (factor, map) = (found.diffuse_transmission_factor, found.diffuse_transmission_texture);
    material.diffuse_transmission = reader.scalar(factor, map, Channel::A, fields)?;
    let field = format!("{NAME}.diffuseTransmissionColorFactor");
    let color = found.diffuse_transmission_color_factor.unwrap_or([1.0; 3]);
    let color = Vec3::from(color.map(|channel| reader.unit(channel, &field)));
    let field = format!("{NAME}.diffuseTransmissionColorTexture");
    let map = found.diffuse_transmission_color_texture;
    material.diffuse_transmission_color = reader.color(color, map, &field)?;
    Ok(())
}
