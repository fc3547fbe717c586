//! What chains aim at: a density f*·v over paths, and what a step there deposits.

use ajar_render::math::Rgb;

use super::path::{Path, Space};

/// What a target makes of a path.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// v > 0: the chain visits the path in proportion to f*·v.
    pub weight: f64,
    /// What one step at the path deposits, where the mean of f*·v over the window is 1.
    pub deposit: Rgb,
}

/// A target density.
pub trait Target: Sync {
    /// v and the deposit at `x`, whose f* is not 0.
    fn aim(&self, x: &Path) -> Aim;
}

/// Paths in proportion to their contribution (Veach & Guibas 1997 §3).
#[derive(Clone, Copy, Debug)]
pub struct Plain;

impl Target for Plain {
    fn aim(&self, x: &Path) -> Aim {
        Aim { weight: 1.0, deposit: x.f / x.scalar() }
    }
}

/// Paths in proportion to their contribution relative to the brightness of their pixel: all pixels are visited alike.
#[derive(Clone, Copy, Debug)]
pub struct Relative<'a> {
    /// Where paths live.
    pub space: Space<'a>,
    /// Brightness of each pixel of the window, nowhere 0.
    pub brightness: &'a [f64],
}

impl Target for Relative<'_> {
    fn aim(&self, x: &Path) -> Aim {
        let brightness = self.space.pixel(x.raster).map_or(1.0, |pixel| self.brightness[pixel]);
        Aim { weight: 1.0 / brightness, deposit: x.f * (brightness / x.scalar()) }
    }
}
