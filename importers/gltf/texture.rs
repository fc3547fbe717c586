//! Textures: a `textureInfo` with its sampler and transform becomes a texture of the scene, equal ones become one.

use std::collections::{HashMap, hash_map::Entry};

use ajar_scene::{ColorSpace, Diagnostic, Filter, Id, Scene, Texture, Wrap};
use glam::{Affine2, Mat2, Vec2};
use gltf::json::{
    material::NormalTexture,
    texture::{Info, MagFilter, Sampler, WrappingMode},
    validation::Checked,
};
use serde::Deserialize;
use serde_json::{Map, Value};

use super::{Asset, Context, at, extensions, image::Images};

/// How a material refers to a texture, in the core or in an extension.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct TextureInfo {
    index: u32,
    #[serde(default, rename = "texCoord")]
    set: u32,
    #[serde(default)]
    extensions: Map<String, Value>,
}

impl From<&Info> for TextureInfo {
    fn from(info: &Info) -> Self {
        let extensions = info.extensions.as_ref().map(|e| e.others.clone()).unwrap_or_default();
        Self { index: info.index.value() as u32, set: info.tex_coord, extensions }
    }
}

impl From<&NormalTexture> for TextureInfo {
    fn from(info: &NormalTexture) -> Self {
        let extensions = info.extensions.as_ref().map(|e| e.others.clone()).unwrap_or_default();
        Self { index: info.index.value() as u32, set: info.tex_coord, extensions }
    }
}

/// KHR_texture_transform.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Transform {
    offset: [f32; 2],
    rotation: f32,
    scale: [f32; 2],
    tex_coord: Option<u32>,
}

impl Default for Transform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

impl Transform {
    /// Translation × rotation × scale. The rotation is counter-clockwise as one sees the image; since `v` points down,
    /// its sine has the other sign than in a space that points up.
    fn affine(&self) -> Affine2 {
        let (sin, cos) = self.rotation.sin_cos();
        let [x, y] = self.scale;
        Affine2::from_mat2_translation(
            Mat2::from_cols(Vec2::new(cos, -sin) * x, Vec2::new(sin, cos) * y),
            Vec2::from(self.offset),
        )
    }
}

/// EXT_texture_webp and extensions of the same shape.
#[derive(Deserialize)]
struct Source {
    source: Option<u32>,
}

/// The textures made so far.
#[derive(Default)]
pub(super) struct Textures {
    images: Images,
    made: HashMap<[u32; 12], Id<Texture>>,
}

impl Textures {
    /// The texture that `info` means; `None`, with a warning, if its image cannot be had.
    ///
    /// # Errors
    /// An index points beyond its list.
    pub fn get(
        &mut self,
        asset: &Asset,
        context: &mut Context,
        scene: &mut Scene,
        info: &TextureInfo,
        color_space: ColorSpace,
        element: &str,
    ) -> Result<Option<Id<Texture>>, Diagnostic> {
        let index = info.index as usize;
        let texture = at(&asset.root.textures, index, "textures", &format!("{element}.index"))?;
        let own = format!("textures[{index}]");
        let others = texture.extensions.as_ref().map(|e| &e.others);
        let webp: Option<Source> = extensions::read(others, "EXT_texture_webp", &own, &mut context.report);
        let plain = Some(texture.source.value()).filter(|&source| source != u32::MAX as usize);
        let Some(image) = webp.and_then(|webp| webp.source).map(|source| source as usize).or(plain) else {
            context.report.warn(own, "the texture has no image that can be read and is dropped");
            return Ok(None);
        };
        let Some(image) = self.images.get(asset, context, scene, image, &own)? else { return Ok(None) };

        let transform: Option<Transform> =
            extensions::read(Some(&info.extensions), "KHR_texture_transform", element, &mut context.report);
        let transform = transform.unwrap_or_default();
        let mut made = Texture::new(image);
        made.color_space = color_space;
        made.uv_set = transform.tex_coord.unwrap_or(info.set);
        made.transform = transform.affine();
        if !made.transform.is_finite() {
            context.report.warn(element, "the texture transform is not finite and is ignored");
            made.transform = Affine2::IDENTITY;
        }
        let sampler = texture.sampler.and_then(|sampler| asset.root.samplers.get(sampler.value()));
        if let Some(sampler) = sampler {
            sample(&mut made, sampler, context, &own);
        }
        Ok(Some(match self.made.entry(key(&made)) {
            Entry::Occupied(entry) => *entry.get(),
            Entry::Vacant(entry) => *entry.insert(scene.textures.push(made)),
        }))
    }
}

fn sample(texture: &mut Texture, sampler: &Sampler, context: &mut Context, element: &str) {
    let mut wrap = |mode: &Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) => Wrap::Repeat,
        Checked::Invalid => {
            context.report.approximate(element, "unknown wrapping mode, taken as repeat");
            Wrap::Repeat
        }
    };
    texture.wrap_u = wrap(&sampler.wrap_s);
    texture.wrap_v = wrap(&sampler.wrap_t);
    texture.filter = match sampler.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
        Some(Checked::Valid(MagFilter::Linear)) | None => Filter::Linear,
        Some(Checked::Invalid) => {
            context.report.approximate(element, "unknown magnification filter, taken as linear");
            Filter::Linear
        }
    };
}

/// All that distinguishes the textures of this format.
fn key(texture: &Texture) -> [u32; 12] {
    let [a, b, c, d, e, f] = texture.transform.to_cols_array().map(f32::to_bits);
    [
        texture.image.index() as u32,
        texture.color_space as u32,
        texture.wrap_u as u32,
        texture.wrap_v as u32,
        texture.filter as u32,
        texture.uv_set,
        a,
        b,
        c,
        d,
        e,
        f,
    ]
}
