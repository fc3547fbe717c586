//! Emitters: which one to sample, and where on it.
//!
//! Emitters are numbered: lights without extent first, then the surroundings (environment and sun discs together), then
//! emissive triangles. One is chosen in proportion to its power, so that 10⁵ emissive triangles cost a binary search.

mod dirac;
mod shapes;
#[cfg(test)]
mod tests;

pub use dirac::DiracLight;
pub(crate) use shapes::tessellate;

use std::sync::Arc;

use glam::DVec3;

use crate::{
    distribution::Discrete,
    environment::Environment,
    math::{Frame, Rgb},
    path::{Kind, Site, Vertex},
    warp,
};

/// An emissive triangle.
#[derive(Clone, Copy, Debug)]
pub struct TriangleLight {
    /// Instance it belongs to.
    pub instance: u32,
    /// Triangle of the instance's mesh.
    pub triangle: u32,
    /// World-space vertices.
    pub vertices: [DVec3; 3],
    /// Unit normal of the front, world space.
    pub normal: DVec3,
    /// m².
    pub area: f64,
    /// How far ray casting may misplace it, metres.
    pub rounding: f64,
    /// Whether the back shines too.
    pub both_sides: bool,
    /// Estimate of the emitted flux per area and π, for the choice of emitters.
    pub brightness: f64,
}

/// All emitters of a world.
#[derive(Debug, Default)]
pub struct Lights {
    dirac: Vec<DiracLight>,
    environment: Option<Arc<Environment>>,
    triangles: Vec<TriangleLight>,
    choice: Discrete,
    /// Bounding sphere of the scene: lights infinitely far shine through a disc of its size.
    centre: DVec3,
    radius: f64,
}

/// The emission of a light subpath.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Where its ray starts.
    pub origin: DVec3,
    /// Unit direction of travel.
    pub direction: DVec3,
    /// Native density of the step ([`crate::path::Edge::density`]).
    pub density: f64,
}

impl Lights {
    pub(crate) fn new(
        dirac: Vec<DiracLight>,
        environment: Option<Arc<Environment>>,
        triangles: Vec<TriangleLight>,
        (centre, radius): (DVec3, f64),
    ) -> Self {
        let disc = std::f64::consts::PI * radius * radius;
        let powers: Vec<f64> =
            dirac
                .iter()
                .map(|light| light.power(disc))
                .chain(environment.iter().map(|e| e.power() * disc))
                .chain(triangles.iter().map(|t| {
                    std::f64::consts::PI * t.brightness * t.area * if t.both_sides { 2.0 } else { 1.0 }
                }))
                .collect();
        Self { dirac, environment, triangles, choice: Discrete::new(&powers), centre, radius }
    }

    /// Number of emitters.
    pub fn len(&self) -> usize {
        self.dirac.len() + usize::from(self.environment.is_some()) + self.triangles.len()
    }

    /// Whether nothing emits.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether some lights have no extent, so that eye paths cannot meet them.
    pub fn has_dirac(&self) -> bool {
        !self.dirac.is_empty()
    }

    /// Whether some lights have an extent, so that eye paths can meet them.
    pub fn can_be_met(&self) -> bool {
        self.len() > self.dirac.len()
    }

    /// Radius of the sphere around everything that lights infinitely far shine at, metres.
    pub fn reach(&self) -> f64 {
        self.radius
    }

    /// The surroundings.
    pub fn environment(&self) -> Option<&Environment> {
        self.environment.as_deref()
    }

    /// The surroundings, to be shared.
    pub(crate) fn shared_environment(&self) -> Option<Arc<Environment>> {
        self.environment.clone()
    }

    /// Index of the surroundings as an emitter.
    fn environment_index(&self) -> usize {
        self.dirac.len()
    }

    /// Index of the first triangle as an emitter.
    pub(crate) fn first_triangle(&self) -> usize {
        self.dirac.len() + usize::from(self.environment.is_some())
    }

    /// The triangle that is emitter number `emitter`.
    #[inline]
    pub fn triangle(&self, emitter: u32) -> Option<&TriangleLight> {
        self.triangles.get((emitter as usize).checked_sub(self.first_triangle())?)
    }

    /// Samples the light end x_0 of a path and its density P_L: per area on triangles, per solid angle for the
    /// surroundings, discrete for lights without extent. The choice does not depend on where it is used, so the same
    /// density holds for next-event estimation and for emission.
    pub fn sample(&self, choice: f64, u: [f64; 2]) -> Option<(Vertex, f64)> {
        let mut vertex = Vertex::isolated(Kind::Environment, DVec3::Z, Vertex::NO_EMITTER);
        let density = self.sample_into(choice, u, &mut vertex)?;
        Some((vertex, density))
    }

    /// As [`Lights::sample`], in place. The vertex must scatter nothing, as those of lights do.
    pub fn sample_into(&self, choice: f64, u: [f64; 2], vertex: &mut Vertex) -> Option<f64> {
        let (index, pmf, rest) = self.choice.sample(choice)?;
        vertex.emitter = index as u32;
        if let Some(light) = self.dirac.get(index) {
            (vertex.kind, vertex.p, vertex.rounding) = (light.kind(), light.place(), 0.0);
            return Some(pmf);
        }
        if let Some(triangle) = self.triangle(vertex.emitter) {
            triangle.set_vertex(warp::square_to_triangle(u), vertex);
            return Some(pmf / triangle.area);
        }
        let environment = self.environment.as_ref()?;
        let (_, direction) = environment.sample(rest, u);
        let density = environment.pdf(direction);
        (vertex.kind, vertex.p, vertex.rounding) = (Kind::Environment, direction, 0.0);
        (density > 0.0).then_some(pmf * density)
    }

    /// Density P_L of a light end, as [`Lights::sample`] returns it.
    #[inline]
    pub fn density(&self, x0: &Vertex) -> f64 {
        if x0.emitter == Vertex::NO_EMITTER {
            return 0.0;
        }
        let pmf = self.choice.pmf(x0.emitter as usize);
        match (x0.kind, &self.environment) {
            (Kind::Environment, Some(environment)) => pmf * environment.pdf(x0.p),
            (Kind::Surface, _) => self.triangle(x0.emitter).map_or(0.0, |t| pmf / t.area),
            _ => pmf,
        }
    }

    /// A vertex at the surroundings in the unit direction `direction`, if there are any.
    pub fn surroundings(&self, direction: DVec3) -> Option<Vertex> {
        self.environment.as_ref()?;
        Some(Vertex::isolated(Kind::Environment, direction, self.environment_index() as u32))
    }

    /// Samples how light leaves `x0`.
    pub fn emit(&self, x0: &Vertex, u: [f64; 2], u_side: f64) -> Option<Emission> {
        let (origin, direction) = match x0.kind {
            Kind::Environment | Kind::DirectionalLight => {
                let disc = warp::square_to_disc(u);
                let frame = Frame::from_z(x0.p);
                let start = self.centre + (frame.x * disc.x + frame.y * disc.y + x0.p * 1.01) * self.radius;
                (start, -x0.p)
            }
            Kind::PointLight => (x0.p, self.dirac.get(x0.emitter as usize)?.sample_direction(u)),
            Kind::Surface => {
                let both = self.triangle(x0.emitter)?.both_sides;
                let normal = if both && u_side >= 0.5 { -x0.ng } else { x0.ng };
                (x0.p, Frame::from_z(normal).to_world(warp::square_to_cosine_hemisphere(u)))
            }
            Kind::Lens => return None,
        };
        let density = self.emit_density(x0, direction);
        (density > 0.0).then_some(Emission { origin, direction, density })
    }

    /// Native density of light leaving `x0` in `direction`.
    pub fn emit_density(&self, x0: &Vertex, direction: DVec3) -> f64 {
        match x0.kind {
            Kind::Environment | Kind::DirectionalLight => {
                1.0 / (std::f64::consts::PI * self.radius * self.radius)
            }
            Kind::PointLight => {
                self.dirac.get(x0.emitter as usize).map_or(0.0, |light| light.direction_density(direction))
            }
            Kind::Surface => self.triangle(x0.emitter).map_or(0.0, |triangle| {
                let cos = x0.ng.dot(direction);
                if triangle.both_sides {
                    cos.abs() * 0.5 * std::f64::consts::FRAC_1_PI
                } else {
                    cos.max(0.0) * std::f64::consts::FRAC_1_PI
                }
            }),
            Kind::Lens => 0.0,
        }
    }

    /// Radiance or intensity that a light which is not a surface sends in `direction`.
    pub(crate) fn distant_emission(&self, x0: &Vertex, direction: DVec3) -> Rgb {
        match (x0.kind, &self.environment) {
            (Kind::Environment, Some(environment)) => environment.radiance(x0.p),
            _ => self.dirac.get(x0.emitter as usize).map_or(Rgb::ZERO, |light| light.emission(direction)),
        }
    }

    /// Total power in photometric units times the channel mean, for scale.
    pub fn power(&self) -> f64 {
        self.choice.total()
    }
}

impl TriangleLight {
    /// Places `vertex` at the point of barycentric weights `uv`.
    #[inline]
    fn set_vertex(&self, uv: [f64; 2], vertex: &mut Vertex) {
        let [a, b, c] = self.vertices;
        vertex.kind = Kind::Surface;
        vertex.p = a * (1.0 - uv[0] - uv[1]) + b * uv[0] + c * uv[1];
        vertex.ng = self.normal;
        vertex.frame = Frame::from_z(self.normal);
        vertex.site = Site { instance: self.instance, triangle: self.triangle, uv };
        vertex.rounding = self.rounding;
    }
}
