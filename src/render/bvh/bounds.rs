//! Boxes in f32.

use glam::Vec3A;

/// A box along the axes; empty where `low` is above `high`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: Vec3A,
    pub(super) high: Vec3A,
}

impl Bounds {
    pub(super) const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Half the surface of a box that is not empty; infinite where it overflows.
    #[inline]
    pub(super) fn half_area(self) -> f32 {
        let size = self.high - self.low;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// Twice the middle: all that sorting along an axis needs.
    #[inline]
    pub(super) fn double_center(self) -> Vec3A {
        self.low + self.high
    }
}
