//! Sampling of the principled surface's lobes, its inverse, and its Dirac events.

use glam::DVec3;

use super::{
    BsdfSample, DeltaEvent, GRAZING, Mode, Side, fresnel::refract, ggx::Ggx, layered::Layered, lobe, mirror,
};
use crate::{
    math::Rgb,
    warp::{cosine_hemisphere_to_square, square_to_cosine_hemisphere},
};

/// The mirror direction of `w` about the microfacet normal `h`.
fn reflect(w: DVec3, h: DVec3) -> DVec3 {
    h * (2.0 * w.dot(h)) - w
}

impl Layered {
    /// The lobe that `u` in [0, 1) selects.
    pub fn choose(&self, known: DVec3, u: f64) -> Option<usize> {
        let weights = self.lobe_weights(known);
        let mut rest = u;
        let mut last = None;
        for (lobe, &weight) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            if rest < weight {
                return Some(lobe);
            }
            rest -= weight;
            last = Some(lobe);
        }
        last
    }

    /// As [`super::Bsdf::sample_lobe`].
    pub fn sample_lobe(&self, known: DVec3, lobe: usize, u: [f64; 2]) -> Option<BsdfSample> {
        if known.z.abs() < GRAZING {
            return None;
        }
        let back = known.z < 0.0;
        let w = if back { mirror(known) } else { known };
        let (direction, mode) = match lobe {
            lobe::DIFFUSE => (square_to_cosine_hemisphere(u), Mode::Smooth),
            lobe::SPECULAR => sample_reflection(&self.ggx, w, u)?,
            lobe::COAT if !(back && self.is_solid()) => sample_reflection(&self.coat?.ggx(), w, u)?,
            lobe::TRANSMISSION if self.transmitting > 0.0 => self.sample_transmission(w, back, u)?,
            lobe::DIFFUSE_TRANSMISSION if self.transmitting > 0.0 => {
                (mirror(square_to_cosine_hemisphere(u)), Mode::Smooth)
            }
            _ => return None,
        };
        if direction.z.abs() < GRAZING {
            return None;
        }
        let direction = if back { mirror(direction) } else { direction };
        Some(BsdfSample { direction, lobe: lobe as u8, mode })
    }

    fn sample_transmission(&self, w: DVec3, inside: bool, u: [f64; 2]) -> Option<(DVec3, Mode)> {
        if self.transmits_dirac() {
            return Some((self.transmit(w, inside)?, Mode::DeltaTransmit));
        }
        let h = self.ggx.sample(w, u)?;
        let new = if self.thin { mirror(reflect(w, h)) } else { refract(w, h, self.interface.eta(inside))? };
        (new.z < 0.0).then_some((new, Mode::Smooth))
    }

    /// Where `w` with z > 0 goes through the smooth surface.
    fn transmit(&self, w: DVec3, inside: bool) -> Option<DVec3> {
        if self.thin || self.interface.ior() == 1.0 {
            Some(-w)
        } else {
            refract(w, DVec3::Z, self.interface.eta(inside))
        }
    }

    /// As [`super::Bsdf::invert`].
    pub fn invert(&self, known: DVec3, lobe: usize, new: DVec3) -> Option<[f64; 2]> {
        let back = known.z < 0.0;
        let pair = self.pair(known, new)?;
        let same_side = known.z * new.z > 0.0;
        match lobe {
            lobe::DIFFUSE if same_side => Some(cosine_hemisphere_to_square(new)),
            lobe::DIFFUSE_TRANSMISSION if !same_side => Some(cosine_hemisphere_to_square(new)),
            lobe::SPECULAR if same_side && !self.ggx.is_smooth() => self.ggx.invert(pair.a, pair.half),
            lobe::COAT if same_side && !(back && self.is_solid()) => {
                let coat = self.coat.filter(|c| !c.is_smooth())?;
                coat.ggx().invert(pair.a, pair.half)
            }
            lobe::TRANSMISSION if !same_side && !self.transmits_dirac() && pair.is_connected() => {
                // A normal that points to the inside, seen in the mirrored frame.
                let half = if back && !self.thin { -mirror(pair.half) } else { pair.half };
                self.ggx.invert(pair.a, half)
            }
            _ => None,
        }
    }

    /// As [`super::Bsdf::delta`].
    pub fn delta(&self, side: Side, known: DVec3, mode: Mode) -> Option<DeltaEvent> {
        if known.z.abs() < GRAZING {
            return None;
        }
        match mode {
            Mode::Smooth => None,
            Mode::DeltaReflect => self.mirror_event(known),
            Mode::DeltaTransmit => self.transmit_event(side, known),
        }
    }

    fn mirror_event(&self, known: DVec3) -> Option<DeltaEvent> {
        let view = self.view(known.z);
        let weights = self.weights(&view);
        let (mut reflectance, mut probability) = (Rgb::ZERO, 0.0);
        if self.ggx.is_smooth() {
            reflectance += self.reflectance(view.cos, view.inside) * view.passed;
            probability += weights[lobe::SPECULAR];
        }
        if let Some(coat) = self.coat.filter(|c| c.is_smooth() && !view.inside) {
            reflectance += Rgb::splat(coat.reflectance(view.cos));
            probability += weights[lobe::COAT];
        }
        let direction = DVec3::new(-known.x, -known.y, known.z);
        (probability > 0.0).then_some(DeltaEvent { direction, reflectance, probability, eta_scale: 1.0 })
    }

    fn transmit_event(&self, side: Side, known: DVec3) -> Option<DeltaEvent> {
        if !self.transmits_dirac() {
            return None;
        }
        let back = known.z < 0.0;
        let up = if back { mirror(known) } else { known };
        let direction = self.transmit(up, back && !self.thin)?;
        let direction = if back { mirror(direction) } else { direction };
        if direction.z.abs() < GRAZING {
            return None;
        }
        let view = self.view(known.z);
        let outside = if back { direction.z } else { known.z };
        let passed = view.passed.min(self.view(direction.z).passed);
        // From the front in either case, so that both sides compute the same number.
        let through = 1.0 - self.interface.fresnel(outside.abs(), false);
        let reflectance = self.base * (self.transmitting * passed * through);
        let probability = self.weights(&view)[lobe::TRANSMISSION];
        let ior = if self.thin { 1.0 } else { self.interface.eta(back) };
        let eta_scale = if side == Side::TowardLight { ior * ior } else { 1.0 };
        (probability > 0.0).then_some(DeltaEvent { direction, reflectance, probability, eta_scale })
    }
}

fn sample_reflection(ggx: &Ggx, w: DVec3, u: [f64; 2]) -> Option<(DVec3, Mode)> {
    if ggx.is_smooth() {
        return Some((DVec3::new(-w.x, -w.y, w.z), Mode::DeltaReflect));
    }
    let new = reflect(w, ggx.sample(w, u)?);
    (new.z > 0.0).then_some((new, Mode::Smooth))
}
