//! A vertex of a light path, and the one oriented function that says how it scatters.

use glam::DVec3;

use crate::{
    bsdf::{Bsdf, Evaluation, Mode, Side},
    bvh::{Anchor, offset_origin},
    math::{Frame, Rgb},
};

/// Below this cosine to the geometric normal a vertex carries no light, in every integrator alike.
pub const MIN_COSINE: f64 = 1e-6;

/// What a vertex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A point of a surface.
    Surface,
    /// A point of the lens.
    Lens,
    /// A light without extent, at `p`.
    PointLight,
    /// A light infinitely far, in the single direction `p`.
    DirectionalLight,
    /// The surroundings, seen in the direction `p`.
    Environment,
}

/// Canonical place of a surface vertex: all else follows from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Site {
    /// Instance.
    pub instance: u32,
    /// Triangle of the instance's mesh.
    pub triangle: u32,
    /// Barycentric weights of the triangle's second and third vertex.
    pub uv: [f64; 2],
}

/// A vertex. Directions at it are unit vectors in world space that point away from it.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// What it is.
    pub kind: Kind,
    /// Position; for lights infinitely far the direction to them.
    pub p: DVec3,
    /// Unit geometric normal on the front side (surfaces only).
    pub ng: DVec3,
    /// Shading frame on the front side.
    pub frame: Frame,
    /// Where on which surface.
    pub site: Site,
    /// How it scatters.
    pub bsdf: Bsdf,
    /// Index of the emitter at this place, or [`Vertex::NO_EMITTER`].
    pub emitter: u32,
    /// How far ray casting may misplace the surface, metres.
    pub rounding: f64,
    /// How this path scatters here: part of the path, not of the material (mlt.md §1.4).
    pub mode: Mode,
}

/// A Dirac event at a vertex of a walk.
#[derive(Clone, Copy, Debug)]
pub struct DiracStep {
    /// World direction of the next vertex.
    pub direction: DVec3,
    /// The event's factor of f, the generalized geometry of its chain taken from the light side.
    pub factor: Rgb,
    /// Density of the step in the walk's direction, in the same convention.
    pub density: f64,
    /// The part of the density that is the probability of choosing this event.
    pub probability: f64,
}

impl Vertex {
    /// `emitter` of what does not emit.
    pub const NO_EMITTER: u32 = u32::MAX;

    /// A vertex that is not on a surface and scatters nothing.
    #[inline]
    pub fn isolated(kind: Kind, p: DVec3, emitter: u32) -> Self {
        Self {
            kind,
            p,
            ng: DVec3::Z,
            frame: Frame { x: DVec3::X, y: DVec3::Y, z: DVec3::Z },
            site: Site::default(),
            bsdf: Bsdf::BLACK,
            emitter,
            rounding: 0.0,
            mode: Mode::Smooth,
        }
    }

    /// Whether a connection may end here: not in the middle of a Dirac event.
    #[inline]
    pub fn connectable(&self) -> bool {
        self.mode == Mode::Smooth
    }

    /// Whether an eye path can meet it as a light.
    #[inline]
    pub fn can_be_met(&self) -> bool {
        matches!(self.kind, Kind::Surface | Kind::Environment)
    }

    /// Start of a ray that leaves it in direction `w` and does not meet its own surface.
    #[inline]
    pub fn leave(&self, w: DVec3) -> DVec3 {
        if self.kind == Kind::Surface { offset_origin(self.p, self.ng, w, self.rounding) } else { self.p }
    }

    /// It as an end of a visibility test.
    #[inline]
    pub fn anchor(&self) -> Anchor {
        let normal = if self.kind == Kind::Surface { self.ng } else { DVec3::ZERO };
        Anchor { position: self.p, normal, rounding: self.rounding }
    }

    /// Whether it lies infinitely far.
    #[inline]
    pub fn infinite(&self) -> bool {
        matches!(self.kind, Kind::DirectionalLight | Kind::Environment)
    }

    /// |cos| of `w` to the geometric normal for surfaces, 1 for everything without a surface measure.
    #[inline]
    pub fn projected(&self, w: DVec3) -> f64 {
        if self.kind == Kind::Surface { self.ng.dot(w).abs() } else { 1.0 }
    }

    /// |w·Ns| / |w·Ng| (1 if either is on the wrong side: then the whole factor is 0 anyway), or `None` where shading
    /// and geometric normal disagree about the side of `w` or `w` grazes the surface (Veach 1997 §5.3.4).
    #[inline]
    fn shading_ratio(&self, w: DVec3) -> Option<f64> {
        let (s, g) = (self.frame.z.dot(w), self.ng.dot(w));
        (s * g > 0.0 && g.abs() >= MIN_COSINE).then(|| (s / g).abs())
    }

    /// Scattering of light that comes from `w_l` and leaves to `w_e`, smooth lobes only (mlt.md §1.3). `value` is the
    /// vertex's factor of f: the radiance BSDF times |w_l·Ns| / |w_l·Ng|, since geometric terms carry geometric cosines.
    /// The densities are per solid angle.
    #[inline]
    pub fn evaluate(&self, w_l: DVec3, w_e: DVec3) -> Evaluation {
        let (Some(ratio), Some(_)) = (self.shading_ratio(w_l), self.shading_ratio(w_e)) else {
            return Evaluation::default();
        };
        let found = self.bsdf.evaluate(self.frame.to_local(w_l), self.frame.to_local(w_e));
        Evaluation { value: found.value * ratio, ..found }
    }

    /// The Dirac event of this vertex's `mode` for a walk that came from `known`.
    ///
    /// Shading normals and refraction do not preserve étendue; the density of the step towards the light carries the
    /// ratio, so that factor over density is the right throughput in both directions (mlt.md §2.2).
    pub fn dirac_step(&self, side: Side, known: DVec3, mode: Mode) -> Option<DiracStep> {
        let event = self.bsdf.delta(side, self.frame.to_local(known), mode)?;
        let direction = self.frame.to_world(event.direction);
        let (known_ratio, new_ratio) = (self.shading_ratio(known)?, self.shading_ratio(direction)?);
        let stretch = match side {
            Side::TowardLight => new_ratio / known_ratio,
            Side::TowardEye => known_ratio / new_ratio,
        };
        let density = match side {
            Side::TowardLight => event.probability * event.eta_scale * stretch,
            Side::TowardEye => event.probability,
        };
        (density > 0.0).then(|| DiracStep {
            direction,
            factor: event.reflectance * stretch,
            density,
            probability: event.probability,
        })
    }
}
