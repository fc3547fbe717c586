//! What the microfacets of the principled surface reflect: metal, dielectric and boundary, under a thin film or bare.

use glam::{DVec2, DVec3};

use super::{
    albedo::mean,
    compensation::schlick_average,
    fresnel::{edge_weight, metal},
    layered::{Layered, View},
};
use crate::math::Rgb;

/// Cosines at which films are averaged over the hemisphere.
const FILM_COSINES: u32 = 4;

impl Layered {
    /// Untinted reflectance of the transmitting boundary met at cosine `facet`.
    pub fn boundary(&self, facet: f64, inside: bool) -> Rgb {
        let green = self.interface.fresnel(facet, inside);
        let bare = match self.dispersed {
            None => Rgb::splat(green),
            Some([red, blue]) => Rgb::new(red.fresnel(facet, inside), green, blue.fresnel(facet, inside)),
        };
        let Some(film) = &self.film else { return bare };
        let ior = self.interface.ior();
        let sin2 = (1.0 - facet * facet) * if inside && !self.thin { ior * ior } else { 1.0 };
        // Light meets the same film from both sides.
        if sin2 >= 1.0 {
            bare
        } else {
            film.reflectance((1.0 - sin2).sqrt(), Rgb::splat(self.straight()), bare)
        }
    }

    /// Reflectance of the bare dielectric at normal incidence.
    fn straight(&self) -> f64 {
        self.interface.fresnel(1.0, false)
    }

    /// Tint of the dielectric reflection at cosine `facet`.
    fn tint(&self, facet: f64) -> Rgb {
        self.normal + (Rgb::splat(self.specular) - self.normal) * edge_weight(facet)
    }

    fn dielectric(&self, facet: f64) -> Rgb {
        let bare = self.tint(facet) * self.interface.fresnel(facet, false);
        self.film.map_or(bare, |film| film.reflectance(facet, self.normal * self.straight(), bare))
    }

    fn metal(&self, facet: f64) -> Rgb {
        let bare = metal(self.base, facet);
        self.film.map_or(bare, |film| film.reflectance(facet, self.base, bare))
    }

    /// Reflectance of the microfacets of metal and dielectric met at cosine `facet`.
    pub fn reflectance(&self, facet: f64, inside: bool) -> Rgb {
        let mut reflectance = Rgb::ZERO;
        if self.opaque > 0.0 {
            reflectance += self.dielectric(facet) * self.opaque;
        }
        if self.transmitting > 0.0 {
            reflectance += self.tint(facet) * self.boundary(facet, inside) * self.transmitting;
        }
        let metallic = self.metallic();
        if metallic > 0.0 { reflectance + self.metal(facet) * metallic } else { reflectance }
    }

    /// What the metal reflects; 0 where there is none, since films take long.
    fn metal_if_any(&self, facet: f64) -> Rgb {
        if self.metallic() > 0.0 { self.metal(facet) } else { Rgb::ZERO }
    }

    /// Likewise the dielectric.
    fn dielectric_if_any(&self, facet: f64) -> Rgb {
        if self.opaque + self.transmitting > 0.0 { self.dielectric(facet) } else { Rgb::ZERO }
    }

    /// Averages over the hemisphere of what metal and, under a film, dielectric reflect.
    pub fn mean_reflectance(&self) -> [Rgb; 2] {
        if self.film.is_none() {
            return [self.base.map(schlick_average), Rgb::ZERO];
        }
        [
            mean(FILM_COSINES, |cos| self.metal_if_any(cos)),
            mean(FILM_COSINES, |cos| self.dielectric_if_any(cos)),
        ]
    }

    /// Single-scattering albedos of metal and opaque dielectric under a film for `w` with z > 0, by a small fixed rule on
    /// the disc that visible normals are drawn from.
    pub fn film_albedos(&self, w: DVec3) -> Option<[Rgb; 2]> {
        const RADII: [f64; 2] = [0.45, 0.85];
        const AXES: u32 = 4;
        self.film?;
        if self.ggx.is_smooth() {
            return Some([self.metal_if_any(w.z), self.dielectric_if_any(w.z)]);
        }
        let mut sums = [Rgb::ZERO; 2];
        for i in 0..AXES {
            let axis = DVec2::from_angle(std::f64::consts::TAU * (f64::from(i) + 0.25) / f64::from(AXES));
            for (j, radius) in RADII.into_iter().enumerate() {
                // The inner circle stands for a third of the disc.
                let share = [1.0, 2.0][j] / (3.0 * f64::from(AXES));
                let Some(h) = self.ggx.visible_normal(w, axis * radius) else { continue };
                let facet = w.dot(h).clamp(0.0, 1.0);
                let out = h * (2.0 * w.dot(h)) - w;
                if out.z > 0.0 {
                    let seen = share * 4.0 * out.z * self.ggx.visibility(w, out) / self.ggx.visible(w);
                    sums[0] += self.metal_if_any(facet) * seen;
                    sums[1] += self.dielectric_if_any(facet) * seen;
                }
            }
        }
        Some(sums)
    }

    /// Reflection scattered more than once: a cosine lobe's BRDF.
    pub fn scattered(&self, a: &View, b: &View) -> Rgb {
        let plain = self.bounced * (self.gap_scale * a.gap * b.gap);
        if self.transmitting == 0.0 {
            return plain;
        }
        let body = self.body.reflect[usize::from(a.inside)] * a.body_gap * b.body_gap;
        plain + self.normal * (self.transmitting * body)
    }
}
