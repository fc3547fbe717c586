//! Looking textures up.

use std::sync::Arc;

use ajar_scene::{ColorSpace, Filter, Wrap};
use glam::{Affine2, Vec2, Vec4};
use rayon::prelude::*;

use super::{Bitmap, Texels};

/// An image with the way it is read. Cheap to clone: images are shared.
#[derive(Clone, Debug)]
pub struct Texture {
    bitmap: Arc<Bitmap>,
    srgb: bool,
    wrap: [Wrap; 2],
    filter: Filter,
    uv_set: u32,
    transform: Affine2,
    scale: Vec4,
    bias: Vec4,
}

impl Texture {
    /// `bitmap` read the way `texture` says.
    pub fn new(bitmap: Arc<Bitmap>, texture: &ajar_scene::Texture) -> Self {
        let bytes = matches!(bitmap.texels(), Texels::U8(_));
        let srgb = match texture.color_space {
            ColorSpace::Srgb => true,
            ColorSpace::Raw => false,
            ColorSpace::Auto => bytes && bitmap.channels() >= 3,
        };
        Self {
            bitmap,
            srgb,
            wrap: [texture.wrap_u, texture.wrap_v],
            filter: texture.filter,
            uv_set: texture.uv_set,
            transform: texture.transform,
            scale: texture.scale,
            bias: texture.bias,
        }
    }

    /// The same image with other wraps.
    pub fn wrapping(self, u: Wrap, v: Wrap) -> Self {
        Self { wrap: [u, v], ..self }
    }

    /// Whether it is the same image in memory, read the same way.
    pub fn is_same(&self, other: &Self) -> bool {
        let Self { bitmap, srgb, wrap, filter, uv_set, transform, scale, bias } = self;
        Arc::ptr_eq(bitmap, &other.bitmap)
            && (srgb, wrap, filter, uv_set) == (&other.srgb, &other.wrap, &other.filter, &other.uv_set)
            && (transform, scale, bias) == (&other.transform, &other.scale, &other.bias)
    }

    /// Which texture coordinate set of a mesh it is read with.
    pub fn uv_set(&self) -> u32 {
        self.uv_set
    }

    /// The pixels.
    pub fn bitmap(&self) -> &Bitmap {
        &self.bitmap
    }

    /// How it is read between texel centres.
    pub fn filter(&self) -> Filter {
        self.filter
    }

    /// Linear RGBA at texture coordinates with their origin at the top left, after transform, colour space, filter,
    /// scale and bias. Coordinates that are not finite read some texel.
    pub fn sample(&self, uv: [f32; 2]) -> Vec4 {
        let uv = self.transform.transform_point2(Vec2::from(uv));
        self.at([uv.x.into(), uv.y.into()])
    }

    /// As [`sample`](Self::sample), without the transform.
    pub fn at(&self, [u, v]: [f64; 2]) -> Vec4 {
        let x = period(u, self.wrap[0]) * self.bitmap.width() as f64;
        let y = period(v, self.wrap[1]) * self.bitmap.height() as f64;
        let stored = match self.filter {
            Filter::Nearest => self.wrapped(x.floor() as i64, y.floor() as i64),
            Filter::Linear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (left, top) = (x.floor(), y.floor());
                let (i, j) = (left as i64, top as i64);
                let (right, below) = ((x - left) as f32, (y - top) as f32);
                let upper = self.wrapped(i, j).lerp(self.wrapped(i + 1, j), right);
                let lower = self.wrapped(i, j + 1).lerp(self.wrapped(i + 1, j + 1), right);
                upper.lerp(lower, below)
            }
        };
        stored * self.scale + self.bias
    }

    /// Linear RGBA of the texel in column `x` and row `y`, after colour space, scale and bias.
    pub fn texel(&self, x: usize, y: usize) -> Vec4 {
        self.bitmap.texel(x, y, self.srgb) * self.scale + self.bias
    }

    /// Mean of [`texel`](Self::texel) over the whole image.
    pub fn average(&self) -> Vec4 {
        let (width, height) = (self.bitmap.width(), self.bitmap.height());
        let row = |y| (0..width).map(|x| self.texel(x, y).as_dvec4()).sum::<glam::DVec4>();
        // Rows are summed in order, whichever thread they came from.
        let rows: Vec<_> = (0..height).into_par_iter().map(row).collect();
        (rows.into_iter().sum::<glam::DVec4>() / (width * height) as f64).as_vec4()
    }

    fn wrapped(&self, x: i64, y: i64) -> Vec4 {
        match (index(x, self.bitmap.width(), self.wrap[0]), index(y, self.bitmap.height(), self.wrap[1])) {
            (Some(x), Some(y)) => self.bitmap.texel(x, y, self.srgb),
            _ => Vec4::ZERO,
        }
    }
}

/// An equivalent coordinate near [0, 1], so that texel numbers stay small and exact.
fn period(u: f64, wrap: Wrap) -> f64 {
    let near = match wrap {
        Wrap::Repeat => u - u.floor(),
        Wrap::Mirror => u - 2.0 * (u * 0.5).floor(),
        // Two images away there is nothing but the edge, or black.
        Wrap::Clamp | Wrap::Black => u.clamp(-2.0, 3.0),
    };
    if near.is_finite() { near } else { 0.0 }
}

/// The texel that stands at position `i` of the endless plane, if there is one.
fn index(i: i64, size: usize, wrap: Wrap) -> Option<usize> {
    let size = size as i64;
    let wrapped = match wrap {
        Wrap::Repeat => i.rem_euclid(size),
        Wrap::Mirror => {
            let i = i.rem_euclid(2 * size);
            i.min(2 * size - 1 - i)
        }
        Wrap::Clamp => i.clamp(0, size - 1),
        Wrap::Black => return usize::try_from(i).ok().filter(|_| i < size),
    };
    Some(wrapped as usize)
}

#[cfg(test)]
mod tests;
