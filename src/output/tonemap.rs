//! From scene light to display light: the curves of a preview. EXR files are never tone mapped.
//!
//! Every curve maps linear Rec.709 light, 1 = white of a diffuse reflector under unit light, to linear display light
//! in [0, 1]; [`srgb_encode`] then makes codes. What leaves the Rec.709 gamut or is negative is clipped first.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

mod aces;
mod agx;
mod neutral;

/// A way to show more light than a display has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ToneMap {
    /// Troy Sobotka's AgX: filmic contrast, bright saturated colours fade to white as on film.
    #[default]
    Agx,
    /// The Academy's reference look (RRT and ODT in Stephen Hill's fit): contrasty, film-like.
    Aces,
    /// Khronos PBR Neutral: base colours come out as they were painted; for products.
    Neutral,
    /// No curve: clipped at 1.
    Srgb,
}

impl ToneMap {
    const NAMES: [(&str, Self); 4] =
        [("agx", Self::Agx), ("aces", Self::Aces), ("neutral", Self::Neutral), ("srgb", Self::Srgb)];

    /// Linear Rec.709 scene light to linear display light, each in [0, 1].
    pub fn apply(self, rgb: [f32; 3]) -> [f32; 3] {
        // Beyond this all curves are flat; infinities would turn to NaN in the matrices.
        const BRIGHTEST: f32 = 1e9;
        let scene = rgb.map(|value| value.clamp(0.0, BRIGHTEST));
        let display = match self {
            Self::Agx => agx::apply(scene),
            Self::Aces => aces::apply(scene),
            Self::Neutral => neutral::apply(scene),
            Self::Srgb => scene,
        };
        display.map(|value| value.clamp(0.0, 1.0))
    }
}

impl fmt::Display for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::NAMES.iter().find(|(_, map)| map == self).map_or("", |(name, _)| name);
        f.write_str(name)
    }
}

/// A name that no tone map has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown tone map `{0}`: use agx, aces, neutral or srgb")]
pub struct UnknownToneMap(String);

impl FromStr for ToneMap {
    type Err = UnknownToneMap;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::NAMES.iter().find(|(known, _)| *known == name);
        found.map(|&(_, map)| map).ok_or_else(|| UnknownToneMap(name.into()))
    }
}

/// Display light in [0, 1] to the sRGB code in [0, 1]: IEC 61966-2-1.
pub fn srgb_encode(value: f32) -> f32 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// Matrix times column; the matrix in rows.
fn transform(rows: &[[f32; 3]; 3], rgb: [f32; 3]) -> [f32; 3] {
    rows.map(|row| row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2])
}

#[cfg(test)]
mod tests;
