//! Textures: images decoded once, kept as compact as their files store them, and looked up without footprint.
//!
//! There is no filtering by ray differentials: what a path contributes must not depend on the end it was built from.

mod bitmap;
mod decode;
mod exr;
mod ktx2;
mod lookup;
mod prepare;
mod tiff;

pub use bitmap::{Bitmap, Texels};
pub use decode::{Decoded, decode};
pub use lookup::Texture;
pub use prepare::{LoadedBefore, Textures, load_textures};
