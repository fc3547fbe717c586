//! A disc in the sky of uniform radiance, seen under a small angle.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    math::{Frame, Rgb},
    warp,
};

/// Narrower discs (0.2 arc seconds, a street lamp on the moon) are widened to this: cosines cannot tell them from points.
const NARROWEST: f64 = 1e-6;

/// A directional light with an angular diameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sun {
    /// Z points to the centre.
    frame: Frame,
    radiance: Rgb,
    /// Cosine of the half angle.
    edge: f64,
}

impl Sun {
    /// A disc around the unit vector `centre` with the full angle `angle`, at most π radians, that gives a surface
    /// facing it `illuminance` lux a channel.
    pub(super) fn new(centre: DVec3, angle: f64, illuminance: Rgb) -> Self {
        let edge = (0.5 * angle.clamp(NARROWEST, PI)).cos();
        // ∫ cos θ dω over the disc is π sin² of the half angle.
        let radiance = illuminance / (PI * (1.0 - edge) * (1.0 + edge));
        Self { frame: Frame::from_z(centre), radiance, edge }
    }

    pub(super) fn radiance(&self, direction: DVec3) -> Rgb {
        if self.invert(direction).is_some() { self.radiance } else { Rgb::ZERO }
    }

    pub(super) fn flux(&self) -> Rgb {
        self.radiance / warp::cone_pdf(self.edge)
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        self.frame.to_world(warp::square_to_cone(u, self.edge))
    }

    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        if self.invert(direction).is_some() { warp::cone_pdf(self.edge) } else { 0.0 }
    }

    pub(super) fn invert(&self, direction: DVec3) -> Option<[f64; 2]> {
        warp::cone_to_square(self.frame.to_local(direction), self.edge)
    }
}
