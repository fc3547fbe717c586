//! Images and how they are read as textures.

use std::{path::PathBuf, sync::Arc};

use glam::{Affine2, Vec4};
use serde::{Deserialize, Serialize};

use crate::Id;

/// Encoded pixels; importers leave files as they are, but for cube maps, which they unroll, and maps of heights and
/// exponents, of which they make normals and roughness.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub enum ImageSource {
    /// A file, already checked to lie below a folder the scene may read.
    File(PathBuf),
    /// The bytes of an image file that the asset embeds.
    Embedded(Arc<[u8]>),
}

impl std::fmt::Debug for ImageSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path) => write!(f, "File({})", path.display()),
            Self::Embedded(bytes) => write!(f, "Embedded({} bytes)", bytes.len()),
        }
    }
}

/// An image file (PNG, JPEG, WebP, TIFF, TGA, BMP, Radiance HDR, OpenEXR, KTX2; the bytes decide, not the name).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Image {
    /// Name for messages.
    pub name: String,
    /// Where the bytes are.
    pub source: ImageSource,
}

/// How stored numbers become linear Rec.709.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColorSpace {
    /// sRGB transfer for colour channels, alpha linear.
    Srgb,
    /// Numbers as stored.
    #[default]
    Raw,
    /// sRGB for images of 8 bits a channel with three or four channels, raw otherwise.
    Auto,
}

/// What lies outside [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    /// Tiles.
    #[default]
    Repeat,
    /// Tiles, every other one mirrored.
    Mirror,
    /// The edge texel goes on.
    Clamp,
    /// Transparent black.
    Black,
}

/// Magnification filter. There is no minification filter: a path's contribution must not depend on how it was built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Filter {
    /// Bilinear.
    #[default]
    Linear,
    /// The texel that holds the point.
    Nearest,
}

/// An image with the way it is read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Texture {
    /// The pixels.
    pub image: Id<Image>,
    /// How numbers become linear.
    pub color_space: ColorSpace,
    /// Horizontal wrap.
    pub wrap_u: Wrap,
    /// Vertical wrap.
    pub wrap_v: Wrap,
    /// Filter.
    pub filter: Filter,
    /// Which texture coordinate set of the mesh.
    pub uv_set: u32,
    /// Applied to the coordinates before lookup, origin top left.
    pub transform: Affine2,
    /// Multiplies the linear value.
    pub scale: Vec4,
    /// Added after `scale`.
    pub bias: Vec4,
}

impl Texture {
    /// An image read with the defaults: raw, repeat, bilinear, set 0.
    pub fn new(image: Id<Image>) -> Self {
        Self {
            image,
            color_space: ColorSpace::Raw,
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            filter: Filter::Linear,
            uv_set: 0,
            transform: Affine2::IDENTITY,
            scale: Vec4::ONE,
            bias: Vec4::ZERO,
        }
    }
}
