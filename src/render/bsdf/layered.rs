//! The principled surface: how its layers share the light.
//!
//! With E(μ) what the interface reflects (all bounces included), the diffuse body under it is
//! `color/π (1−E(a))(1−E(b)) / mean(1−E)`, reciprocal and lossless for white. The same is done under the coat for the
//! body; glossy lobes, which would gain energy that way, are attenuated by the smaller of both directions' factors.
//! With all weights at 1 and white colours nothing is lost or gained, apart from the coat over glossy lobes. Sheen lies
//! between coat and the rest and takes its share in the same way.

use super::{
    GRAZING, LOBES,
    albedo::{Albedo, Interface, Row, mean, mean_near_horizon},
    coat::Coat,
    compensation::{self, Body},
    film::Film,
    fresnel::edge_weight,
    ggx::Ggx,
    lobe,
    parameters::SurfaceParameters,
    sheen::Sheen,
};
use crate::math::{Rgb, scalar};
use glam::DVec3;

/// A principled surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct Layered {
    pub base: Rgb,
    /// Dielectric reflection relative to Fresnel's at normal incidence and, untinted, towards grazing.
    pub normal: Rgb,
    pub specular: f64,
    /// Shares of opaque and of transmitting dielectric; the rest is metal.
    pub opaque: f64,
    pub transmitting: f64,
    pub diffuse_roughness: f64,
    pub thin: bool,
    pub ggx: Ggx,
    pub interface: &'static Interface,
    /// Interfaces for red and blue, where they are not those for green.
    pub dispersed: Option<[&'static Interface; 2]>,
    row: Row,
    pub coat: Option<Coat>,
    pub sheen: Option<Sheen>,
    pub film: Option<Film>,
    /// Share of the diffuse body that is reflected, and what the rest transmits.
    pub kept: f32,
    through: [f32; 3],
    pub body: Body,
    /// Albedo of light scattered more than once by metal and opaque dielectric, relative to the gap.
    pub bounced: Rgb,
    /// Scale of the lobe that carries it.
    pub gap_scale: f64,
    /// The dielectric's share of `bounced` for white, or under a film for the channel that reflects most.
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
    /// What is refracted of red, green and blue light, where they do not refract alike.
    bands: Option<[f64; 3]>,
    /// What metal and opaque dielectric reflect by single scattering, where a film makes that a question.
    film: Option<[Rgb; 2]>,
    pub coat: Option<Albedo>,
    /// What passes coat and sheen, for the body (whichever side).
    pub body_passed: f64,
    /// What passes the coat, and coat and sheen, for the glossy lobes.
    pub coat_passed: f64,
    pub passed: f64,
    /// Albedo of the sheen if it were white.
    sheen: f64,
    /// What passes the interface into the opaque body.
    pub under: f64,
    /// What single scattering loses on metal and opaque dielectric, and on the transmitting one.
    pub gap: f64,
    pub body_gap: f64,
}

/// How far albedos under a film may be above what their small rule finds.
const FILM_MARGIN: f64 = 1.05;
/// Azimuths at which albedos are averaged: the directions of anisotropic surfaces that are neither axis.
const AZIMUTHS: [f64; 2] = [0.4, 1.17];

impl Layered {
    /// From parameters in their ranges.
    pub fn new(p: &SurfaceParameters) -> Self {
        let ggx = Ggx::new(p.roughness, p.anisotropy, p.anisotropy_rotation);
        let interface = Interface::of(if p.metallic < 1.0 { p.ior } else { 1.5 });
        let (opaque, transmitting) =
            ((1.0 - p.metallic) * (1.0 - p.transmission), (1.0 - p.metallic) * p.transmission);
        let through = p.diffuse_transmission_color * p.diffuse_transmission;
        let mut surface = Self {
            base: p.base_color,
            normal: p.specular_color * p.specular,
            specular: p.specular,
            opaque,
            transmitting,
            diffuse_roughness: p.diffuse_roughness,
            thin: p.thin_walled,
            ggx,
            interface,
            dispersed: p.dispersed_indices().filter(|_| transmitting > 0.0).map(|n| n.map(Interface::of)),
            row: Row::new(&ggx),
            coat: (p.coat > 0.0).then(|| Coat::new(p.coat, p.coat_roughness, p.coat_ior)),
            sheen: Sheen::new(p.sheen_color, p.sheen_roughness),
            film: Film::new(p.film, p.film_ior, p.film_thickness),
            kept: (1.0 - p.diffuse_transmission) as f32,
            through: if opaque > 0.0 { through.as_vec3().to_array() } else { [0.0; 3] },
            body: Body::NONE,
            bounced: Rgb::ZERO,
            gap_scale: 0.0,
            bounced_white: 0.0,
            diffuse_scale: 0.0,
        };
        surface.complete();
        surface
    }

    /// What follows from averages over the hemisphere.
    fn complete(&mut self) {
        let average = self.average(false);
        let fresnel = self.interface.fresnel_average();
        self.gap_scale = compensation::scale(1.0 - average.total);
        self.bounced_white = compensation::bounced(fresnel, average.total);
        let [metal, dielectric] = self.mean_reflectance();
        let bounced = |c: Rgb| c.map(|c| compensation::bounced(c, average.total));
        let dielectric = match self.film {
            Some(_) => {
                let dielectric = bounced(dielectric);
                self.bounced_white = dielectric.max_element();
                dielectric
            }
            None => self.normal * self.bounced_white,
        };
        self.bounced = bounced(metal) * self.metallic() + dielectric * self.opaque;
        if self.transmitting > 0.0 && !self.ggx.is_smooth() {
            self.body = if self.thin {
                Body::shell(fresnel, average)
            } else {
                Body::solid(fresnel, self.interface.ior(), average, self.average(true))
            };
        }
        if self.opaque > 0.0 {
            let layered = self.coat.is_some() || self.sheen.is_some() || self.film.is_some();
            let mean = if layered { self.mean_reached() } else { self.under(average, None) };
            self.diffuse_scale = self.opaque / mean.max(1e-6);
        }
    }

    /// Average over the hemisphere of what reaches the opaque body.
    fn mean_reached(&self) -> f64 {
        let azimuths = if self.ggx.is_isotropic() { &AZIMUTHS[..1] } else { &AZIMUTHS[..] };
        let along = |azimuth: &f64| {
            let reached = |cos: f64| {
                let view = self.view(
                    glam::DVec2::from_angle(*azimuth).extend(0.0) * (1.0 - cos * cos).sqrt() + DVec3::Z * cos,
                );
                view.under * view.body_passed
            };
            let n = if self.film.is_some() { 6 } else { 12 };
            if self.sheen.is_some() { mean_near_horizon(n, reached) } else { mean(n, reached) }
        };
        azimuths.iter().map(along).sum::<f64>() / azimuths.len() as f64
    }

    /// Share of metal.
    pub fn metallic(&self) -> f64 {
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

    fn average(&self, inside: bool) -> Albedo {
        if self.ggx.is_isotropic() {
            self.interface.average(inside, self.row)
        } else {
            self.interface.stretched(inside).average(&self.ggx)
        }
    }

    /// Single-scattering albedos for `w` with z > 0 on the front or on the inside.
    fn single(&self, w: DVec3, inside: bool) -> Albedo {
        self.single_at(self.interface, w, inside)
    }

    fn single_at(&self, interface: &Interface, w: DVec3, inside: bool) -> Albedo {
        if self.ggx.is_smooth() {
            Albedo::smooth(w.z, interface.eta(inside))
        } else if self.ggx.is_isotropic() {
            interface.albedo(inside, self.row, w.z)
        } else {
            interface.stretched(inside).albedo(&self.ggx, w)
        }
    }

    /// What an opaque interface of albedo `a`, or of `film` where it has one, lets into the body, in the channel that
    /// reflects most, so that body and reflection do not get complementary colours.
    fn under(&self, a: Albedo, film: Option<Rgb>) -> f64 {
        let once = match film {
            Some(film) => FILM_MARGIN * film.max_element(),
            None => {
                let normal = self.normal.max_element();
                normal * a.reflected + (self.specular - normal) * a.edge
            }
        };
        let tint = if self.film.is_some() { 1.0 } else { self.normal.max_element() };
        let again = tint * self.bounced_white;
        (1.0 - once - again * (1.0 - a.total)).clamp(0.0, 1.0)
    }

    /// The layers as seen from a direction.
    pub fn view(&self, w: DVec3) -> View {
        let inside = w.z < 0.0 && self.is_solid();
        let w = if w.z < 0.0 { super::mirror(w) } else { w };
        let outer = self.single(w, false);
        let near = if inside { self.single(w, true) } else { outer };
        let bands = self.dispersed.map(|[red, blue]| {
            let transmitted = |band| self.single_at(band, w, inside).transmitted;
            [transmitted(red), near.transmitted, transmitted(blue)]
        });
        let film = self.film_albedos(w);
        let coat = self.coat.as_ref().map(|c| c.albedo(c.cos(w).abs()));
        let coated = match (&self.coat, coat) {
            (Some(c), Some(a)) => c.passed(a),
            _ => 1.0,
        };
        let sheen = self.sheen.map_or(0.0, |sheen| sheen.albedo(w.z));
        let body_passed = coated * self.sheen.map_or(1.0, |layer| layer.passed(sheen));
        let gap = (1.0 - outer.total).max(0.0);
        View {
            inside,
            cos: w.z,
            outer,
            near,
            bands,
            film,
            coat: coat.filter(|_| !inside),
            body_passed,
            coat_passed: if inside { 1.0 } else { coated },
            passed: if inside { 1.0 } else { body_passed },
            sheen: if inside { 0.0 } else { sheen },
            under: if self.opaque > 0.0 { self.under(outer, film.map(|[_, f]| f)) } else { 0.0 },
            gap,
            body_gap: if self.thin { gap } else { (1.0 - near.reflected - near.transmitted).max(0.0) },
        }
    }

    /// Probabilities of choosing the lobes from a view: their albedos, normalized.
    pub fn weights(&self, view: &View) -> [f64; LOBES] {
        let View { outer, near, .. } = view;
        let (base, normal) = (scalar(self.base), scalar(self.normal));
        let edge = self.specular - normal;
        let mut specular = match view.film {
            Some([metal, dielectric]) => self.metallic() * scalar(metal) + self.opaque * scalar(dielectric),
            None => {
                self.metallic() * outer.total * (base + (1.0 - base) * edge_weight(view.cos))
                    + self.opaque * (normal * outer.reflected + edge * outer.edge)
            }
        };
        let mut diffuse = scalar(self.bounced) * view.gap;
        let (mut transmitted, mut across) = (0.0, 0.0);
        if self.transmitting > 0.0 {
            let share = self.transmitting * view.passed;
            specular += self.transmitting * (normal * near.reflected + edge * near.edge);
            diffuse += self.transmitting * normal * (1.0 - self.crossing(view)) * view.body_gap;
            transmitted =
                share * if self.thin { (near.total - near.reflected).max(0.0) } else { near.transmitted };
            across = share * base * self.crossing(view) * view.body_gap;
        }
        let body = self.opaque * view.under * view.body_passed;
        let mut weights = [0.0; LOBES];
        weights[lobe::DIFFUSE] = diffuse * view.passed + body * base * f64::from(self.kept);
        weights[lobe::SPECULAR] = specular * view.passed;
        weights[lobe::DIFFUSE_TRANSMISSION] = across + body * scalar(self.through());
        match view.bands {
            None => weights[lobe::TRANSMISSION] = transmitted * base,
            Some(bands) => {
                for (i, lobe) in lobe::BANDS.into_iter().enumerate() {
                    weights[lobe] = self.transmitting * view.passed * bands[i] * self.base[i] / 3.0;
                }
            }
        }
        if let Some(sheen) = &self.sheen {
            weights[lobe::DIFFUSE] += scalar(sheen.color()) * view.sheen * view.coat_passed;
        }
        if let (Some(coat), Some(a)) = (&self.coat, view.coat) {
            weights[lobe::COAT] = coat.weight() * a.reflected;
            weights[lobe::DIFFUSE] += coat.scattered_albedo(a);
        }
        let sum: f64 = weights.iter().sum();
        if sum > 0.0 { weights.map(|w| w / sum) } else { weights }
    }

    /// As [`super::Bsdf::lobe_weights`].
    pub fn lobe_weights(&self, known: glam::DVec3) -> [f64; LOBES] {
        if known.z.abs() < GRAZING { [0.0; LOBES] } else { self.weights(&self.view(known)) }
    }

    fn crossing(&self, view: &View) -> f64 {
        self.body.crossing[usize::from(view.inside)]
    }

    /// What diffuse transmission lets through.
    pub fn through(&self) -> Rgb {
        Rgb::from_array(self.through.map(f64::from))
    }

    /// Whether some light leaves on the other side.
    pub fn has_other_side(&self) -> bool {
        self.transmitting > 0.0 || self.through != [0.0; 3]
    }

    /// Gives the coat the unit normal `n` of its own.
    pub fn tilt_coat(&mut self, n: DVec3) {
        self.coat = self.coat.map(|coat| coat.tilted(n));
    }

    /// Whether some lobe has a density.
    pub fn has_smooth(&self) -> bool {
        let body = self.opaque > 0.0 && (self.base != Rgb::ZERO || self.has_other_side());
        body || self.sheen.is_some() || !self.ggx.is_smooth() || self.coat.is_some_and(|c| !c.is_smooth())
    }

    /// Whether some lobe is a Dirac event.
    pub fn has_delta(&self) -> bool {
        let reflects = self.metallic() > 0.0
            || (self.specular > 0.0 && self.interface.ior() > 1.0)
            || self.film.is_some();
        (self.ggx.is_smooth() && reflects)
            || self.transmits_dirac()
            || self.coat.is_some_and(|c| c.is_smooth())
    }

    /// Mean albedo of the front.
    pub fn albedo(&self) -> Rgb {
        let average = self.average(false);
        let gap = 1.0 - average.total;
        let [metal, film] = self.mean_reflectance();
        let edge = Rgb::splat(self.specular) - self.normal;
        let dielectric = match self.film {
            Some(_) => film * average.total,
            None => self.normal * average.reflected + edge * average.edge,
        };
        let reflected = metal * (self.metallic() * average.total)
            + dielectric * (self.opaque + self.transmitting)
            + self.bounced * gap;
        let opaque = self.base * f64::from(self.kept) + self.through();
        let clear = self.film.map_or(Rgb::splat(1.0 - average.reflected), |_| Rgb::ONE - dielectric);
        let body = opaque * (self.opaque * self.under(average, self.film.map(|_| dielectric)))
            + self.base * clear * self.transmitting;
        let sheen = self.sheen.map_or(Rgb::ZERO, |sheen| sheen.color() * sheen.mean_albedo());
        let passed = self.coat.map_or(1.0, |coat| coat.mean_passed());
        let below = (reflected + body) * (1.0 - sheen.max_element()) + sheen;
        (below * passed + Rgb::splat(1.0 - passed)).clamp(Rgb::ZERO, Rgb::ONE)
    }
}
