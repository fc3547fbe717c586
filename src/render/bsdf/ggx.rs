//! The anisotropic GGX distribution of microfacet normals: Walter et al. 2007, "Microfacet Models for Refraction";
//! height-correlated Smith shadowing, Heitz 2014; visible normals by spherical caps, Dupuy and Benyoub 2023.

use glam::{DVec2, DVec3, Vec2};

use crate::warp::{cone_to_square, disc_to_cone, square_to_disc};

/// Widths below this are perfectly smooth surfaces.
pub const SMOOTH: f64 = 1e-3;

/// A distribution of microfacet normals. Directions and normals have z > 0 everywhere in this module.
#[derive(Clone, Copy, Debug)]
pub struct Ggx {
    /// α along the two axes of the distribution, the wider first; zero for a smooth surface.
    alpha: Vec2,
    /// Cosine and sine of the first axis' angle from the tangent.
    axis: DVec2,
}

impl Ggx {
    /// From perceptual roughness (α is its square), stretched after KHR_materials_anisotropy along an axis `rotation`
    /// radians counter-clockwise from the tangent.
    pub fn new(roughness: f64, anisotropy: f64, rotation: f64) -> Self {
        let alpha = roughness * roughness;
        let along = alpha + (1.0 - alpha) * anisotropy * anisotropy;
        let alpha = if along < SMOOTH { DVec2::ZERO } else { DVec2::new(along, alpha.max(SMOOTH)) };
        let alpha = alpha.as_vec2();
        let axis = if alpha.x == alpha.y { DVec2::X } else { DVec2::from_angle(rotation) };
        Self { alpha, axis }
    }

    /// Of widths `wide` along the tangent and `narrow` across it.
    pub fn along_tangent(wide: f64, narrow: f64) -> Self {
        Self { alpha: DVec2::new(wide, narrow).as_vec2(), axis: DVec2::X }
    }

    /// Of equal width in all directions.
    pub fn isotropic(alpha: f64) -> Self {
        Self { alpha: Vec2::splat(alpha as f32), axis: DVec2::X }
    }

    /// Whether it is the same in all directions.
    pub fn is_isotropic(&self) -> bool {
        self.alpha.x == self.alpha.y
    }

    /// Whether all normals are the surface's.
    pub fn is_smooth(&self) -> bool {
        self.alpha.x == 0.0
    }

    /// The smaller width.
    pub fn narrow(&self) -> f64 {
        self.alpha.min_element().into()
    }

    /// The larger width.
    pub fn wide(&self) -> f64 {
        self.alpha.max_element().into()
    }

    /// Density D of normals per projected steradian.
    pub fn density(&self, h: DVec3) -> f64 {
        let alpha = self.alpha.as_dvec2();
        let slope = self.along_axes(h) / alpha;
        let k = slope.length_squared() + h.z * h.z;
        1.0 / (std::f64::consts::PI * alpha.x * alpha.y * k * k)
    }

    /// G₂ / (4 cos cos): shadowing and masking with the cosines of the reflection formula.
    pub fn visibility(&self, a: DVec3, b: DVec3) -> f64 {
        0.5 / (a.z * self.stretched(b) + b.z * self.stretched(a))
    }

    /// Density D of normals visible from `w`, without the factor `w·h D(h)`: G₁ / cos.
    pub fn visible(&self, w: DVec3) -> f64 {
        2.0 / (w.z + self.stretched(w))
    }

    /// √(α²x² + α²y² + z²).
    fn stretched(&self, w: DVec3) -> f64 {
        ((self.along_axes(w) * self.alpha.as_dvec2()).length_squared() + w.z * w.z).sqrt()
    }

    /// The direction that the stretched, isotropic configuration sees as `w` (Heitz 2014, section 5.3).
    pub fn stretch(&self, w: DVec3) -> DVec3 {
        (self.along_axes(w) * self.alpha.as_dvec2()).extend(w.z).normalize()
    }

    /// What [`Self::stretch`] makes of `w` undone, for axes that are the tangents.
    pub fn unstretch(&self, w: DVec3) -> DVec3 {
        (w.truncate() / self.alpha.as_dvec2()).extend(w.z).normalize()
    }

    /// A normal with density `visible(w) (w·h) D(h)` per steradian.
    pub fn sample(&self, w: DVec3, u: [f64; 2]) -> Option<DVec3> {
        self.visible_normal(w, square_to_disc(u))
    }

    /// The second half of [`Self::sample`]: from a point of the unit disc.
    pub fn visible_normal(&self, w: DVec3, p: DVec2) -> Option<DVec3> {
        let w = self.stretch(w);
        let h = disc_to_cone(p, -w.z) + w;
        let h = self.off_axes(h.truncate() * self.alpha.as_dvec2()).extend(h.z.max(0.0));
        h.try_normalize().filter(|h| h.z > 0.0)
    }

    /// The `u` with which [`Self::sample`] gives `h`.
    pub fn invert(&self, w: DVec3, h: DVec3) -> Option<[f64; 2]> {
        let w = self.stretch(w);
        let h = (self.along_axes(h) / self.alpha.as_dvec2()).extend(h.z).try_normalize()?;
        let cap = h * (2.0 * h.dot(w)) - w;
        cone_to_square(cap.normalize(), -w.z)
    }

    fn along_axes(&self, w: DVec3) -> DVec2 {
        let DVec2 { x: cos, y: sin } = self.axis;
        DVec2::new(w.x * cos + w.y * sin, w.y * cos - w.x * sin)
    }

    fn off_axes(&self, p: DVec2) -> DVec2 {
        p.rotate(self.axis)
    }
}
