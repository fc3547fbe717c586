//! Diffuse reflection: the energy-preserving Oren–Nayar model EON (Portsmouth, Kutz and Hill 2025, "EON: A Practical
//! Energy-Preserving Rough Diffuse BRDF"), which is reciprocal and keeps white white. Zero roughness is Lambert.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use crate::math::Rgb;

/// Of albedo at normal incidence and of the average albedo, from Fujii's variant of the model.
const NORMAL: f64 = 0.5 - 2.0 / (3.0 * PI);
const AVERAGE: f64 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// BRDF of a diffuse surface of albedo `color` and `roughness` in [0, 1]; `a` and `b` have z > 0.
pub fn eon(color: Rgb, roughness: f64, a: DVec3, b: DVec3) -> Rgb {
    if roughness == 0.0 {
        return color * FRAC_1_PI;
    }
    let s = a.dot(b) - a.z * b.z;
    // Rounding may take the sine product of two grazing directions a hair beyond −1.
    let ratio = if s > 0.0 { s / a.z.max(b.z) } else { s.max(-1.0) };
    let scale = 1.0 / (1.0 + NORMAL * roughness);
    let single = color * (FRAC_1_PI * scale * (1.0 + roughness * ratio));
    let average = scale * (1.0 + AVERAGE * roughness);
    let lost = (1.0 - albedo(roughness, a.z)) * (1.0 - albedo(roughness, b.z)) / (1.0 - average);
    let bounced = color * color * average / (Rgb::ONE - color * (1.0 - average));
    single + bounced * (lost.max(0.0) * FRAC_1_PI)
}

/// Directional albedo of single scattering for white.
fn albedo(roughness: f64, cos: f64) -> f64 {
    let sin2 = (1.0 - cos * cos).max(0.0);
    let sin = sin2.sqrt();
    let g = sin * (cos.min(1.0).acos() - sin * cos)
        + 2.0 / 3.0 * (sin / cos.max(1e-9) * (1.0 - sin2 * sin) - sin);
    (1.0 + roughness * g * FRAC_1_PI) / (1.0 + NORMAL * roughness)
}
