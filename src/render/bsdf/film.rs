//! Thin films: Belcour and Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of Varying
//! Iridescence", as KHR_materials_iridescence adopts it: interference in a film on a base of known reflectance, its
//! spectrum integrated against Gaussian fits of the colour matching functions.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::fresnel::{dielectric, edge_weight};
use crate::math::Rgb;

/// Interference orders that are summed; the rest is below what eyes see.
const ORDERS: u32 = 2;
/// Mirrors of index ∞ are out of the model's reach.
const MOST: f64 = 0.9999;

/// A film over the base.
#[derive(Clone, Copy, Debug)]
pub struct Film {
    /// Weight in (0, 1].
    pub weight: f32,
    ior: f32,
    /// Nanometres.
    thickness: f32,
}

impl Film {
    /// A film of coverage `weight`, index `ior` and `thickness` in nanometres; `None` if it is not there.
    pub fn new(weight: f64, ior: f64, thickness: f64) -> Option<Self> {
        (weight > 0.0 && thickness > 0.0).then_some(Self {
            weight: weight as f32,
            ior: ior as f32,
            thickness: thickness as f32,
        })
    }

    /// Reflectance at cosine `cos` in air over a base that reflects `normal` at normal incidence without the film, mixed
    /// with what `bare` reflects.
    pub fn reflectance(&self, cos: f64, normal: Rgb, bare: Rgb) -> Rgb {
        let weight = f64::from(self.weight);
        bare * (1.0 - weight) + self.full(cos.clamp(0.0, 1.0), normal) * weight
    }

    fn full(&self, cos: f64, normal: Rgb) -> Rgb {
        let thickness = f64::from(self.thickness);
        // Films much thinner than light's wavelength do not interfere.
        let ior = 1.0 + (f64::from(self.ior) - 1.0) * smoothstep(thickness / 30.0);
        let sin2 = (1.0 - cos * cos) / (ior * ior);
        if sin2 >= 1.0 {
            return Rgb::ONE;
        }
        let inner = (1.0 - sin2).sqrt();
        let top = dielectric(cos, ior);
        let base_ior = normal.map(|f| index(f.clamp(0.0, MOST)));
        let bottom_normal = base_ior.map(|n| ((n - ior) / (n + ior)).powi(2));
        let bottom = bottom_normal + (Rgb::ONE - bottom_normal) * edge_weight(inner);
        let path = 2.0 * ior * thickness * inner;
        // Reflection at a denser medium turns the phase by half a wave, at one of both sides of the film or at both.
        let turn = base_ior.map(|n| if (n < ior) == (ior < 1.0) { -1.0 } else { 1.0 });
        let product = (bottom * top).clamp(Rgb::splat(1e-5), Rgb::splat(MOST));
        let amplitude = product.map(f64::sqrt);
        let passed = (1.0 - top) * (1.0 - top);
        let single = bottom * passed / (Rgb::ONE - product);
        let mut sum = Rgb::splat(top) + single;
        let mut order = single - Rgb::splat(1.0 - top);
        for m in 1..=ORDERS {
            order *= amplitude * turn;
            sum += order * sensitivity(f64::from(m) * path) * 2.0;
        }
        sum.clamp(Rgb::ZERO, Rgb::ONE)
    }
}

fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Index of a base in air that reflects `normal` at normal incidence.
fn index(normal: f64) -> f64 {
    let root = normal.sqrt();
    (1.0 + root) / (1.0 - root)
}

/// Fourier transform of the colour matching functions at an optical path difference in nanometres, as linear Rec.709 in
/// which equal energy is white: films without effect must have none.
fn sensitivity(path: f64) -> Rgb {
    const TO_RGB: DMat3 = DMat3::from_cols_array(&[
        3.240_454_2,
        -0.969_266_0,
        0.055_643_4,
        -1.537_138_5,
        1.876_010_8,
        -0.204_025_9,
        -0.498_531_4,
        0.041_556_0,
        1.057_225_2,
    ]);
    const WHITE: DVec3 = DVec3::new(1.205368753, 0.948319498, 0.910009650);
    let phase = TAU * path * 1e-9;
    let value = DVec3::new(5.4856e-13, 4.4201e-13, 5.2481e-13);
    let position = DVec3::new(1.6810e6, 1.7953e6, 2.2084e6);
    let variance = DVec3::new(4.3278e9, 9.3046e9, 6.6121e9);
    let mut xyz = DVec3::from_array(std::array::from_fn(|i| {
        value[i]
            * (TAU * variance[i]).sqrt()
            * (position[i] * phase).cos()
            * (-variance[i] * phase * phase).exp()
    }));
    xyz.x +=
        9.7470e-14 * (TAU * 4.5282e9).sqrt() * (2.2399e6 * phase).cos() * (-4.5282e9 * phase * phase).exp();
    TO_RGB * (xyz / 1.0685e-7) / WHITE
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(ior: f64, thickness: f64) -> Film {
        Film::new(1.0, ior, thickness).unwrap()
    }

    #[test]
    fn vanishing_films_reflect_as_the_base_does() {
        let normal = Rgb::splat(0.04);
        let thin = film(1.3, 1e-3).full(1.0, normal);
        assert!((thin - normal).abs().max_element() < 0.01, "{thin}");
        // Neither does one whose index is the base's, at normal incidence.
        let matched = film(1.5, 400.0).full(1.0, normal);
        assert!((matched - normal).abs().max_element() < 0.01, "{matched}");
    }

    /// Airy's formula for one wavelength, of amplitudes at normal incidence, averaged over the visible spectrum: films of
    /// many wavelengths are grey.
    #[test]
    fn thick_films_are_grey_and_as_bright_as_incoherent_light() {
        let (top, bottom) = (dielectric(1.0, 1.8), ((1.5f64 - 1.8) / 3.3).powi(2));
        let incoherent = top + bottom * (1.0 - top).powi(2) / (1.0 - top * bottom);
        let thick = film(1.8, 20_000.0).full(1.0, Rgb::splat(0.04));
        assert!((thick - Rgb::splat(incoherent)).abs().max_element() < 0.01, "{thick} {incoherent}");
    }

    /// A quarter of the wavelength of green light, of an index between those of its sides, takes reflections away.
    #[test]
    fn coated_lenses_reflect_less_green() {
        let bare = Rgb::splat(0.04);
        let lens = film(1.2, 550.0 / (4.0 * 1.2)).full(1.0, bare);
        assert!(lens.y < 0.01 && lens.x > lens.y && lens.z > lens.y, "{lens}");
    }
}
