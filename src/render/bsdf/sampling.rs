//! Sampling of the principled surface's lobes, its inverse, and its Dirac events.

use glam::DVec3;

use super::{
    BsdfSample, DeltaEvent, GRAZING, Mode, Side, albedo::Interface, coat::Coat, fresnel::refract, ggx::Ggx,
    layered::Layered, lobe, mirror,
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
            lobe::COAT if !(back && self.is_solid()) => self.coat?.sample(w, u)?,
            lobe::TRANSMISSION | lobe::TRANSMISSION_RED | lobe::TRANSMISSION_BLUE => {
                self.sample_transmission(w, back, lobe, u)?
            }
            lobe::DIFFUSE_TRANSMISSION if self.has_other_side() => {
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

    fn sample_transmission(&self, w: DVec3, inside: bool, lobe: usize, u: [f64; 2]) -> Option<(DVec3, Mode)> {
        let band = self.band(lobe)?;
        if self.transmits_dirac() {
            let mode = match lobe {
                lobe::TRANSMISSION_RED => Mode::DeltaTransmitRed,
                lobe::TRANSMISSION_BLUE => Mode::DeltaTransmitBlue,
                _ => Mode::DeltaTransmit,
            };
            return Some((self.transmit(w, inside, band)?, mode));
        }
        let h = self.ggx.sample(w, u)?;
        let new = if self.thin { mirror(reflect(w, h)) } else { refract(w, h, band.eta(inside))? };
        (new.z < 0.0).then_some((new, Mode::Smooth))
    }

    /// The interface at which `lobe` transmits, if it does.
    fn band(&self, lobe: usize) -> Option<&'static Interface> {
        match (lobe, self.dispersed) {
            _ if self.transmitting == 0.0 => None,
            (lobe::TRANSMISSION, _) => Some(self.interface),
            (lobe::TRANSMISSION_RED, Some([red, _])) => Some(red),
            (lobe::TRANSMISSION_BLUE, Some([_, blue])) => Some(blue),
            _ => None,
        }
    }

    /// Where `w` with z > 0 goes through the smooth surface.
    fn transmit(&self, w: DVec3, inside: bool, band: &Interface) -> Option<DVec3> {
        if self.thin || band.ior() == 1.0 { Some(-w) } else { refract(w, DVec3::Z, band.eta(inside)) }
    }

    /// As [`super::Bsdf::invert`].
    pub fn invert(&self, known: DVec3, lobe: usize, new: DVec3) -> Option<[f64; 2]> {
        let back = known.z < 0.0;
        let pair = self.pair(known, new)?;
        let same_side = known.z * new.z > 0.0;
        match lobe {
            lobe::DIFFUSE if same_side => Some(cosine_hemisphere_to_square(new)),
            lobe::DIFFUSE_TRANSMISSION if !same_side => Some(cosine_hemisphere_to_square(new)),
            lobe::SPECULAR if same_side && !self.ggx.is_smooth() => {
                self.ggx.invert(pair.a, pair.facet(lobe).half)
            }
            lobe::COAT if same_side && !(back && self.is_solid()) => {
                self.coat?.invert(pair.a, pair.facet(lobe).half)
            }
            lobe if !same_side && !self.transmits_dirac() && self.band(lobe).is_some() => {
                let facet = pair.facet(lobe);
                // A normal that points to the inside, seen in the mirrored frame.
                let half = if back && !self.thin { -mirror(facet.half) } else { facet.half };
                if facet.is_connected() { self.ggx.invert(pair.a, half) } else { None }
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
            Mode::DeltaTransmit => self.transmit_event(side, known, lobe::TRANSMISSION),
            Mode::DeltaTransmitRed => self.transmit_event(side, known, lobe::TRANSMISSION_RED),
            Mode::DeltaTransmitBlue => self.transmit_event(side, known, lobe::TRANSMISSION_BLUE),
        }
    }

    fn mirror_event(&self, known: DVec3) -> Option<DeltaEvent> {
        let view = self.view(known);
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

    fn transmit_event(&self, side: Side, known: DVec3, lobe: usize) -> Option<DeltaEvent> {
        let band = self.band(lobe).filter(|_| self.transmits_dirac())?;
        let back = known.z < 0.0;
        let up = if back { mirror(known) } else { known };
        let direction = self.transmit(up, back && !self.thin, band)?;
        let direction = if back { mirror(direction) } else { direction };
        if direction.z.abs() < GRAZING {
            return None;
        }
        let view = self.view(known);
        let outside = if back { direction.z } else { known.z };
        let passed = view.passed.min(self.view(direction).passed);
        // From the front in either case, so that both sides compute the same number.
        let through = Rgb::ONE - self.boundary(outside.abs(), false);
        // Of light that is split by wavelength, an event is that of one channel.
        let channel = match (self.dispersed, lobe) {
            (None, _) => Rgb::ONE,
            (_, lobe::TRANSMISSION_RED) => Rgb::X,
            (_, lobe::TRANSMISSION_BLUE) => Rgb::Z,
            _ => Rgb::Y,
        };
        let reflectance = self.base * through * channel * (self.transmitting * passed);
        let probability = self.weights(&view)[lobe];
        let ior = if self.thin { 1.0 } else { band.eta(back) };
        let eta_scale = if side == Side::TowardLight { ior * ior } else { 1.0 };
        (probability > 0.0).then_some(DeltaEvent { direction, reflectance, probability, eta_scale })
    }
}

impl Coat {
    /// Samples its microfacets from `w` with z > 0.
    fn sample(&self, w: DVec3, u: [f64; 2]) -> Option<(DVec3, Mode)> {
        let Some(frame) = self.frame() else { return sample_reflection(&self.ggx(), w, u) };
        let local = frame.to_local(w);
        if local.z <= 0.0 {
            return None;
        }
        let (new, mode) = sample_reflection(&self.ggx(), local, u)?;
        let new = frame.to_world(new);
        (new.z > 0.0).then_some((new, mode))
    }

    /// The `u` with which [`Self::sample`] gives the direction whose half vector with `w` is `half`.
    fn invert(&self, w: DVec3, half: DVec3) -> Option<[f64; 2]> {
        if self.is_smooth() {
            return None;
        }
        let Some(frame) = self.frame() else { return self.ggx().invert(w, half) };
        let (w, half) = (frame.to_local(w), frame.to_local(half));
        if w.z > 0.0 && half.z > 0.0 { self.ggx().invert(w, half) } else { None }
    }
}

fn sample_reflection(ggx: &Ggx, w: DVec3, u: [f64; 2]) -> Option<(DVec3, Mode)> {
    if ggx.is_smooth() {
        return Some((DVec3::new(-w.x, -w.y, w.z), Mode::DeltaReflect));
    }
    let new = reflect(w, ggx.sample(w, u)?);
    (new.z > 0.0).then_some((new, Mode::Smooth))
}
