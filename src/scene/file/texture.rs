//! Textures that the scene file names: `"wood.png"`, or a table with the way the image is read.

use std::path::{Path, PathBuf};

use toml::de::DeValue;

use super::{
    VariedImport,
    keys::Keys,
    report::Complaint,
    source::Source,
    value::{choice, text, whole},
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
        let filters = [("linear", Filter::Linear), ("nearest", Filter::Nearest)];
        let filter = table.optional("filter", choice(filters)).unwrap_or_default();
        let uv_set = table.optional("uv_set", whole(0..=255)).unwrap_or(0) as u32;
        let mut channel = Channel::R;
        if purpose == Use::Scalar {
            let channels = [("r", Channel::R), ("g", Channel::G), ("b", Channel::B), ("a", Channel::A)];
            channel = table.optional("channel", choice(channels)).unwrap_or_default();
        }
        table.finish();
        let path = file?;
        let color_space = color_space_said.unwrap_or(color_space(&path, purpose));
        let image = self.image(path);
        let texture =
            Texture { color_space, wrap_u: wrap, wrap_v: wrap, filter, uv_set, ..Texture::new(image) };
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
