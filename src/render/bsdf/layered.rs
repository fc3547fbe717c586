//! The principled surface: how its layers share the light.
//!
//! With E(μ) what the interface reflects (all bounces included), the diffuse body under it is
//! `color/π (1−E(a))(1−E(b)) / mean(1−E)`, reciprocal and lossless for white. The same is done under the coat for the
//! body; glossy lobes, which would gain energy that way, are attenuated by the smaller of both directions' factors.
//! With all weights at 1 and white colours nothing is lost or gained, apart from the coat over glossy lobes.

use super::{
    GRAZING, LOBES,
    albedo::{Albedo, Interface, Widths},
    coat::Coat,
    compensation::{self, Body},
    fresnel::{edge_weight, metal},
    ggx::Ggx,
    lobe,
    parameters::SurfaceParameters,
};
use crate::math::{Rgb, scalar};

/// A principled surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct Layered {
    pub base: Rgb,
    /// Dielectric reflection relative to Fresnel's at normal incidence and, untinted, towards grazing.
    normal: Rgb,
    specular: f64,
    /// Shares of opaque and of transmitting dielectric; the rest is metal.
    opaque: f64,
    pub transmitting: f64,
    pub diffuse_roughness: f64,
    pub thin: bool,
    pub ggx: Ggx,
    pub interface: &'static Interface,
    widths: Widths,
    pub coat: Option<Coat>,
    pub body: Body,
    /// Albedo of light scattered more than once by metal and opaque dielectric, relative to the gap.
    bounced: Rgb,
    /// Scale of the lobe that carries it.
    pub gap_scale: f64,
    /// The dielectric's share of `bounced` for white.
    bounced_white: f64,
    /// Share of the diffuse body over the mean of what reaches it.
    pub diffuse_scale: f64,
}

/// What the layers do with one direction.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Behind the surface of a transmitting solid.
    pub inside: bool,
    /// |cosθ|.
    pub cos: f64,
    outer: Albedo,
    near: Albedo,
    pub coat: Option<Albedo>,
    /// What passes the coat, for the body (whichever side) and for the glossy lobes.
    pub body_passed: f64,
    pub passed: f64,
    /// What passes the interface into the opaque body.
    pub under: f64,
    /// What single scattering loses on metal and opaque dielectric, and on the transmitting one.
    pub gap: f64,
    pub body_gap: f64,
}

impl Layered {
    /// From parameters in their ranges.
    pub fn new(p: &SurfaceParameters) -> Self {
        let ggx = Ggx::new(p.roughness, p.anisotropy, p.anisotropy_rotation);
        let coat = (p.coat > 0.0).then(|| Coat::new(p.coat, p.coat_roughness, p.coat_ior));
        let interface = Interface::of(if p.metallic < 1.0 { p.ior } else { 1.5 });
        let widths = Widths::new(&ggx);
        let (opaque, transmitting) =
            ((1.0 - p.metallic) * (1.0 - p.transmission), (1.0 - p.metallic) * p.transmission);
        let normal = p.specular_color * p.specular;
        let average = interface.average(false, widths);
        let fresnel = interface.fresnel_average();
        let bounced_white = compensation::bounced(fresnel, average.total);
        let bounced_metal =
            p.base_color.map(|c| compensation::bounced(compensation::schlick_average(c), average.total));
        let mut surface = Self {
            base: p.base_color,
            normal,
            specular: p.specular,
            opaque,
            transmitting,
            diffuse_roughness: p.diffuse_roughness,
            thin: p.thin_walled,
            ggx,
            interface,
            widths,
            coat,
            body: Body::NONE,
            bounced: bounced_metal * p.metallic + normal * (bounced_white * opaque),
            gap_scale: compensation::scale(1.0 - average.total),
            bounced_white,
            diffuse_scale: 0.0,
        };
        if transmitting > 0.0 && !ggx.is_smooth() {
            surface.body = if p.thin_walled {
                Body::shell(fresnel, average)
            } else {
                Body::solid(fresnel, interface.ior(), average, interface.average(true, widths))
            };
        }
        if opaque > 0.0 {
            let mean = match &surface.coat {
                None => surface.under(average),
                Some(coat) => coat.mean_passed(|cos| surface.under(surface.outer_albedo(cos))),
            };
            surface.diffuse_scale = opaque / mean.max(1e-6);
        }
        surface
    }

    fn metallic(&self) -> f64 {
        // Exactly 0 where it shall be: the shares are products of at most two roundings.
        let rest = 1.0 - self.opaque - self.transmitting;
        if rest > 1e-12 { rest } else { 0.0 }
    }

    /// Whether it transmits into a medium of its own.
    pub fn is_solid(&self) -> bool {
        self.transmitting > 0.0 && !self.thin
    }

    /// Whether its transmission is a Dirac event.
    pub fn transmits_dirac(&self) -> bool {
        self.transmitting > 0.0 && (self.ggx.is_smooth() || (!self.thin && self.interface.ior() == 1.0))
    }

    fn outer_albedo(&self, cos: f64) -> Albedo {
        if self.ggx.is_smooth() {
            Albedo::smooth(cos, self.interface.ior())
        } else {
            self.interface.albedo(false, self.widths, cos)
        }
    }

    fn inner_albedo(&self, cos: f64) -> Albedo {
        if self.ggx.is_smooth() {
            Albedo::smooth(cos, self.interface.eta(true))
        } else {
            self.interface.albedo(true, self.widths, cos)
        }
    }

    /// What an opaque interface of albedo `a` lets into the body, in the channel that reflects most, so that body and
    /// reflection do not get complementary colours.
    fn under(&self, a: Albedo) -> f64 {
        let reflected = self.normal.max_element() * (a.reflected + self.bounced_white * (1.0 - a.total))
            + (self.specular - self.normal.max_element()) * a.edge;
        (1.0 - reflected).clamp(0.0, 1.0)
    }

    /// The layers as seen from a direction at signed cosine `z`.
    pub fn view(&self, z: f64) -> View {
        let (cos, inside) = (z.abs(), z < 0.0 && self.is_solid());
        let outer = self.outer_albedo(cos);
        let near = if inside { self.inner_albedo(cos) } else { outer };
        let coat = self.coat.as_ref().map(|c| c.albedo(cos));
        let body_passed = match (&self.coat, coat) {
            (Some(c), Some(a)) => c.passed(a),
            _ => 1.0,
        };
        let gap = (1.0 - outer.total).max(0.0);
        View {
            inside,
            cos,
            outer,
            near,
            coat: coat.filter(|_| !inside),
            body_passed,
            passed: if inside { 1.0 } else { body_passed },
            under: if self.opaque > 0.0 { self.under(outer) } else { 0.0 },
            gap,
            body_gap: if self.thin { gap } else { (1.0 - near.reflected - near.transmitted).max(0.0) },
        }
    }

    /// Probabilities of choosing the lobes from a view: their albedos, normalized.
    pub fn weights(&self, view: &View) -> [f64; LOBES] {
        let View { outer, near, .. } = view;
        let (base, normal) = (scalar(self.base), scalar(self.normal));
        let edge = self.specular - normal;
        let grazing = edge_weight(view.cos);
        let mut specular = self.metallic() * outer.total * (base + (1.0 - base) * grazing)
            + self.opaque * (normal * outer.reflected + edge * outer.edge);
        let mut diffuse = scalar(self.bounced) * view.gap;
        let (mut transmitted, mut across) = (0.0, 0.0);
        if self.transmitting > 0.0 {
            let share = self.transmitting * view.passed;
            specular += self.transmitting * (normal * near.reflected + edge * near.edge);
            diffuse += self.transmitting * normal * (1.0 - self.crossing(view)) * view.body_gap;
            transmitted = share
                * base
                * if self.thin { (near.total - near.reflected).max(0.0) } else { near.transmitted };
            across = share * base * self.crossing(view) * view.body_gap;
        }
        let body = self.opaque * base * view.under * view.body_passed;
        let mut weights = [0.0; LOBES];
        weights[lobe::DIFFUSE] = diffuse * view.passed + body;
        weights[lobe::SPECULAR] = specular * view.passed;
        weights[lobe::TRANSMISSION] = transmitted;
        weights[lobe::DIFFUSE_TRANSMISSION] = across;
        if let (Some(coat), Some(a)) = (&self.coat, view.coat) {
            weights[lobe::COAT] = coat.weight * a.reflected;
            weights[lobe::DIFFUSE] += coat.scattered_albedo(a);
        }
        let sum: f64 = weights.iter().sum();
        if sum > 0.0 { weights.map(|w| w / sum) } else { weights }
    }

    /// As [`super::Bsdf::lobe_weights`].
    pub fn lobe_weights(&self, known: glam::DVec3) -> [f64; LOBES] {
        if known.z.abs() < GRAZING { [0.0; LOBES] } else { self.weights(&self.view(known.z)) }
    }

    fn crossing(&self, view: &View) -> f64 {
        self.body.crossing[usize::from(view.inside)]
    }

    /// Reflectance of the microfacets of metal and dielectric met at cosine `facet`.
    pub fn reflectance(&self, facet: f64, inside: bool) -> Rgb {
        let mut dielectric = 0.0;
        if self.opaque + self.transmitting > 0.0 {
            dielectric = (self.opaque + if inside { 0.0 } else { self.transmitting })
                * self.interface.fresnel(facet, false);
            if inside {
                dielectric += self.transmitting * self.interface.fresnel(facet, true);
            }
        }
        let tinted =
            (self.normal + (Rgb::splat(self.specular) - self.normal) * edge_weight(facet)) * dielectric;
        let metallic = self.metallic();
        if metallic > 0.0 { tinted + metal(self.base, facet) * metallic } else { tinted }
    }

    /// Reflection scattered more than once: a cosine lobe's BRDF.
    pub fn bounced(&self, a: &View, b: &View) -> Rgb {
        let plain = self.bounced * (self.gap_scale * a.gap * b.gap);
        if self.transmitting == 0.0 {
            return plain;
        }
        let body = self.body.reflect[usize::from(a.inside)] * a.body_gap * b.body_gap;
        plain + self.normal * (self.transmitting * body)
    }

    /// Whether some lobe has a density.
    pub fn has_smooth(&self) -> bool {
        let body = self.opaque > 0.0 && self.base != Rgb::ZERO;
        body || !self.ggx.is_smooth() || self.coat.is_some_and(|c| !c.is_smooth())
    }

    /// Whether some lobe is a Dirac event.
    pub fn has_delta(&self) -> bool {
        let reflects = self.metallic() > 0.0 || (self.specular > 0.0 && self.interface.ior() > 1.0);
        (self.ggx.is_smooth() && reflects)
            || self.transmits_dirac()
            || self.coat.is_some_and(|c| c.is_smooth())
    }

    /// Mean albedo of the front.
    pub fn albedo(&self) -> Rgb {
        let average = self.interface.average(false, self.widths);
        let gap = 1.0 - average.total;
        let edge = Rgb::splat(self.specular) - self.normal;
        let dielectric = self.normal * average.reflected + edge * average.edge;
        let reflected = self.base.map(compensation::schlick_average) * (self.metallic() * average.total)
            + dielectric * (self.opaque + self.transmitting)
            + self.bounced * gap;
        let body = self.opaque * self.under(average) + self.transmitting * (1.0 - average.reflected);
        let passed = self.coat.map_or(1.0, |coat| coat.mean_passed(|_| 1.0));
        ((reflected + self.base * body) * passed + Rgb::splat(1.0 - passed)).clamp(Rgb::ZERO, Rgb::ONE)
    }
}
