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

/// Two directions brought to z > 0, and what the microfacet lobes need of both.
#[derive(Clone, Copy)]
pub struct Pair {
    kind: Kind,
    pub a: DVec3,
    pub b: DVec3,
    /// The microfacet normal that connects them, z > 0, in the frame of the front.
    pub half: DVec3,
    /// |cos| between it and the directions.
    facet: [f64; 2],
    /// Density of such normals at the interface and in the coat; 0 where these are smooth.
    density: f64,
    coat_density: f64,
    /// Indices of refraction over the length of the unnormalized half vector of refraction.
    bend: [f64; 2],
}

impl Pair {
    /// Whether some microfacet connects the directions.
    pub fn is_connected(&self) -> bool {
        self.density > 0.0
    }

    fn reversed(&self) -> Self {
        let ([f, g], [m, n]) = (self.facet, self.bend);
        Self { a: self.b, b: self.a, facet: [g, f], bend: [n, m], ..*self }
    }
}

impl Layered {
    /// Connects two directions, `None` where nothing can.
    pub fn pair(&self, a: DVec3, b: DVec3) -> Option<Pair> {
        if a.z.abs() < GRAZING || b.z.abs() < GRAZING {
            return None;
        }
        let reflects = a.z * b.z > 0.0;
        if !reflects && self.transmitting == 0.0 {
            return None;
        }
        let up = |w: DVec3| if w.z < 0.0 { mirror(w) } else { w };
        let (up_a, up_b) = (up(a), up(b));
        let kind = match (reflects, self.thin) {
            (true, _) => Kind::Reflect,
            (false, true) => Kind::Pass,
            (false, false) => Kind::Refract,
        };
        let mut pair = Pair {
            kind,
            a: up_a,
            b: up_b,
            half: DVec3::Z,
            facet: [0.0; 2],
            density: 0.0,
            coat_density: 0.0,
            bend: [0.0; 2],
        };
        if kind == Kind::Refract {
            self.refract_half(&mut pair, a, b)
        } else {
            self.reflect_half(&mut pair)
        }
        Some(pair)
    }

    fn reflect_half(&self, pair: &mut Pair) {
        pair.half = (pair.a + pair.b).normalize();
        let facet = pair.a.dot(pair.half).clamp(0.0, 1.0);
        pair.facet = [facet; 2];
        if !self.ggx.is_smooth() {
            pair.density = self.ggx.density(pair.half);
        }
        if let Some(coat) = &self.coat
            && !coat.is_smooth()
        {
            pair.coat_density = coat.ggx().density(pair.half);
        }
    }

    fn refract_half(&self, pair: &mut Pair, a: DVec3, b: DVec3) {
        if self.transmits_dirac() {
            return;
        }
        let ior = self.interface.ior();
        let (index_a, index_b) = if a.z > 0.0 { (1.0, ior) } else { (ior, 1.0) };
        let sum = a * index_a + b * index_b;
        let length = sum.length();
        let half = sum * (1f64.copysign(sum.z) / length);
        let (cos_a, cos_b) = (a.dot(half), b.dot(half));
        if cos_a * a.z > 0.0 && cos_b * b.z > 0.0 && half.z > 0.0 {
            pair.half = half;
            pair.facet = [cos_a.abs().min(1.0), cos_b.abs().min(1.0)];
            pair.density = self.ggx.density(half);
            pair.bend = [index_a / length, index_b / length];
        }
    }

    /// BSDF of light from `a` to `b`.
    fn value(&self, pair: &Pair, a: &View, b: &View) -> Rgb {
        let passed = a.passed.min(b.passed);
        if pair.kind != Kind::Reflect {
            return self.base * (self.transmitting * passed * self.transmittance(pair, a, b));
        }
        let mut below = self.bounced(a, b);
        if pair.density > 0.0 {
            let glossy = pair.density * self.ggx.visibility(pair.a, pair.b);
            below += self.reflectance(pair.facet[0], a.inside) * glossy;
        }
        let mut value = below * passed;
        if self.diffuse_scale > 0.0 {
            let body = eon(self.base, self.diffuse_roughness, pair.a, pair.b);
            let reached = a.under * a.body_passed * b.under * b.body_passed;
            value += body * (self.diffuse_scale * reached);
        }
        if let (Some(coat), Some(coat_a), Some(coat_b)) = (&self.coat, a.coat, b.coat) {
            let mut top = coat.scattered(coat_a, coat_b);
            if pair.coat_density > 0.0 {
                top += coat.glossy(pair.a, pair.b, pair.coat_density, pair.facet[0]);
            }
            value += Rgb::splat(top);
        }
        value
    }

    /// White transmission from `a` to `b`.
    fn transmittance(&self, pair: &Pair, a: &View, b: &View) -> f64 {
        let ior = if pair.kind == Kind::Refract && a.inside { self.interface.ior() } else { 1.0 };
        let bounced = self.body.cross * a.body_gap * b.body_gap / (ior * ior);
        if pair.density == 0.0 {
            return bounced;
        }
        // From the front in either case: the same number both ways, even where it vanishes.
        let through = 1.0 - self.interface.fresnel(pair.facet[usize::from(a.inside)], false);
        let microfacets = through * pair.density * self.ggx.visibility(pair.a, pair.b);
        let [facet_a, facet_b] = pair.facet;
        let spread = match pair.kind {
            Kind::Refract => 4.0 * facet_a * facet_b * pair.bend[1] * pair.bend[1],
            Kind::Reflect | Kind::Pass => 1.0,
        };
        bounced + microfacets * spread
    }

    /// Density of sampling `b` given `a` if lobes are chosen with `weights`.
    fn density(&self, pair: &Pair, weights: &[f64; LOBES]) -> f64 {
        let cosine = pair.b.z * FRAC_1_PI;
        let glossy = || if pair.density > 0.0 { pair.density * self.ggx.visible(pair.a) } else { 0.0 };
        match pair.kind {
            Kind::Reflect => {
                let mut density = weights[lobe::DIFFUSE] * cosine + weights[lobe::SPECULAR] * 0.25 * glossy();
                if let Some(coat) = &self.coat
                    && pair.coat_density > 0.0
                {
                    density += weights[lobe::COAT] * 0.25 * pair.coat_density * coat.ggx().visible(pair.a);
                }
                density
            }
            Kind::Pass => {
                weights[lobe::DIFFUSE_TRANSMISSION] * cosine + weights[lobe::TRANSMISSION] * 0.25 * glossy()
            }
            Kind::Refract => {
                let spread = pair.facet[0] * pair.facet[1] * pair.bend[1] * pair.bend[1];
                weights[lobe::DIFFUSE_TRANSMISSION] * cosine + weights[lobe::TRANSMISSION] * spread * glossy()
            }
        }
    }

    /// As [`super::Bsdf::eval`].
    pub fn eval(&self, w_l: DVec3, w_e: DVec3) -> Rgb {
        let Some(pair) = self.pair(w_l, w_e) else { return Rgb::ZERO };
        self.value(&pair, &self.view(w_l.z), &self.view(w_e.z))
    }

    /// As [`super::Bsdf::pdf`].
    pub fn pdf(&self, known: DVec3, new: DVec3) -> f64 {
        let Some(pair) = self.pair(known, new) else { return 0.0 };
        self.density(&pair, &self.weights(&self.view(known.z)))
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
        let (l, e) = (self.view(w_l.z), self.view(w_e.z));
        Evaluation {
            value: self.value(&pair, &l, &e),
            toward_light: self.density(&pair.reversed(), &self.weights(&e)),
            toward_eye: self.density(&pair, &self.weights(&l)),
        }
    }
}
