//! Lights without extent: point, spot, and directional lights of angle 0 (KHR_lights_punctual).

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::{
    math::{Frame, Rgb, scalar},
    path::Kind,
    warp,
};

/// A light without extent; no path meets it by chance.
#[derive(Clone, Copy, Debug)]
pub enum DiracLight {
    /// The same intensity (cd) in all directions.
    Point {
        /// World position.
        position: DVec3,
        /// Candela.
        intensity: Rgb,
    },
    /// A cone with a soft edge.
    Spot {
        /// World position.
        position: DVec3,
        /// Z is the axis.
        frame: Frame,
        /// Candela on the axis.
        intensity: Rgb,
        /// Cosine of the half angle of full intensity.
        inner: f64,
        /// Cosine of the half angle of no intensity.
        outer: f64,
    },
    /// From infinitely far.
    Directional {
        /// Unit direction to the light.
        to_light: DVec3,
        /// Lux on a surface that faces it.
        illuminance: Rgb,
    },
}

impl DiracLight {
    /// Kind of its vertex.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Point { .. } | Self::Spot { .. } => Kind::PointLight,
            Self::Directional { .. } => Kind::DirectionalLight,
        }
    }

    /// Position, or direction to it.
    pub fn place(&self) -> DVec3 {
        match *self {
            Self::Point { position, .. } | Self::Spot { position, .. } => position,
            Self::Directional { to_light, .. } => to_light,
        }
    }

    /// Flux (channel mean, lumen), through a disc of area `disc` for directional lights.
    pub fn power(&self, disc: f64) -> f64 {
        match *self {
            Self::Point { intensity, .. } => 2.0 * TAU * scalar(intensity),
            Self::Spot { intensity, inner, outer, .. } => {
                TAU * scalar(intensity) * ((1.0 - inner) + (inner - outer) / 3.0)
            }
            Self::Directional { illuminance, .. } => scalar(illuminance) * disc,
        }
    }

    /// Intensity (cd) in `direction`, or illuminance (lux).
    pub fn emission(&self, direction: DVec3) -> Rgb {
        match *self {
            Self::Point { intensity, .. } => intensity,
            Self::Spot { intensity, frame, inner, outer, .. } => {
                let falloff = (frame.z.dot(direction) - outer) / (inner - outer).max(1e-3);
                intensity * falloff.clamp(0.0, 1.0).powi(2)
            }
            Self::Directional { illuminance, .. } => illuminance,
        }
    }

    /// Samples the direction of emission of a light with a position.
    pub fn sample_direction(&self, u: [f64; 2]) -> DVec3 {
        match *self {
            Self::Spot { frame, outer, .. } => frame.to_world(warp::square_to_cone(u, outer)),
            Self::Point { .. } => warp::square_to_sphere(u),
            Self::Directional { to_light, .. } => -to_light,
        }
    }

    /// Solid-angle density of [`DiracLight::sample_direction`].
    pub fn direction_density(&self, direction: DVec3) -> f64 {
        match *self {
            Self::Spot { frame, outer, .. } => {
                if frame.z.dot(direction) > outer {
                    1.0 / (TAU * (1.0 - outer))
                } else {
                    0.0
                }
            }
            Self::Point { .. } => 1.0 / (4.0 * PI),
            Self::Directional { .. } => 0.0,
        }
    }
}
