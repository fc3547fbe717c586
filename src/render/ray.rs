//! Rays.

use glam::DVec3;

/// A half-open piece of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, in world space.
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    /// Length; infinity is allowed.
    pub t_max: f64,
}

impl Ray {
    /// The ray from `origin` along the unit vector `direction` without end.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, t_max: f64::INFINITY }
    }

    /// The point at distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
