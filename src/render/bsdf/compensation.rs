//! Multiple scattering between microfacets, which single scattering loses: Kulla and Conty 2017, "Revisiting Physically
//! Based Shading at Imageworks". The lost energy leaves as reciprocal lobes that are products of what is missing in both
//! directions.

use std::f64::consts::FRAC_1_PI;

use super::albedo::Albedo;

/// Share of the light bounced more than once that survives, if a fraction `fresnel` survives each bounce and
/// `average` is the average albedo of single scattering.
pub fn bounced(fresnel: f64, average: f64) -> f64 {
    fresnel * fresnel * average / (1.0 - fresnel * (1.0 - average))
}

/// Average of Schlick's reflectance over the hemisphere for reflectance `normal` at normal incidence.
pub fn schlick_average(normal: f64) -> f64 {
    normal + (1.0 - normal) / 21.0
}

/// Scale of the lobe `gap(a) gap(b)` that integrates to `gap(a)` where `average` is the average gap.
pub fn scale(average: f64) -> f64 {
    if average > 1e-6 { FRAC_1_PI / average } else { 0.0 }
}

/// The compensating lobes of a transmitting interface: reflection on both sides and transmission.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Reflection, in front and inside.
    pub reflect: [f64; 2],
    /// Transmission from the front to the inside, before the radiance scale.
    pub cross: f64,
    /// Shares of the gap that are transmitted, from the front and from inside.
    pub crossing: [f64; 2],
}

impl Body {
    /// No loss.
    pub const NONE: Self = Self { reflect: [0.0; 2], cross: 0.0, crossing: [0.0; 2] };

    /// Of a shell of average microfacet reflectance `fresnel`.
    pub fn shell(fresnel: f64, front: Albedo) -> Self {
        let scale = scale(1.0 - front.total);
        Self { reflect: [scale * fresnel; 2], cross: scale * (1.0 - fresnel), crossing: [1.0 - fresnel; 2] }
    }

    /// Of a solid of index `ior`: transmitted shares x and y with x A_front = y η² A_inside, A the average gaps, which
    /// makes transmission reciprocal; as near to the transmittance of a smooth surface as shares of at most 1 allow.
    pub fn solid(fresnel: f64, ior: f64, front: Albedo, inside: Albedo) -> Self {
        let gaps = [front, inside].map(|a| 1.0 - a.reflected - a.transmitted);
        if gaps[0].min(gaps[1]) < 1e-6 {
            return Self::NONE;
        }
        let ratio = gaps[0] / (ior * ior * gaps[1]);
        let x = (1.0 - fresnel).min(1.0 / ratio);
        let y = x * ratio;
        let [front, inside] = gaps.map(scale);
        Self { reflect: [front * (1.0 - x), inside * (1.0 - y)], cross: inside * x, crossing: [x, y] }
    }
}
