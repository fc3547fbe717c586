//! Rays that leave surfaces.
//!
//! Traversal works in f32, so a ray that starts on a surface may meet that surface again. Its start is therefore moved
//! off the surface by a bound on that rounding. The bound comes with the surface (see `Geometry::rounding`): it grows
//! with the point's coordinates and the size of the triangle there, and does not depend on the rest of the scene.

use glam::DVec3;

use crate::ray::Ray;

/// Distances round by at most this part in the traversal.
const DISTANCE_ROUNDING: f64 = 1e-6;

/// One part in 2²³, twice the relative error of an f32.
const EPSILON: f64 = f32::EPSILON as f64;

/// A bound on how far f32 traversal displaces a triangle along its normal, seen from a point on it. Rounding the ray's
/// origin costs √3/2 ε of the largest coordinate `reach`; the test then works with differences of coordinates, no
/// larger than the triangle's `extent`, in about eight roundings of ε/2.
pub(super) fn rounding(reach: f64, extent: f64) -> f64 {
    EPSILON * (2.0 * reach + 8.0 * extent)
}

/// How many roundings a start keeps from the edges: enough where surfaces meet at 30° or more.
const EDGE_ROUNDINGS: f64 = 4.0;

/// The point `uv` of a triangle, moved no farther than needed to be some `rounding` away from its edges: a ray that
/// starts nearer to an edge may do so behind the triangle on the other side, and then leaves a closed mesh.
#[inline]
pub fn inside([a, b, c]: &[DVec3; 3], uv: [f64; 2], rounding: f64) -> [f64; 2] {
    let margin = EDGE_ROUNDINGS * rounding;
    let doubled_area = (*b - *a).cross(*c - *a).length();
    let weights = [1.0 - uv[0] - uv[1], uv[0], uv[1]];
    // A weight is the distance from an edge over the height above it.
    let near = weights.iter().zip([*c - *b, *a - *c, *b - *a]).any(|(weight, edge)| {
        let distance = (weight * doubled_area).max(0.0);
        distance * distance < margin * margin * edge.length_squared()
    });
    if !near {
        return uv;
    }
    let least = [*c - *b, *a - *c, *b - *a].map(|edge| margin * edge.length() / doubled_area);
    let spare = 1.0 - least.iter().sum::<f64>();
    if spare.is_nan() || spare <= 0.0 {
        // Nothing is that far inside.
        return uv;
    }
    let above: [f64; 3] = std::array::from_fn(|i| (weights[i] - least[i]).max(0.0));
    let scale = spare / above.iter().sum::<f64>();
    [least[1] + above[1] * scale, least[2] + above[2] * scale]
}

/// An end of a connection.
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// World position.
    pub position: DVec3,
    /// Geometric unit normal, on either side; zero for points off surfaces.
    pub normal: DVec3,
    /// How far the traversal may misplace the surface: `Geometry::rounding`; zero for points off surfaces.
    pub rounding: f64,
}

/// The start of a ray that leaves the surface point `p` with geometric normal `ng` toward `w`: `p` moved by `rounding`
/// to the side that `w` is on.
#[inline]
pub fn offset_origin(p: DVec3, ng: DVec3, w: DVec3, rounding: f64) -> DVec3 {
    p + ng * rounding.copysign(ng.dot(w))
}

/// The ray between two points that meets neither's surface, for visibility tests. It is empty (`t_max` 0) if the points
/// are too close to tell apart.
#[inline]
pub fn segment(from: &Anchor, to: &Anchor) -> Ray {
    let w = to.position - from.position;
    let start = offset_origin(from.position, from.normal, w, from.rounding);
    let end = offset_origin(to.position, to.normal, -w, to.rounding);
    let span = end - start;
    let length = span.length();
    // Points closer than their offsets may have passed each other.
    if length == 0.0 || span.dot(w) <= 0.0 {
        return Ray { origin: start, direction: DVec3::Z, t_max: 0.0 };
    }
    Ray { origin: start, direction: span / length, t_max: length * (1.0 - DISTANCE_ROUNDING) }
}
