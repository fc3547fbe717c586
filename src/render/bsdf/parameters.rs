//! What a material says at a point.

use super::{Bsdf, Kind, layered::Layered};
use crate::math::Rgb;

/// Red would no longer be refracted.
const MOST_DISPERSION: f64 = 30.0;

/// The numbers of a [`Bsdf`]; see `ajar_scene::Material` for their meaning. Colours and weights lie in [0, 1], what is
/// outside or not a number is brought inside.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceParameters {
    /// Diffuse albedo, metal reflectance at normal incidence, tint of transmission.
    pub base_color: Rgb,
    /// Oren–Nayar roughness of the diffuse part.
    pub diffuse_roughness: f64,
    /// 0 dielectric, 1 metal.
    pub metallic: f64,
    /// Perceptual roughness.
    pub roughness: f64,
    /// Stretch of the highlight.
    pub anisotropy: f64,
    /// Rotation of the stretch, radians counter-clockwise from the tangent.
    pub anisotropy_rotation: f64,
    /// Strength of the dielectric reflection.
    pub specular: f64,
    /// Tint of the dielectric reflection at normal incidence.
    pub specular_color: Rgb,
    /// Index of refraction, ≥ 1.
    pub ior: f64,
    /// Spread of the index, 20 over the Abbe number.
    pub dispersion: f64,
    /// Share of the dielectric's body that transmits.
    pub transmission: f64,
    /// Share of the diffuse body that transmits.
    pub diffuse_transmission: f64,
    /// Its colour.
    pub diffuse_transmission_color: Rgb,
    /// Colour of a layer of fibres.
    pub sheen_color: Rgb,
    /// Perceptual roughness of the fibres.
    pub sheen_roughness: f64,
    /// Weight of a thin film.
    pub film: f64,
    /// Index of refraction of the film, ≥ 1.
    pub film_ior: f64,
    /// Thickness of the film, nanometres.
    pub film_thickness: f64,
    /// A shell without inside.
    pub thin_walled: bool,
    /// Weight of the clear coat.
    pub coat: f64,
    /// Perceptual roughness of the coat.
    pub coat_roughness: f64,
    /// Index of refraction of the coat, ≥ 1.
    pub coat_ior: f64,
}

impl SurfaceParameters {
    /// With every number in its range.
    fn in_range(&self) -> Self {
        // Also catches NaN.
        let unit = |x: f64| if x > 0.0 { x.min(1.0) } else { 0.0 };
        let color = |c: Rgb| Rgb::new(unit(c.x), unit(c.y), unit(c.z));
        let angle = self.anisotropy_rotation;
        Self {
            base_color: color(self.base_color),
            diffuse_roughness: unit(self.diffuse_roughness),
            metallic: unit(self.metallic),
            roughness: unit(self.roughness),
            anisotropy: unit(self.anisotropy),
            anisotropy_rotation: if angle.is_finite() { angle } else { 0.0 },
            specular: unit(self.specular),
            specular_color: color(self.specular_color),
            transmission: unit(self.transmission),
            dispersion: if self.dispersion > 0.0 { self.dispersion.min(MOST_DISPERSION) } else { 0.0 },
            diffuse_transmission: unit(self.diffuse_transmission),
            diffuse_transmission_color: color(self.diffuse_transmission_color),
            sheen_color: color(self.sheen_color),
            sheen_roughness: unit(self.sheen_roughness),
            film: unit(self.film),
            film_ior: if self.film_ior >= 1.0 { self.film_ior.min(1e3) } else { 1.0 },
            film_thickness: if self.film_thickness > 0.0 { self.film_thickness.min(1e5) } else { 0.0 },
            coat: unit(self.coat),
            coat_roughness: unit(self.coat_roughness),
            ..*self
        }
    }

    /// Indices of refraction for red and blue, if they are others than for green. The spread between the Fraunhofer lines F
    /// and C is (n − 1) / Abbe number, half of it to either side (KHR_materials_dispersion).
    pub(super) fn dispersed_indices(&self) -> Option<[f64; 2]> {
        let half = 0.5 * (self.ior - 1.0) * self.dispersion / 20.0;
        (half > 0.0 && !self.thin_walled && half.is_finite()).then_some([self.ior - half, self.ior + half])
    }
}

impl Bsdf {
    /// The surface that `parameters` describe.
    pub fn new(parameters: &SurfaceParameters) -> Self {
        let p = parameters.in_range();
        let weights = [p.metallic, p.specular, p.transmission, p.coat, p.film, p.diffuse_transmission];
        let body_only = weights == [0.0; 6] && p.sheen_color == Rgb::ZERO;
        if body_only && p.diffuse_roughness == 0.0 {
            return Self::lambert(p.base_color);
        }
        Self { kind: Kind::Layered(Layered::new(&p)) }
    }
}
