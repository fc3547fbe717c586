//! The edge between two neighbours of a path, and densities across it.

use glam::DVec3;

use super::{Kind, Vertex};

/// An edge from its light-side vertex to its eye-side vertex.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Unit direction of light's travel: towards the eye.
    pub to_eye: DVec3,
    /// Metres; infinite for edges to lights infinitely far.
    pub length: f64,
    /// 1/length², or 1 where the light is infinitely far: what turns solid angle into area.
    pub falloff: f64,
}

impl Edge {
    /// The edge between a light-side and an eye-side vertex; `None` if they are closer than `shortest`, where f is 0 for
    /// every integrator (it kills the singularity in corners).
    #[inline]
    pub fn between(light: &Vertex, eye: &Vertex, shortest: f64) -> Option<Self> {
        if light.infinite() {
            return Some(Self { to_eye: -light.p, length: f64::INFINITY, falloff: 1.0 });
        }
        let d = eye.p - light.p;
        let length = d.length();
        (length > shortest).then(|| Self { to_eye: d / length, length, falloff: 1.0 / (length * length) })
    }

    /// Converts the native density `p` of a step that leaves `source` for `target` into the measure of the path's
    /// densities (mlt.md §2.2). `p` is per solid angle, or per area perpendicular to the edge where `source` fixes the
    /// direction; a Dirac source has a discrete probability.
    ///
    /// * into a Dirac vertex: projected solid angle at the source;
    /// * to a light infinitely far: solid angle;
    /// * else area at the target.
    #[inline]
    pub fn density(&self, p: f64, source: &Vertex, target: &Vertex, direction_is_fixed: bool) -> f64 {
        if !source.connectable() {
            p
        } else if !target.connectable() {
            p / source.projected(self.to_eye)
        } else if target.infinite() {
            p
        } else if direction_is_fixed {
            p * target.projected(self.to_eye)
        } else {
            p * target.projected(self.to_eye) * self.falloff
        }
    }
}

impl Vertex {
    /// Whether rays leave it in one fixed direction, so that their native density is per area.
    #[inline]
    pub fn direction_is_fixed(&self) -> bool {
        matches!(self.kind, Kind::DirectionalLight | Kind::Environment)
    }
}
