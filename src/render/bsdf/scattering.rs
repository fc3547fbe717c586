//! Values and densities of the principled surface for a pair of directions.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::{
    Evaluation, GRAZING, LOBES,
    diffuse::eon,
    layered::{Layered, View},
    lobe, mirror,
};
use crate::math::Rgb;

/// How a pair of directions is connected.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Reflect,
    /// Through a thin wall.
    Pass,
    /// Through the boundary of a solid.
    Refract,
}

/// The microfacet that connects a pair of directions.
#[derive(Clone, Copy)]
pub struct Facet {
    /// Its normal, z > 0, in the frame of the front.
    pub half: DVec3,
    /// |cos| between it and the directions.
    cos: [f64; 2],
    /// Density of such normals; 0 where the interface is smooth or nothing connects.
    density: f64,
    /// Indices of refraction over the length of the unnormalized half vector of refraction.
    bend: [f64; 2],
}

impl Facet {
    const NONE: Self = Self { half: DVec3::Z, cos: [0.0; 2], density: 0.0, bend: [0.0; 2] };

    /// Whether it is there.
    pub fn is_connected(&self) -> bool {
        self.density > 0.0
    }

    fn reversed(&self) -> Self {
        let ([f, g], [m, n]) = (self.cos, self.bend);
        Self { cos: [g, f], bend: [n, m], ..*self }
    }
}

/// Two directions brought to z > 0, and what the microfacet lobes need of both.
#[derive(Clone, Copy)]
pub struct Pair {
    kind: Kind,
    pub a: DVec3,
    pub b: DVec3,
    facet: Facet,
    /// Those of red and blue light, where its index is not that of green light.
    others: Option<[Facet; 2]>,
    /// Density of the half vector in the coat; 0 where that is smooth.
    coat_density: f64,
}

impl Pair {
    /// The microfacet by which `lobe` connects the directions.
    pub fn facet(&self, lobe: usize) -> &Facet {
        match (&self.others, lobe) {
            (Some([red, _]), lobe::TRANSMISSION_RED) => red,
            (Some([_, blue]), lobe::TRANSMISSION_BLUE) => blue,
            _ => &self.facet,
        }
    }

    fn reversed(&self) -> Self {
        let others = self.others.map(|others| others.map(|facet| facet.reversed()));
        Self { a: self.b, b: self.a, facet: self.facet.reversed(), others, ..*self }
    }
}

impl Layered {
    /// Connects two directions, `None` where nothing can.
    pub fn pair(&self, a: DVec3, b: DVec3) -> Option<Pair> {
        if a.z.abs() < GRAZING || b.z.abs() < GRAZING {
            return None;
        }
        let reflects = a.z * b.z > 0.0;
        if !reflects && !self.has_other_side() {
            return None;
        }
        let up = |w: DVec3| if w.z < 0.0 { mirror(w) } else { w };
        let kind = match (reflects, self.is_solid()) {
            (true, _) => Kind::Reflect,
            (false, false) => Kind::Pass,
            (false, true) => Kind::Refract,
        };
        let mut pair = Pair { kind, a: up(a), b: up(b), facet: Facet::NONE, others: None, coat_density: 0.0 };
        if kind == Kind::Refract {
            pair.facet = self.bent(a, b, self.interface.ior());
            pair.others = self.dispersed.map(|others| others.map(|other| self.bent(a, b, other.ior())));
        } else {
            self.reflect_half(&mut pair)
        }
        Some(pair)
    }

    fn reflect_half(&self, pair: &mut Pair) {
        let half = (pair.a + pair.b).normalize();
        let density = if self.ggx.is_smooth() { 0.0 } else { self.ggx.density(half) };
        pair.facet = Facet { half, cos: [pair.a.dot(half).clamp(0.0, 1.0); 2], density, bend: [0.0; 2] };
        pair.coat_density = self.coat.as_ref().map_or(0.0, |coat| coat.density(half));
    }

    /// The microfacet that refracts at a boundary of index `ior`.
    fn bent(&self, a: DVec3, b: DVec3, ior: f64) -> Facet {
        if self.transmits_dirac() {
            return Facet::NONE;
        }
        let (index_a, index_b) = if a.z > 0.0 { (1.0, ior) } else { (ior, 1.0) };
        let sum = a * index_a + b * index_b;
        let length = sum.length();
        let half = sum * (1f64.copysign(sum.z) / length);
        let (cos_a, cos_b) = (a.dot(half), b.dot(half));
        if cos_a * a.z > 0.0 && cos_b * b.z > 0.0 && half.z > 0.0 {
            let cos = [cos_a.abs().min(1.0), cos_b.abs().min(1.0)];
            Facet { half, cos, density: self.ggx.density(half), bend: [index_a / length, index_b / length] }
        } else {
            Facet::NONE
        }
    }

    /// BSDF of light from `a` to `b`.
    fn value(&self, pair: &Pair, a: &View, b: &View) -> Rgb {
        let passed = a.passed.min(b.passed);
        let reached = self.diffuse_scale * (a.under * a.body_passed * b.under * b.body_passed);
        if pair.kind != Kind::Reflect {
            let clear = if self.transmitting > 0.0 {
                self.base * (self.transmitting * passed) * self.transmittance(pair, a, b)
            } else {
                Rgb::ZERO
            };
            return clear + self.through() * (reached * FRAC_1_PI);
        }
        let mut below = self.scattered(a, b);
        if pair.facet.density > 0.0 {
            let glossy = pair.facet.density * self.ggx.visibility(pair.a, pair.b);
            below += self.reflectance(pair.facet.cos[0], a.inside) * glossy;
        }
        let mut value = below * passed;
        if reached > 0.0 {
            let body = eon(self.base, self.diffuse_roughness, pair.a, pair.b);
            value += body * (reached * f64::from(self.kept));
        }
        if let Some(sheen) = self.sheen.as_ref().filter(|_| !a.inside) {
            value += sheen.value(pair.a, pair.b, pair.facet.half) * a.coat_passed.min(b.coat_passed);
        }
        if let (Some(coat), Some(coat_a), Some(coat_b)) = (&self.coat, a.coat, b.coat) {
            let directions = [pair.a, pair.b];
            value +=
                Rgb::splat(coat.value(directions, pair.coat_density, pair.facet.cos[0], [coat_a, coat_b]));
        }
        value
    }

    /// White transmission from `a` to `b`.
    fn transmittance(&self, pair: &Pair, a: &View, b: &View) -> Rgb {
        let green = self.interface.ior();
        let indices = match self.dispersed {
            Some([red, blue]) => Rgb::new(red.ior(), green, blue.ior()),
            None => Rgb::splat(green),
        };
        let scale = if pair.kind == Kind::Refract && a.inside { indices * indices } else { Rgb::ONE };
        let bounced = Rgb::splat(self.body.cross * a.body_gap * b.body_gap) / scale;
        let spread = |facet: &Facet| match pair.kind {
            Kind::Refract => 4.0 * facet.cos[0] * facet.cos[1] * facet.bend[1] * facet.bend[1],
            Kind::Reflect | Kind::Pass => 1.0,
        };
        let microfacets = |facet: &Facet| {
            if facet.density == 0.0 {
                return Rgb::ZERO;
            }
            // From the front in either case: the same number both ways, even where it vanishes.
            let through = Rgb::ONE - self.boundary(facet.cos[usize::from(a.inside)], false);
            through * (facet.density * self.ggx.visibility(pair.a, pair.b) * spread(facet))
        };
        let glossy = match &pair.others {
            None => microfacets(&pair.facet),
            Some([red, blue]) => {
                Rgb::new(microfacets(red).x, microfacets(&pair.facet).y, microfacets(blue).z)
            }
        };
        bounced + glossy
    }

    /// Density of sampling `b` given `a` if lobes are chosen with `weights`.
    fn density(&self, pair: &Pair, weights: &[f64; LOBES]) -> f64 {
        let cosine = pair.b.z * FRAC_1_PI;
        let glossy = |facet: &Facet| {
            if facet.density > 0.0 { facet.density * self.ggx.visible(pair.a) } else { 0.0 }
        };
        match pair.kind {
            Kind::Reflect => {
                let mut density =
                    weights[lobe::DIFFUSE] * cosine + weights[lobe::SPECULAR] * 0.25 * glossy(&pair.facet);
                if let Some(coat) = &self.coat
                    && pair.coat_density > 0.0
                {
                    density += weights[lobe::COAT] * 0.25 * pair.coat_density * coat.visible(pair.a);
                }
                density
            }
            Kind::Pass => {
                weights[lobe::DIFFUSE_TRANSMISSION] * cosine
                    + weights[lobe::TRANSMISSION] * 0.25 * glossy(&pair.facet)
            }
            Kind::Refract => {
                let band = |lobe: usize| {
                    let facet = pair.facet(lobe);
                    weights[lobe]
                        * facet.cos[0]
                        * facet.cos[1]
                        * facet.bend[1]
                        * facet.bend[1]
                        * glossy(facet)
                };
                let bands = match pair.others {
                    Some(_) => lobe::BANDS.map(band).iter().sum(),
                    None => band(lobe::TRANSMISSION),
                };
                weights[lobe::DIFFUSE_TRANSMISSION] * cosine + bands
            }
        }
    }

    /// As [`super::Bsdf::eval`].
    pub fn eval(&self, w_l: DVec3, w_e: DVec3) -> Rgb {
        let Some(pair) = self.pair(w_l, w_e) else { return Rgb::ZERO };
        self.value(&pair, &self.view(w_l), &self.view(w_e))
    }

    /// As [`super::Bsdf::pdf`].
    pub fn pdf(&self, known: DVec3, new: DVec3) -> f64 {
        let Some(pair) = self.pair(known, new) else { return 0.0 };
        self.density(&pair, &self.weights(&self.view(known)))
    }

    /// As [`super::Bsdf::lobe_pdf`].
    pub fn lobe_pdf(&self, known: DVec3, lobe: usize, new: DVec3) -> f64 {
        let Some(pair) = self.pair(known, new) else { return 0.0 };
        if lobe == lobe::COAT && known.z < 0.0 && self.is_solid() {
            return 0.0;
        }
        let mut weights = [0.0; LOBES];
        let Some(weight) = weights.get_mut(lobe) else { return 0.0 };
        *weight = 1.0;
        self.density(&pair, &weights)
    }

    /// As [`super::Bsdf::evaluate`].
    pub fn evaluate(&self, w_l: DVec3, w_e: DVec3) -> Evaluation {
        let Some(pair) = self.pair(w_l, w_e) else { return Evaluation::default() };
        let (l, e) = (self.view(w_l), self.view(w_e));
        Evaluation {
            value: self.value(&pair, &l, &e),
            toward_light: self.density(&pair.reversed(), &self.weights(&e)),
            toward_eye: self.density(&pair, &self.weights(&l)),
        }
    }
}
