//! How surfaces scatter.
//!
//! A [`Bsdf`] is a material at a point with all parameters resolved. Directions are unit vectors in the local shading
//! frame, Z the normal on the front side, X the tangent; they point away from the surface, `w_l` to the neighbour on the
//! light's side of a path and `w_e` to the one on the eye's. Geometric normals are the caller's business.
//!
//! The surface is a principled one: a metal, an opaque dielectric (GGX over a diffuse body) and a transmitting dielectric,
//! mixed linearly, under sheen and a clear coat ([`layered`]). Opaque surfaces look alike from both sides. A transmitting solid has
//! index 1 in front (z > 0) and its own inside. A thin-walled one does not bend light.
//!
//! Where the index depends on the wavelength there are three, for red, green and blue, and light that is transmitted by a
//! smooth surface is of one channel from then on: which one is part of how the vertex scatters, its [`Mode`]. Through
//! two surfaces, only paths that choose the same twice carry light.
//!
//! Seven lobes ([`lobe`]) are chosen by the albedos that the known direction gives. Smooth lobes have densities and exact
//! inverses; a perfectly smooth interface makes its lobe a Dirac event, which [`Bsdf::eval`] and [`Bsdf::pdf`] never see.
//! All densities are per steradian and, in this model, the same for both [`Side`]s. Values are reciprocal, but for tilted
//! coats and for diffuse transmission of solids that also transmit clearly.

mod albedo;
mod coat;
mod compensation;
mod diffuse;
mod film;
mod fresnel;
mod ggx;
mod layered;
mod parameters;
mod reflection;
mod sampling;
mod scattering;
mod sheen;
mod stretched;
#[cfg(test)]
mod tests;

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

pub use parameters::SurfaceParameters;

use crate::{
    math::Rgb,
    warp::{cosine_hemisphere_to_square, square_to_cosine_hemisphere},
};
use layered::Layered;

/// Which way a walk goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// From the eye: the known direction is `w_e`, the new one `w_l`.
    TowardLight,
    /// From the light: the known direction is `w_l`, the new one `w_e`.
    TowardEye,
}

impl Side {
    /// The other way.
    pub fn other(self) -> Self {
        match self {
            Self::TowardLight => Self::TowardEye,
            Self::TowardEye => Self::TowardLight,
        }
    }
}

/// How a vertex of a path scatters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// By a density.
    Smooth,
    /// By perfect reflection.
    DeltaReflect,
    /// By perfect transmission; where the index depends on the wavelength, of green light.
    DeltaTransmit,
    /// The same of red light.
    DeltaTransmitRed,
    /// The same of blue light.
    DeltaTransmitBlue,
}

impl Mode {
    /// All but [`Mode::Smooth`].
    pub const DIRAC: [Self; 4] =
        [Self::DeltaReflect, Self::DeltaTransmit, Self::DeltaTransmitRed, Self::DeltaTransmitBlue];
}

/// Names of the lobes, as [`Bsdf::sample_lobe`] numbers them.
pub mod lobe {
    /// Cosine lobe on the side of the known direction: diffuse and multiply scattered reflection, sheen.
    pub const DIFFUSE: usize = 0;
    /// GGX reflection of metal and dielectric.
    pub const SPECULAR: usize = 1;
    /// GGX transmission; where the index depends on the wavelength, of green light.
    pub const TRANSMISSION: usize = 2;
    /// GGX reflection of the coat.
    pub const COAT: usize = 3;
    /// Cosine lobe on the other side: diffuse and multiply scattered transmission.
    pub const DIFFUSE_TRANSMISSION: usize = 4;
    /// GGX transmission of red light.
    pub const TRANSMISSION_RED: usize = 5;
    /// GGX transmission of blue light.
    pub const TRANSMISSION_BLUE: usize = 6;
    /// Transmission by channel.
    pub(super) const BANDS: [usize; 3] = [TRANSMISSION_RED, TRANSMISSION, TRANSMISSION_BLUE];
}

/// Number of lobes.
pub const LOBES: usize = 7;

/// Cosines below this scatter nothing.
const GRAZING: f64 = 1e-9;

/// A material at a point.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "copied along paths, where a box would be an allocation per vertex"
)]
enum Kind {
    Black,
    /// By far the most common surface gets the shortest way.
    Lambert(Rgb),
    Layered(Layered),
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The new direction.
    pub direction: DVec3,
    /// The lobe it came from.
    pub lobe: u8,
    /// Smooth, or which Dirac event.
    pub mode: Mode,
}

/// A Dirac event.
#[derive(Clone, Copy, Debug)]
pub struct DeltaEvent {
    /// Where it sends the walk.
    pub direction: DVec3,
    /// Fresnel factor times tint, without the radiance scale; the same from both sides.
    pub reflectance: Rgb,
    /// Discrete probability of choosing it.
    pub probability: f64,
    /// (η_l/η_e)² if it refracts a walk toward the light, else 1.
    pub eta_scale: f64,
}

/// Value and both densities for a pair of directions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Evaluation {
    /// As [`Bsdf::eval`].
    pub value: Rgb,
    /// Density of sampling `w_l` given `w_e`.
    pub toward_light: f64,
    /// Density of sampling `w_e` given `w_l`.
    pub toward_eye: f64,
}

impl Bsdf {
    /// Scatters nothing.
    pub const BLACK: Self = Self { kind: Kind::Black };

    /// A Lambertian surface.
    pub fn lambert(albedo: Rgb) -> Self {
        Self { kind: if albedo == Rgb::ZERO { Kind::Black } else { Kind::Lambert(albedo) } }
    }

    /// Makes it equal to `other`, moving no more bytes than that kind of surface needs.
    #[inline]
    pub(crate) fn set(&mut self, other: &Self) {
        match &other.kind {
            Kind::Black => self.kind = Kind::Black,
            Kind::Lambert(albedo) => self.kind = Kind::Lambert(*albedo),
            Kind::Layered(layered) => self.kind = Kind::Layered(*layered),
        }
    }

    /// Gives its coat, if it has one, the unit normal `n` of its own.
    pub fn tilt_coat(&mut self, n: DVec3) {
        if let Kind::Layered(layered) = &mut self.kind {
            layered.tilt_coat(n);
        }
    }

    /// Radiance BSDF of light that flows from `w_l` to `w_e`, per steradian and without cosine, smooth lobes only;
    /// transmission into another medium includes (η_e/η_l)².
    #[inline]
    pub fn eval(&self, w_l: DVec3, w_e: DVec3) -> Rgb {
        match &self.kind {
            Kind::Black => Rgb::ZERO,
            Kind::Lambert(albedo) if same_side(w_l, w_e) => *albedo * FRAC_1_PI,
            Kind::Lambert(_) => Rgb::ZERO,
            Kind::Layered(layered) => layered.eval(w_l, w_e),
        }
    }

    /// Density of sampling `new` given `known`, smooth lobes only, choice of the lobe included.
    pub fn pdf(&self, _side: Side, known: DVec3, new: DVec3) -> f64 {
        match &self.kind {
            Kind::Black => 0.0,
            Kind::Lambert(_) => cosine_pdf(known, new),
            Kind::Layered(layered) => layered.pdf(known, new),
        }
    }

    /// [`Self::eval`] and [`Self::pdf`] in both directions at less than their joint cost.
    #[inline]
    pub fn evaluate(&self, w_l: DVec3, w_e: DVec3) -> Evaluation {
        match &self.kind {
            Kind::Black => Evaluation::default(),
            Kind::Lambert(_) => Evaluation {
                value: self.eval(w_l, w_e),
                toward_light: cosine_pdf(w_e, w_l),
                toward_eye: cosine_pdf(w_l, w_e),
            },
            Kind::Layered(layered) => layered.evaluate(w_l, w_e),
        }
    }

    /// Samples a direction given `known`: the lobe with `u_lobe`, then within it with `u`. `None`: absorbed.
    #[inline]
    pub fn sample(&self, _side: Side, known: DVec3, u_lobe: f64, u: [f64; 2]) -> Option<BsdfSample> {
        match &self.kind {
            Kind::Black => None,
            Kind::Lambert(_) => sample_cosine(known, u),
            Kind::Layered(layered) => layered.sample_lobe(known, layered.choose(known, u_lobe)?, u),
        }
    }

    /// Probabilities of choosing each lobe given `known`; they sum to 1, or to 0 if nothing is scattered.
    pub fn lobe_weights(&self, _side: Side, known: DVec3) -> [f64; LOBES] {
        match &self.kind {
            Kind::Lambert(_) if known.z.abs() >= GRAZING => [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            Kind::Black | Kind::Lambert(_) => [0.0; LOBES],
            Kind::Layered(layered) => layered.lobe_weights(known),
        }
    }

    /// Samples `lobe`, by a density or as a Dirac event.
    pub fn sample_lobe(&self, _side: Side, known: DVec3, lobe: usize, u: [f64; 2]) -> Option<BsdfSample> {
        match &self.kind {
            Kind::Lambert(_) if lobe == lobe::DIFFUSE => sample_cosine(known, u),
            Kind::Black | Kind::Lambert(_) => None,
            Kind::Layered(layered) => layered.sample_lobe(known, lobe, u),
        }
    }

    /// The `u` with which [`Self::sample_lobe`] gives `new` from a smooth lobe; `None` if it never does.
    pub fn invert(&self, _side: Side, known: DVec3, lobe: usize, new: DVec3) -> Option<[f64; 2]> {
        match &self.kind {
            Kind::Lambert(_) if lobe == lobe::DIFFUSE => invert_cosine(known, new),
            Kind::Black | Kind::Lambert(_) => None,
            Kind::Layered(layered) => layered.invert(known, lobe, new),
        }
    }

    /// Density of `new` in one smooth lobe, without the probability of choosing the lobe.
    pub fn lobe_pdf(&self, _side: Side, known: DVec3, lobe: usize, new: DVec3) -> f64 {
        match &self.kind {
            Kind::Lambert(_) if lobe == lobe::DIFFUSE => cosine_pdf(known, new),
            Kind::Black | Kind::Lambert(_) => 0.0,
            Kind::Layered(layered) => layered.lobe_pdf(known, lobe, new),
        }
    }

    /// The Dirac event of a mode, if the surface has one for `known`.
    pub fn delta(&self, side: Side, known: DVec3, mode: Mode) -> Option<DeltaEvent> {
        match &self.kind {
            Kind::Black | Kind::Lambert(_) => None,
            Kind::Layered(layered) => layered.delta(side, known, mode),
        }
    }

    /// Probabilities of choosing each Dirac event given `known`, in the order of [`Mode::DIRAC`].
    pub fn dirac_chances(&self, side: Side, known: DVec3) -> [f64; 4] {
        if !self.has_delta() {
            return [0.0; 4];
        }
        Mode::DIRAC.map(|mode| self.delta(side, known, mode).map_or(0.0, |event| event.probability))
    }

    /// Whether some lobe has a density.
    #[inline]
    pub fn has_smooth(&self) -> bool {
        match &self.kind {
            Kind::Black => false,
            Kind::Lambert(_) => true,
            Kind::Layered(layered) => layered.has_smooth(),
        }
    }

    /// Whether some lobe is a Dirac event.
    pub fn has_delta(&self) -> bool {
        match &self.kind {
            Kind::Black | Kind::Lambert(_) => false,
            Kind::Layered(layered) => layered.has_delta(),
        }
    }

    /// Estimate from above of the hemispherical albedo, in [0, 1], of the parameters alone: a survival probability.
    #[inline]
    pub fn albedo_bound(&self) -> f64 {
        self.albedo().max_element().clamp(0.0, 1.0)
    }

    /// Hemispherical albedo, for the auxiliary image that denoisers take.
    #[inline]
    pub fn albedo(&self) -> Rgb {
        match &self.kind {
            Kind::Black => Rgb::ZERO,
            Kind::Lambert(albedo) => *albedo,
            Kind::Layered(layered) => layered.albedo(),
        }
    }
}

/// Whether both directions are safely on the same side.
#[inline]
fn same_side(a: DVec3, b: DVec3) -> bool {
    a.z * b.z > 0.0 && a.z.abs() >= GRAZING && b.z.abs() >= GRAZING
}

/// `w` seen from the other side of the surface.
#[inline]
fn mirror(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, -w.z)
}

#[inline]
fn cosine_pdf(known: DVec3, new: DVec3) -> f64 {
    if same_side(known, new) { new.z.abs() * FRAC_1_PI } else { 0.0 }
}

#[inline]
fn sample_cosine(known: DVec3, u: [f64; 2]) -> Option<BsdfSample> {
    let w = square_to_cosine_hemisphere(u);
    let direction = if known.z > 0.0 { w } else { mirror(w) };
    let sampled = BsdfSample { direction, lobe: lobe::DIFFUSE as u8, mode: Mode::Smooth };
    same_side(known, direction).then_some(sampled)
}

fn invert_cosine(known: DVec3, new: DVec3) -> Option<[f64; 2]> {
    same_side(known, new).then(|| cosine_hemisphere_to_square(new))
}
