//! Materials: the metallic-roughness core (specification, section 3.9). The layers that extensions add are in
//! `layers`.

use ajar_scene::{
    AlphaMode, Channel, ColorSpace, Diagnostic, Id, Input, Material, NormalMap, Scene, Texture, TextureInput,
};
use glam::{Vec3, Vec4};
use gltf::json::{self, material::PbrMetallicRoughness, validation::Checked};
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::{Map, Value};

use super::{
    Asset, Context, extensions, gloss, layers,
    texture::{TextureInfo, Textures},
};

/// Opacity from which masked surfaces exist, if the file states none.
const DEFAULT_CUTOFF: f32 = 0.5;

/// The handles of the file's materials.
pub(super) struct Materials {
    ids: Vec<Id<Material>>,
    default: Option<Id<Material>>,
}

impl Materials {
    /// The material of a primitive that names the one at `index`, or none.
    pub fn of(&self, index: Option<usize>) -> Option<Id<Material>> {
        index.map_or(self.default, |index| self.ids.get(index).copied())
    }
}

/// Adds all materials, in file order, and the default one if a primitive has none.
///
/// # Errors
/// A texture's index points beyond the list.
pub(super) fn materials(
    asset: &Asset,
    context: &mut Context,
    scene: &mut Scene,
) -> Result<Materials, Diagnostic> {
    let mut textures = Textures::default();
    let mut ids = Vec::with_capacity(asset.root.materials.len());
    for (i, material) in asset.root.materials.iter().enumerate() {
        let element = format!("materials[{i}]");
        let reader = Reader::new(asset, context, scene, &mut textures, element, material);
        let made = reader.material(material)?;
        ids.push(scene.materials.push(made));
    }
    let mut primitives = asset.root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let default = if primitives.any(|primitive| primitive.material.is_none()) {
        let standard = json::Material { name: Some("default".into()), ..Default::default() };
        let reader = Reader::new(asset, context, scene, &mut textures, "materials".into(), &standard);
        let made = reader.material(&standard)?;
        Some(scene.materials.push(made))
    } else {
        None
    };
    Ok(Materials { ids, default })
}

/// Reads one material.
pub(super) struct Reader<'a, 'b> {
    asset: &'a Asset,
    pub context: &'a mut Context<'b>,
    scene: &'a mut Scene,
    textures: &'a mut Textures,
    pub element: String,
    extensions: Map<String, Value>,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct EmissiveStrength {
    emissive_strength: f32,
}

impl Default for EmissiveStrength {
    fn default() -> Self {
        Self { emissive_strength: 1.0 }
    }
}

/// How a material refers to a normal map.
#[derive(Deserialize)]
pub(super) struct NormalInfo {
    #[serde(flatten)]
    info: TextureInfo,
    #[serde(default = "one")]
    scale: f32,
}

fn one() -> f32 {
    1.0
}

impl From<&json::material::NormalTexture> for NormalInfo {
    fn from(source: &json::material::NormalTexture) -> Self {
        Self { info: TextureInfo::from(source), scale: source.scale }
    }
}

impl<'a, 'b> Reader<'a, 'b> {
    fn new(
        asset: &'a Asset,
        context: &'a mut Context<'b>,
        scene: &'a mut Scene,
        textures: &'a mut Textures,
        element: String,
        material: &json::Material,
    ) -> Self {
        let extensions = material.extensions.as_ref().map(|e| e.others.clone()).unwrap_or_default();
        Self { asset, context, scene, textures, element, extensions }
    }

    fn material(mut self, source: &json::Material) -> Result<Material, Diagnostic> {
        let (base, alpha) = match gloss::read(&mut self)? {
            Some(base) => base,
            None => self.metallic_roughness(&source.pbr_metallic_roughness)?,
        };
        if source.occlusion_texture.is_some() {
            let element = format!("{}.occlusionTexture", self.element);
            self.context.report.note(element, "occlusion is ignored, light transport computes it");
        }
        let alpha_mode = self.alpha_mode(source);
        let opacity = match alpha_mode {
            AlphaMode::Opaque => Input::constant(1.0),
            AlphaMode::Mask(_) | AlphaMode::Blend => {
                scalar(alpha, base.base_color.texture.map(|input| input.texture), Channel::A)
            }
        };
        let mut material = Material {
            name: source.name.clone().unwrap_or_else(|| self.element.clone()),
            emission: self.emission(source)?,
            double_sided: source.double_sided,
            cull_back: !source.double_sided,
            opacity,
            alpha_mode,
            normal_map: self
                .normal_map(source.normal_texture.as_ref().map(NormalInfo::from), "normalTexture")?,
            unlit: self.extensions.contains_key("KHR_materials_unlit"),
            ..base
        };
        layers::add(&mut self, &mut material)?;
        Ok(material)
    }

    /// The base of a material, and its alpha.
    fn metallic_roughness(&mut self, surface: &PbrMetallicRoughness) -> Result<(Material, f32), Diagnostic> {
        let [r, g, b, alpha] = surface.base_color_factor.0;
        let info = surface.base_color_texture.as_ref().map(TextureInfo::from);
        let field = "pbrMetallicRoughness.baseColorFactor";
        let factor = Vec3::new(self.unit(r, field), self.unit(g, field), self.unit(b, field));
        let alpha = self.unit(alpha, field);
        let base_color = self.color(factor, info, "pbrMetallicRoughness.baseColorTexture")?;
        let info = surface.metallic_roughness_texture.as_ref().map(TextureInfo::from);
        let map = self.texture(info, ColorSpace::Raw, "pbrMetallicRoughness.metallicRoughnessTexture")?;
        let metallic = self.unit(surface.metallic_factor.0, "pbrMetallicRoughness.metallicFactor");
        let roughness = self.unit(surface.roughness_factor.0, "pbrMetallicRoughness.roughnessFactor");
        let metallic = scalar(metallic, map, Channel::B);
        let roughness = scalar(roughness, map, Channel::G);
        Ok((Material { base_color, metallic, roughness, ..Material::default() }, alpha))
    }

    fn alpha_mode(&mut self, source: &json::Material) -> AlphaMode {
        match source.alpha_mode {
            Checked::Valid(json::material::AlphaMode::Opaque) => AlphaMode::Opaque,
            Checked::Valid(json::material::AlphaMode::Blend) => AlphaMode::Blend,
            Checked::Valid(json::material::AlphaMode::Mask) => {
                let cutoff = source.alpha_cutoff.map_or(DEFAULT_CUTOFF, |cutoff| cutoff.0);
                if cutoff.is_finite() {
                    return AlphaMode::Mask(cutoff);
                }
                let message = format!("the cutoff is not finite and is taken as {DEFAULT_CUTOFF}");
                self.context.report.approximate(format!("{}.alphaCutoff", self.element), message);
                AlphaMode::Mask(DEFAULT_CUTOFF)
            }
            Checked::Invalid => {
                let element = format!("{}.alphaMode", self.element);
                self.context.report.approximate(element, "unknown alpha mode, taken as OPAQUE");
                AlphaMode::Opaque
            }
        }
    }

    fn emission(&mut self, source: &json::Material) -> Result<Input<Vec3>, Diagnostic> {
        let strength: EmissiveStrength =
            self.extension("KHR_materials_emissive_strength").unwrap_or_default();
        let mut factor = Vec3::from(source.emissive_factor.0) * strength.emissive_strength;
        if !(factor.is_finite() && factor.min_element() >= 0.0) {
            let element = format!("{}.emissiveFactor", self.element);
            self.context.report.warn(element, "the emission is negative or not finite and is dropped");
            factor = Vec3::ZERO;
        }
        self.color(factor, source.emissive_texture.as_ref().map(TextureInfo::from), "emissiveTexture")
    }

    /// A normal map of this material.
    pub fn normal_map(
        &mut self,
        info: Option<NormalInfo>,
        field: &str,
    ) -> Result<Option<NormalMap>, Diagnostic> {
        let Some(NormalInfo { info, mut scale }) = info else { return Ok(None) };
        let texture = self.texture(Some(info), ColorSpace::Raw, field)?;
        if !scale.is_finite() {
            let element = format!("{}.{field}.scale", self.element);
            self.context.report.warn(element, "the scale is not finite and is taken as 1");
            scale = 1.0;
        }
        Ok(texture.map(|texture| NormalMap { texture, scale }))
    }

    /// The extension `name` of this material, or `None` if it is absent or cannot be read.
    pub fn extension<T: DeserializeOwned>(&mut self, name: &str) -> Option<T> {
        extensions::read(Some(&self.extensions), name, &self.element, &mut self.context.report)
    }

    /// A number that must lie between 0 and 1.
    pub fn unit(&mut self, value: f32, field: &str) -> f32 {
        let inside = if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
        if inside != value {
            let element = format!("{}.{field}", self.element);
            self.context.report.approximate(element, "the value does not lie between 0 and 1 and is clamped");
        }
        inside
    }

    /// A texture of this material.
    pub fn texture(
        &mut self,
        info: Option<TextureInfo>,
        color_space: ColorSpace,
        field: &str,
    ) -> Result<Option<Id<Texture>>, Diagnostic> {
        let Some(info) = info else { return Ok(None) };
        let element = format!("{}.{field}", self.element);
        self.textures.get(self.asset, self.context, self.scene, &info, color_space, &element)
    }

    /// The same texture with its values scaled, then raised.
    pub fn scaled(&mut self, texture: Id<Texture>, scale: Vec4, bias: Vec4) -> Id<Texture> {
        let texture = Texture { scale, bias, ..self.scene.textures[texture].clone() };
        self.scene.textures.push(texture)
    }

    /// A colour with an sRGB texture.
    pub fn color(
        &mut self,
        value: Vec3,
        info: Option<TextureInfo>,
        field: &str,
    ) -> Result<Input<Vec3>, Diagnostic> {
        let texture = self.texture(info, ColorSpace::Srgb, field)?;
        Ok(Input { value, texture: texture.map(|texture| TextureInput { texture, channel: Channel::R }) })
    }

    /// A number between 0 and 1 with a channel of a linear texture.
    pub fn scalar(
        &mut self,
        value: f32,
        info: Option<TextureInfo>,
        channel: Channel,
        fields: [&str; 2],
    ) -> Result<Input<f32>, Diagnostic> {
        let [factor, map] = fields;
        let texture = self.texture(info, ColorSpace::Raw, map)?;
        Ok(scalar(self.unit(value, factor), texture, channel))
    }
}

fn scalar(value: f32, texture: Option<Id<Texture>>, channel: Channel) -> Input<f32> {
    Input { value, texture: texture.map(|texture| TextureInput { texture, channel }) }
}
