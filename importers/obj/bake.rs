//! Images made of others, where what a library says about them is no scale and bias: normals of heights, roughness of
//! exponents. They have 16 bits a channel, so that gentle slopes are no steps.

use std::{io::Cursor, path::Path};

use ajar_scene::Channel;
use glam::{Vec3, Vec4};
use image::{ImageBuffer, ImageFormat, ImageReader, Limits, Luma, Rgb};

use super::material::roughness_of;
use crate::{budget::Budget, guard, srgb};

/// Texels on the side of an image, at most, as for all textures.
const MOST: u32 = 16384;

/// Bytes a texel: as decoded, as a number, and as it is written.
const TEXEL_BYTES: u64 = 16 + 4 + 6;

/// What is made.
#[derive(Clone, Copy, Debug)]
pub(super) enum Recipe {
    /// Tangent-space normals of heights, green up. The format has no unit of heights: white is one texel above black.
    Normals {
        /// Whether the image ends at its edges instead of going on at the other side.
        clamp: bool,
        /// Whether the image is shown mirrored along u and v.
        mirrored: [bool; 2],
    },
    /// Roughness of the exponent `base + gain · texel`.
    Roughness { base: f32, gain: f32 },
}

/// Which number of a texel counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Read {
    pub channel: Channel,
    pub srgb: bool,
}

/// One number a texel.
struct Numbers {
    width: u32,
    height: u32,
    values: Vec<f32>,
}

/// A PNG file made of the image at `path`.
///
/// # Errors
/// The image cannot be decoded, or not within `budget`.
pub(super) fn bake(path: &Path, read: Read, recipe: Recipe, budget: &Budget) -> Result<Vec<u8>, String> {
    // Decoders of other crates can panic on hostile bytes.
    let numbers = guard::catch(|| decode(path, read, budget)).unwrap_or_else(Err)?;
    let mut file = Cursor::new(Vec::new());
    match recipe {
        Recipe::Normals { clamp, mirrored } => {
            let normal =
                |x, y| Rgb(numbers.normal(x, y, clamp, mirrored).to_array().map(|n| whole(0.5 * n + 0.5)));
            let image = ImageBuffer::from_fn(numbers.width, numbers.height, normal);
            image.write_to(&mut file, ImageFormat::Png)
        }
        Recipe::Roughness { base, gain } => {
            let exponent = |x, y| base + gain * numbers.at(x, y);
            let roughness = |x, y| Luma([whole(roughness_of(exponent(x, y)))]);
            ImageBuffer::from_fn(numbers.width, numbers.height, roughness)
                .write_to(&mut file, ImageFormat::Png)
        }
    }
    .map_err(|e| e.to_string())?;
    Ok(file.into_inner())
}

fn decode(path: &Path, read: Read, budget: &Budget) -> Result<Numbers, String> {
    let open = || {
        let reader = ImageReader::open(path).map_err(|e| format!("cannot be read: {e}"))?;
        reader.with_guessed_format().map_err(|e| format!("cannot be read: {e}"))
    };
    let (width, height) = open()?.into_dimensions().map_err(|e| e.to_string())?;
    if width.max(height) > MOST {
        return Err(format!("has {width} × {height} texels, more than {MOST} on a side"));
    }
    if !budget.take(u64::from(width) * u64::from(height) * TEXEL_BYTES) {
        return Err("is larger than the memory limit allows".into());
    }
    let mut reader = open()?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MOST), Some(MOST));
    reader.limits(limits);
    let image = reader.decode().map_err(|e| e.to_string())?.into_rgba32f();
    let values = image.pixels().map(|pixel| read.number(Vec4::from(pixel.0))).collect();
    Ok(Numbers { width, height, values })
}

impl Read {
    fn number(self, texel: Vec4) -> f32 {
        let color = texel.truncate().to_array();
        let color = if self.srgb { color.map(srgb::linear) } else { color };
        let number = self.channel.of(Vec3::from(color).extend(texel.w));
        if number.is_finite() { number } else { 0.0 }
    }
}

impl Numbers {
    fn at(&self, x: u32, y: u32) -> f32 {
        self.values.get(y as usize * self.width as usize + x as usize).copied().unwrap_or_default()
    }

    /// Across the surface whose slopes are the differences between neighbours.
    fn normal(&self, x: u32, y: u32, clamp: bool, [flip_u, flip_v]: [bool; 2]) -> Vec3 {
        let (left, right) = neighbours(x, self.width, clamp);
        let (above, below) = neighbours(y, self.height, clamp);
        let u = 0.5 * (self.at(right, y) - self.at(left, y));
        let v = 0.5 * (self.at(x, above) - self.at(x, below));
        Vec3::new(if flip_u { u } else { -u }, if flip_v { v } else { -v }, 1.0).normalize()
    }
}

/// The positions before and after one.
fn neighbours(at: u32, size: u32, clamp: bool) -> (u32, u32) {
    match clamp {
        true => (at.saturating_sub(1), (at + 1).min(size - 1)),
        false => ((at + size - 1) % size, (at + 1) % size),
    }
}

/// A number from 0 to 1 in 16 bits.
fn whole(number: f32) -> u16 {
    (number * f32::from(u16::MAX)).round() as u16
}
