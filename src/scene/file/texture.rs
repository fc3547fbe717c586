//! Textures that the scene file names: `"wood.png"`, or a table with the way the image is read.

use std::path::{Path, PathBuf};

use glam::{Affine2, DVec3, Mat2, Vec2, Vec3, Vec4};
use toml::de::DeValue;

use super::{
    VariedImport,
    keys::Keys,
    report::Complaint,
    source::Source,
    value::{ANY, choice, number, numbers, text, vector, whole},
};
use crate::{
    Channel, ColorSpace, Filter, Id, Image, ImageSource, Preference, Scene, Texture, TextureInput, Wrap,
};

/// What a texture is for; decides how its numbers are read by default.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Use {
    /// A colour: sRGB, or raw for formats of light (`.hdr`, `.exr`).
    Color,
    /// One channel, raw.
    Scalar,
    /// A vector, raw.
    Normal,
}

/// The scene that is being put together, and the files it came from.
#[derive(Default)]
pub(super) struct Assets {
    pub scene: Scene,
    pub files: Vec<PathBuf>,
    /// What the imports say about the picture; the first to say something counts.
    pub preference: Preference,
    pub varied: Vec<VariedImport>,
}

impl Assets {
    /// A file named by a scene file, which must lie below its folder.
    pub fn file(&mut self, value: &DeValue<'_>, source: &Source<'_>) -> Result<PathBuf, Complaint> {
        let path = source.request.resolve(&text(value)?)?;
        if !path.is_file() {
            return Err(Complaint::new(format!("\"{}\" is not a file", path.display())));
        }
        self.files.push(path.clone());
        Ok(path)
    }

    /// Reads the texture of `key`, where there is one, into the scene.
    pub fn texture(&mut self, keys: &mut Keys<'_>, key: &str, purpose: Use) -> Option<TextureInput> {
        if !keys.is_table(key) {
            let path = keys.optional_of(key, |value, source| self.file(value, source))?;
            let texture =
                Texture { color_space: color_space(&path, purpose), ..Texture::new(self.image(path)) };
            return Some(TextureInput { texture: self.unique(texture), channel: Channel::R });
        }
        let mut table = keys.table(key)?;
        let file = table.required_of("file", |value, source| self.file(value, source));
        let spaces = [("srgb", ColorSpace::Srgb), ("raw", ColorSpace::Raw), ("auto", ColorSpace::Auto)];
        let color_space_said = table.optional("color_space", choice(spaces));
        let wraps = [
            ("repeat", Wrap::Repeat),
            ("mirror", Wrap::Mirror),
            ("clamp", Wrap::Clamp),
            ("black", Wrap::Black),
        ];
        let wrap = table.optional("wrap", choice(wraps)).unwrap_or_default();
        let wrap_u = table.optional("wrap_u", choice(wraps)).unwrap_or(wrap);
        let wrap_v = table.optional("wrap_v", choice(wraps)).unwrap_or(wrap);
        let filters = [("linear", Filter::Linear), ("nearest", Filter::Nearest)];
        let filter = table.optional("filter", choice(filters)).unwrap_or_default();
        let uv_set = table.optional("uv_set", whole(0..=255)).unwrap_or(0) as u32;
        let transform = placed(&mut table);
        let level = |value: &DeValue<'_>| level(value, purpose);
        let scale = table.optional("scale", level).unwrap_or(Vec4::ONE);
        let bias = table.optional("bias", level).unwrap_or(Vec4::ZERO);
        let mut channel = Channel::R;
        if purpose == Use::Scalar {
            let channels = [
                ("r", Channel::R),
                ("g", Channel::G),
                ("b", Channel::B),
                ("a", Channel::A),
                ("l", Channel::L),
            ];
            channel = table.optional("channel", choice(channels)).unwrap_or_default();
        }
        table.finish();
        let path = file?;
        let color_space = color_space_said.unwrap_or(color_space(&path, purpose));
        let image = self.image(path);
        let read = Texture { color_space, wrap_u, wrap_v, filter, uv_set, ..Texture::new(image) };
        let texture = Texture { transform, scale, bias, ..read };
        Some(TextureInput { texture: self.unique(texture), channel })
    }

    /// The image of this file, once.
    fn image(&mut self, path: PathBuf) -> Id<Image> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let source = ImageSource::File(path);
        let known = self.scene.images.ids().find(|&id| self.scene.images[id].source == source);
        known.unwrap_or_else(|| self.scene.images.push(Image { name, source }))
    }

    fn unique(&mut self, texture: Texture) -> Id<Texture> {
        let known = self.scene.textures.ids().find(|&id| self.scene.textures[id] == texture);
        known.unwrap_or_else(|| self.scene.textures.push(texture))
    }
}

fn color_space(path: &Path, purpose: Use) -> ColorSpace {
    let light = path
        .extension()
        .is_some_and(|extension| ["hdr", "exr"].iter().any(|known| extension.eq_ignore_ascii_case(known)));
    if purpose == Use::Color && !light { ColorSpace::Srgb } else { ColorSpace::Raw }
}

/// Where the image lies: coordinates are scaled, turned and moved, as KHR_texture_transform does it.
fn placed(keys: &mut Keys<'_>) -> Affine2 {
    let scale = keys.optional("uv_scale", one_or_two).unwrap_or(Vec2::ONE);
    let degrees = keys.optional("uv_rotate", number(ANY)).unwrap_or(0.0);
    let offset = keys.optional("uv_offset", numbers::<2>(ANY)).unwrap_or_default();
    // Counter-clockwise as one looks at an image, where v points down.
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (sin, cos) = (sin as f32, cos as f32);
    let turn = Mat2::from_cols(Vec2::new(cos, -sin) * scale.x, Vec2::new(sin, cos) * scale.y);
    Affine2::from_mat2_translation(turn, Vec2::from_array(offset.map(|number| number as f32)))
}

fn one_or_two(value: &DeValue<'_>) -> Result<Vec2, Complaint> {
    let pair = match value {
        DeValue::Array(_) => numbers::<2>(ANY)(value)?,
        _ => [number(ANY)(value)?; 2],
    };
    Ok(Vec2::from_array(pair.map(|number| number as f32)))
}

/// A number for all channels, or one for each of red, green and blue where all of them are read.
fn level(value: &DeValue<'_>, purpose: Use) -> Result<Vec4, Complaint> {
    let levels = match value {
        DeValue::Array(_) if purpose != Use::Scalar => vector(value)?,
        _ => DVec3::splat(number(ANY)(value)?),
    };
    // Alpha is read as a number alone, and then is as the others.
    let Vec3 { x, y, z } = levels.as_vec3();
    Ok(Vec4::new(x, y, z, x))
}
