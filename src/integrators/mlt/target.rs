//! What chains aim at: a density f*·v over paths, and what a step there deposits.

use ajar_render::math::Rgb;

use super::path::Path;

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
