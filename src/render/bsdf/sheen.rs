//! Sheen: cloth fibres that stand up, over everything but the coat (KHR_materials_sheen). Distribution and shadowing are
//! those of Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF", without their softened terminator, which
//! is not reciprocal. It is sampled by the cosine lobe; what it reflects is missing below it, as under a coat.

use std::{
    f64::consts::{PI, TAU},
    sync::OnceLock,
};

use glam::DVec3;

use super::albedo::{NODES, locate, mean_near_horizon, node};
use crate::math::Rgb;

/// Intervals of cosines from the horizon on in which albedos are taken from above.
const STEEP: usize = 3;
/// Smoother sheens would be spikes at grazing angles.
const SMOOTHEST: f64 = 0.07;

/// A layer of fibres.
#[derive(Clone, Copy, Debug)]
pub struct Sheen {
    color: [f32; 3],
    /// Width of the distribution.
    alpha: f32,
}

impl Sheen {
    /// A layer of reflectance `color` and perceptual `roughness`; `None` if it is black.
    pub fn new(color: Rgb, roughness: f64) -> Option<Self> {
        let alpha = roughness.max(SMOOTHEST).powi(2) as f32;
        (color != Rgb::ZERO).then(|| Self { color: color.as_vec3().to_array(), alpha })
    }

    /// Its colour.
    pub fn color(&self) -> Rgb {
        Rgb::from_array(self.color.map(f64::from))
    }

    /// BRDF for directions with z > 0 and their half vector.
    pub fn value(&self, a: DVec3, b: DVec3, half: DVec3) -> Rgb {
        let alpha = self.alpha.into();
        let [a_limit, b_limit] = [a, b].map(|w| limit(unlimited(), alpha, w.z));
        self.color() * (value(alpha, a.z, b.z, half.z) * a_limit * b_limit)
    }

    /// Albedo of a white sheen at cosine `cos`.
    pub fn albedo(&self, cos: f64) -> f64 {
        static LIMITED: OnceLock<Box<Table>> = OnceLock::new();
        let table = LIMITED.get_or_init(|| tabulate(|alpha, z| limit(unlimited(), alpha, z)));
        look_up(table, self.alpha.into(), cos).min(1.0)
    }

    /// What passes it one way, in the channel that reflects most, given [`Self::albedo`] of a direction.
    pub fn passed(&self, albedo: f64) -> f64 {
        (1.0 - self.color().max_element() * albedo).clamp(0.0, 1.0)
    }

    /// Average of [`Self::albedo`] over the hemisphere.
    pub fn mean_albedo(&self) -> f64 {
        mean_near_horizon(12, |cos| self.albedo(cos))
    }
}

/// D · G / (4 cos cos) of width `alpha`; `half` is the cosine of the half vector.
fn value(alpha: f64, a: f64, b: f64, half: f64) -> f64 {
    let sharpness = 1.0 / alpha;
    let sin2 = (1.0 - half * half).max(0.0);
    let density = (2.0 + sharpness) * sin2.powf(0.5 * sharpness) / TAU;
    density / ((1.0 + shadowing(alpha, a) + shadowing(alpha, b)) * 4.0 * a * b)
}

/// Smith's Λ, fitted by Estevez and Kulla for widths 0 and 1 and interpolated between.
fn shadowing(alpha: f64, cos: f64) -> f64 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let mix = |sharp: f64, wide: f64| t * sharp + (1.0 - t) * wide;
    let (a, b, c) = (mix(25.3245, 21.5473), mix(3.32435, 3.82987), mix(0.16801, 0.19823));
    let (d, e) = (mix(-1.27393, -1.97760), mix(-4.85967, -4.32054));
    let l = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
    if cos < 0.5 { l(cos).exp() } else { (2.0 * l(0.5) - l((1.0 - cos).max(0.0))).exp() }
}

/// Albedos over the width (rows) and the cosine.
type Table = [[f32; NODES]; NODES];

/// Those of the model as it is, which gives more than it gets near the horizon.
fn unlimited() -> &'static Table {
    static TABLE: OnceLock<Box<Table>> = OnceLock::new();
    TABLE.get_or_init(|| tabulate(|_, _| 1.0))
}

/// What takes that away, for one of both directions.
fn limit(unlimited: &Table, alpha: f64, cos: f64) -> f64 {
    1.0 / look_up(unlimited, alpha, cos).max(1.0)
}

/// Albedos where directions of a width and a cosine count by `limit`.
fn tabulate(limit: impl Fn(f64, f64) -> f64) -> Box<Table> {
    Box::new(std::array::from_fn(|j| {
        let alpha = node(j).max(SMOOTHEST * SMOOTHEST);
        std::array::from_fn(|i| {
            let cos = node(i).max(1e-3);
            (integrate(alpha, cos, |z| limit(alpha, z)) * limit(alpha, cos)) as f32
        })
    }))
}

fn look_up(rows: &Table, alpha: f64, cos: f64) -> f64 {
    let ((i, x), (j, y)) = (locate(cos), locate(alpha));
    let at = |j: usize| {
        let [near, far] = [rows[j][i], rows[j][i + 1]].map(f64::from);
        // At the horizon albedos rise faster than straight lines between nodes.
        if i < STEEP { near.max(far) } else { near * (1.0 - x) + far * x }
    };
    at(j) * (1.0 - y) + at(j + 1) * y
}

/// Integral of the BRDF times the cosine over the hemisphere, directions weighed by their cosine's `limit`.
fn integrate(alpha: f64, cos: f64, limit: impl Fn(f64) -> f64) -> f64 {
    const POLAR: u32 = 48;
    const AZIMUTHS: u32 = 32;
    let a = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for i in 0..POLAR {
        // Denser towards the horizon, where fibres shine: z = t², dz = 2 t dt.
        let t = (f64::from(i) + 0.5) / f64::from(POLAR);
        let z = t * t;
        let (sin, limit) = ((1.0 - z * z).sqrt(), limit(z));
        for j in 0..AZIMUTHS {
            let azimuth = PI * (f64::from(j) + 0.5) / f64::from(AZIMUTHS);
            let b = DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), z);
            sum += value(alpha, cos, z, (a + b).normalize().z) * z * 2.0 * t * limit;
        }
    }
    sum * TAU / f64::from(POLAR * AZIMUTHS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn albedos_of_the_table_are_those_of_the_lobe() {
        for roughness in [0.3, 0.55, 0.8, 1.0f64] {
            let sheen = Sheen::new(Rgb::ONE, roughness).unwrap();
            for cos in [0.1, 0.33, 0.7, 0.95] {
                let alpha = roughness * roughness;
                let limits = |z| limit(unlimited(), alpha, z);
                let exact = integrate(alpha, cos, limits) * limits(cos);
                assert!((sheen.albedo(cos) - exact).abs() < 0.01, "{roughness} {cos}");
            }
        }
    }

    #[test]
    fn black_is_none() {
        assert!(Sheen::new(Rgb::ZERO, 0.5).is_none());
    }
}
