//! The clear coat: an untinted dielectric GGX layer over everything else, with a normal of its own where normal maps say
//! so. Its distribution is isotropic, so that cosines to its normal are all it asks of directions.

use glam::DVec3;

use super::{
    albedo::{Albedo, Interface, Row, mean},
    compensation,
    ggx::{Ggx, SMOOTH},
};
use crate::math::Frame;

/// A clear coat.
#[derive(Clone, Copy, Debug)]
pub struct Coat {
    /// Coverage in (0, 1].
    weight: f32,
    /// Width of its GGX distribution.
    alpha: f32,
    interface: &'static Interface,
    row: Row,
    /// Scale of the reflection that is scattered more than once, without 1/π A, and with.
    bounced: f32,
    lobe: f32,
    /// x and y of its normal where that is not the surface's.
    tilt: Option<[f32; 2]>,
}

impl Coat {
    /// A coat of coverage `weight`, perceptual `roughness` and index `ior`.
    pub fn new(weight: f64, roughness: f64, ior: f64) -> Self {
        let ggx = Ggx::new(roughness, 0.0, 0.0);
        let interface = Interface::of(ior);
        let row = Row::new(&ggx);
        let average = interface.average(false, row).total;
        let fresnel = interface.fresnel_average();
        let bounced = if ggx.is_smooth() { 0.0 } else { compensation::bounced(fresnel, average) };
        Self {
            weight: weight as f32,
            alpha: ggx.narrow() as f32,
            interface,
            row,
            bounced: bounced as f32,
            lobe: (bounced * compensation::scale(1.0 - average)) as f32,
            tilt: None,
        }
    }

    /// The same with the unit normal `n`. A tilted mirror beside a straight one would be two Dirac events of one kind, so
    /// tilted coats are never quite smooth.
    pub fn tilted(self, n: DVec3) -> Self {
        let alpha = self.alpha.max(SMOOTH as f32);
        let row = Row::new(&Ggx::isotropic(alpha.into()));
        Self { alpha, row, tilt: Some([n.x as f32, n.y as f32]), ..self }
    }

    /// Its coverage.
    pub fn weight(&self) -> f64 {
        self.weight.into()
    }

    /// Its microfacets, about its normal.
    pub fn ggx(&self) -> Ggx {
        Ggx::isotropic(self.alpha.into())
    }

    /// Its frame, where its normal is not the surface's.
    pub fn frame(&self) -> Option<Frame> {
        let [x, y] = self.tilt?.map(f64::from);
        Some(Frame::from_z(DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())))
    }

    /// Cosine of `w` to its normal.
    pub fn cos(&self, w: DVec3) -> f64 {
        self.frame().map_or(w.z, |frame| frame.z.dot(w))
    }

    /// Whether it is a Dirac event.
    pub fn is_smooth(&self) -> bool {
        self.alpha == 0.0
    }

    /// Single-scattering albedos at cosine `cos` to its normal.
    pub fn albedo(&self, cos: f64) -> Albedo {
        if self.is_smooth() {
            Albedo::smooth(cos, self.interface.ior())
        } else {
            self.interface.albedo(false, self.row, cos)
        }
    }

    /// What passes the coat one way, given [`Self::albedo`] of a direction.
    pub fn passed(&self, a: Albedo) -> f64 {
        (1.0 - self.weight() * (a.reflected + f64::from(self.bounced) * (1.0 - a.total))).clamp(0.0, 1.0)
    }

    /// Average of [`Self::passed`] over the hemisphere.
    pub fn mean_passed(&self) -> f64 {
        mean(12, |cos| self.passed(self.albedo(cos)))
    }

    /// Reflectance of its microfacets, of coverage included.
    pub fn reflectance(&self, cos: f64) -> f64 {
        self.weight() * self.interface.fresnel(cos, false)
    }

    /// Density of its half vector `h`; 0 where it is smooth.
    pub fn density(&self, h: DVec3) -> f64 {
        let cos = self.cos(h);
        if self.is_smooth() || cos <= 0.0 { 0.0 } else { self.ggx().density(across(cos)) }
    }

    /// Density D of normals visible from `w`, without the factor `w·h D(h)`; 0 from behind.
    pub fn visible(&self, w: DVec3) -> f64 {
        let cos = self.cos(w);
        if cos <= 0.0 { 0.0 } else { self.ggx().visible(across(cos)) }
    }

    /// Its whole BRDF for light from `l` to `e`, whose cosines to its normal stand in for those to the surface's: `density`
    /// is that of the half vector, `facet` the cosine to it, and `a` and `b` are its albedos in both directions.
    pub fn value(&self, [l, e]: [DVec3; 2], density: f64, facet: f64, [a, b]: [Albedo; 2]) -> f64 {
        let [cos_l, cos_e] = [l, e].map(|w| self.cos(w));
        if cos_l <= 0.0 || cos_e <= 0.0 {
            return 0.0;
        }
        let mut value = self.weight() * f64::from(self.lobe) * (1.0 - a.total) * (1.0 - b.total);
        if density > 0.0 {
            value += self.reflectance(facet) * density * self.ggx().visibility(across(cos_l), across(cos_e));
        }
        value * cos_l / l.z
    }

    /// Albedo of what it scatters more than once.
    pub fn scattered_albedo(&self, a: Albedo) -> f64 {
        self.weight() * f64::from(self.bounced) * (1.0 - a.total)
    }
}

/// A direction at this cosine.
fn across(cos: f64) -> DVec3 {
    DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}
