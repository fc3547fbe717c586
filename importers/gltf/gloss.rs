//! KHR_materials_pbrSpecularGlossiness: a diffuse colour, a reflectance at normal incidence and a glossiness.
//!
//! All of it fits the dielectric of the scene's model: the brightest channel of the reflectance gives the index of
//! refraction, the others and the texture its tint, and roughness is 1 − glossiness. The index is one for all texels, so
//! reflection towards grazing is Schlick's where a texture is dark.

use ajar_scene::{Channel, ColorSpace, Diagnostic, Input, Material, TextureInput};
use glam::{Vec3, Vec4};
use serde::Deserialize;

use super::{layers::index_of, material::Reader, texture::TextureInfo};

/// The extension's name.
const NAME: &str = "KHR_materials_pbrSpecularGlossiness";

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct SpecularGlossiness {
    diffuse_factor: [f32; 4],
    diffuse_texture: Option<TextureInfo>,
    specular_factor: [f32; 3],
    glossiness_factor: f32,
    specular_glossiness_texture: Option<TextureInfo>,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        Self {
            diffuse_factor: [1.0; 4],
            diffuse_texture: None,
            specular_factor: [1.0; 3],
            glossiness_factor: 1.0,
            specular_glossiness_texture: None,
        }
    }
}

/// The base of a material that has the extension, and its alpha.
pub(super) fn read(reader: &mut Reader) -> Result<Option<(Material, f32)>, Diagnostic> {
    let Some(found): Option<SpecularGlossiness> = reader.extension(NAME) else { return Ok(None) };
    let field = |name: &str| format!("extensions.{NAME}.{name}");
    let [r, g, b, alpha] = found.diffuse_factor.map(|x| reader.unit(x, &field("diffuseFactor")));
    let base_color = reader.color(Vec3::new(r, g, b), found.diffuse_texture, &field("diffuseTexture"))?;
    let specular = Vec3::from(found.specular_factor.map(|x| reader.unit(x, &field("specularFactor"))));
    let glossiness = reader.unit(found.glossiness_factor, &field("glossinessFactor"));
    let (brightest, map) = (specular.max_element(), field("specularGlossinessTexture"));
    let tint = if brightest > 0.0 { specular / brightest } else { Vec3::ONE };
    let info = found.specular_glossiness_texture;
    let roughness = match reader.texture(info.clone(), ColorSpace::Srgb, &map)? {
        Some(texture) => {
            let (scale, bias) = (Vec4::splat(-glossiness), Vec4::ONE);
            let texture = reader.scaled(texture, scale, bias);
            Input { value: 1.0, texture: Some(TextureInput { texture, channel: Channel::A }) }
        }
        None => Input::constant(1.0 - glossiness),
    };
    let material = Material {
        base_color,
        metallic: Input::constant(0.0),
        roughness,
        ior: index_of(brightest),
        specular: Input::constant(if brightest > 0.0 { 1.0 } else { 0.0 }),
        specular_color: reader.color(tint, info, &map)?,
        ..Material::default()
    };
    Ok(Some((material, alpha)))
}
