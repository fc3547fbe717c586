//! What a material says at a point.

use super::{Bsdf, Kind, layered::Layered};
use crate::math::Rgb;

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
    /// Share of the dielectric's body that transmits.
    pub transmission: f64,
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
            coat: unit(self.coat),
            coat_roughness: unit(self.coat_roughness),
            ..*self
        }
    }
}

impl Bsdf {
    /// The surface that `parameters` describe.
    pub fn new(parameters: &SurfaceParameters) -> Self {
        let p = parameters.in_range();
        let body_only = p.metallic == 0.0 && p.specular == 0.0 && p.transmission == 0.0 && p.coat == 0.0;
        if body_only && p.diffuse_roughness == 0.0 {
            return Self::lambert(p.base_color);
        }
        Self { kind: Kind::Layered(Layered::new(&p)) }
    }
}
