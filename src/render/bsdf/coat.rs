//! The clear coat: an untinted dielectric GGX layer over everything else.

use glam::DVec3;

use super::{
    albedo::{Albedo, Interface, Widths, mean},
    compensation,
    ggx::Ggx,
};

/// A clear coat.
#[derive(Clone, Copy, Debug)]
pub struct Coat {
    /// Coverage in (0, 1].
    pub weight: f64,
    /// Width of its GGX distribution.
    alpha: f64,
    interface: &'static Interface,
    widths: Widths,
    /// Scale of the reflection that is scattered more than once, without 1/π A.
    bounced: f64,
    lobe: f64,
}

impl Coat {
    /// A coat of coverage `weight`, perceptual `roughness` and index `ior`.
    pub fn new(weight: f64, roughness: f64, ior: f64) -> Self {
        let ggx = Ggx::new(roughness, 0.0, 0.0);
        let interface = Interface::of(ior);
        let widths = Widths::new(&ggx);
        let average = interface.average(false, widths).total;
        let fresnel = interface.fresnel_average();
        let bounced = if ggx.is_smooth() { 0.0 } else { compensation::bounced(fresnel, average) };
        Self {
            weight,
            alpha: ggx.narrow(),
            interface,
            widths,
            bounced,
            lobe: bounced * compensation::scale(1.0 - average),
        }
    }

    /// Its microfacets.
    pub fn ggx(&self) -> Ggx {
        Ggx::isotropic(self.alpha)
    }

    /// Whether it is a Dirac event.
    pub fn is_smooth(&self) -> bool {
        self.alpha == 0.0
    }

    /// Single-scattering albedos at cosine `cos`.
    pub fn albedo(&self, cos: f64) -> Albedo {
        if self.is_smooth() {
            Albedo::smooth(cos, self.interface.ior())
        } else {
            self.interface.albedo(false, self.widths, cos)
        }
    }

    /// What passes the coat one way, given [`Self::albedo`] of a direction.
    pub fn passed(&self, a: Albedo) -> f64 {
        (1.0 - self.weight * (a.reflected + self.bounced * (1.0 - a.total))).clamp(0.0, 1.0)
    }

    /// Average of [`Self::passed`] over the hemisphere times `below`.
    pub fn mean_passed(&self, below: impl Fn(f64) -> f64) -> f64 {
        mean(12, |cos| self.passed(self.albedo(cos)) * below(cos))
    }

    /// Reflectance of its microfacets, of coverage included.
    pub fn reflectance(&self, cos: f64) -> f64 {
        self.weight * self.interface.fresnel(cos, false)
    }

    /// BRDF of its GGX lobe for `density` of the half vector with `facet` = |a·h|.
    pub fn glossy(&self, a: DVec3, b: DVec3, density: f64, facet: f64) -> f64 {
        self.reflectance(facet) * density * self.ggx().visibility(a, b)
    }

    /// BRDF of what is scattered more than once.
    pub fn scattered(&self, a: Albedo, b: Albedo) -> f64 {
        self.weight * self.lobe * (1.0 - a.total) * (1.0 - b.total)
    }

    /// Albedo of [`Self::scattered`].
    pub fn scattered_albedo(&self, a: Albedo) -> f64 {
        self.weight * self.bounced * (1.0 - a.total)
    }
}
