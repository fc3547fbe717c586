//! Decoded pixels in the width their file has them.

use std::sync::LazyLock;

use glam::Vec4;
use half::f16;

/// Stored numbers, rows from the top, channels interleaved.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 255 is 1.
    U8(Vec<u8>),
    /// 65535 is 1.
    U16(Vec<u16>),
    /// As they are.
    F16(Vec<f16>),
    /// As they are.
    F32(Vec<f32>),
}

impl Texels {
    fn len(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::F16(v) => v.len(),
            Self::F32(v) => v.len(),
        }
    }
}

/// An image of one (grey), two (grey, alpha), three (RGB) or four (RGBA) channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    width: usize,
    height: usize,
    channels: usize,
    texels: Texels,
}

/// The sRGB transfer function from stored to linear (IEC 61966-2-1); odd in negative numbers, its curve above 1 too.
pub(super) fn srgb_to_linear(x: f32) -> f32 {
    let a = x.abs();
    let linear = if a <= 0.04045 { a / 12.92 } else { ((a + 0.055) / 1.055).powf(2.4) };
    linear.copysign(x)
}

static SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| srgb_to_linear(i as f32 / 255.0)));

impl Bitmap {
    /// `None` unless there are one to four channels, some texels, and a number for each of them.
    pub fn new(width: usize, height: usize, channels: usize, texels: Texels) -> Option<Self> {
        let numbers = width.checked_mul(height)?.checked_mul(channels)?;
        let valid = (1..=4).contains(&channels) && numbers > 0 && numbers == texels.len();
        valid.then_some(Self { width, height, channels, texels })
    }

    /// Texels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Texels down.
    pub fn height(&self) -> usize {
        self.height
    }

    /// 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The numbers.
    pub fn texels(&self) -> &Texels {
        &self.texels
    }

    /// RGBA of the texel in column `x` and row `y`, from the top left: grey in all colours, alpha 1 where there is none.
    /// With `srgb` colours go through the sRGB transfer function, alpha does not.
    pub fn texel(&self, x: usize, y: usize, srgb: bool) -> Vec4 {
        let start = (y * self.width + x) * self.channels;
        let range = start..start + self.channels;
        let decode = |x: f32| if srgb { srgb_to_linear(x) } else { x };
        let byte = |&n: &u8| f32::from(n) * (1.0 / 255.0);
        match &self.texels {
            Texels::U8(v) if srgb => spread(&v[range], |&n| SRGB[usize::from(n)], byte),
            Texels::U8(v) => spread(&v[range], byte, byte),
            Texels::U16(v) => {
                let unit = |&n: &u16| f32::from(n) * (1.0 / 65535.0);
                spread(&v[range], |n| decode(unit(n)), unit)
            }
            Texels::F16(v) => spread(&v[range], |n| decode(n.to_f32()), |n| n.to_f32()),
            Texels::F32(v) => spread(&v[range], |&n| decode(n), |&n| n),
        }
    }

    /// Replaces numbers that are not finite, +∞ (a sun that half floats cannot hold) by the largest half float, others
    /// by 0, and says how many there were.
    pub(super) fn make_finite(&mut self) -> usize {
        fn finite(x: f32) -> Option<f32> {
            (!x.is_finite()).then_some(if x == f32::INFINITY { f16::MAX.to_f32() } else { 0.0 })
        }
        let mut replaced = 0;
        match &mut self.texels {
            Texels::U8(_) | Texels::U16(_) => {}
            Texels::F16(v) => {
                for (x, y) in v.iter_mut().filter_map(|x| finite(x.to_f32()).map(|y| (x, y))) {
                    *x = f16::from_f32(y);
                    replaced += 1;
                }
            }
            Texels::F32(v) => {
                for (x, y) in v.iter_mut().filter_map(|x| finite(*x).map(|y| (x, y))) {
                    *x = y;
                    replaced += 1;
                }
            }
        }
        replaced
    }
}

/// One to four stored numbers as RGBA.
fn spread<T>(stored: &[T], color: impl Fn(&T) -> f32, alpha: impl Fn(&T) -> f32) -> Vec4 {
    match stored {
        [grey] => Vec4::splat(color(grey)).with_w(1.0),
        [grey, a] => Vec4::splat(color(grey)).with_w(alpha(a)),
        [r, g, b] => Vec4::new(color(r), color(g), color(b), 1.0),
        [r, g, b, a] => Vec4::new(color(r), color(g), color(b), alpha(a)),
        _ => Vec4::ZERO,
    }
}
