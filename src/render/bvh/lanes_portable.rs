//! Arrays in place of vector registers. The compiler vectorizes most of this.

use std::array::from_fn;
use std::ops::{Add, BitAnd, BitOr, Mul, Sub};

/// Eight numbers.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct Eight([f32; 8]);

fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl Eight {
    pub(in crate::bvh) fn new(x: &[f32; 8]) -> Self {
        Self(*x)
    }

    pub(in crate::bvh) fn splat(x: f32) -> Self {
        Self([x; 8])
    }

    /// `self * b - c`, fused or not.
    pub(in crate::bvh) fn multiply_subtract(self, b: Self, c: Self) -> Self {
        Self(from_fn(|i| self.0[i] * b.0[i] - c.0[i]))
    }

    /// The lesser; `other` where either is NaN.
    pub(in crate::bvh) fn min(self, other: Self) -> Self {
        Self(from_fn(|i| min(self.0[i], other.0[i])))
    }

    /// The greater; `other` where either is NaN.
    pub(in crate::bvh) fn max(self, other: Self) -> Self {
        Self(from_fn(|i| max(self.0[i], other.0[i])))
    }

    /// The lanes where this is at most `other`, as bits.
    pub(in crate::bvh) fn at_most(self, other: Self) -> u32 {
        (0..8).fold(0, |set, i| set | u32::from(self.0[i] <= other.0[i]) << i)
    }

    pub(in crate::bvh) fn to_array(self) -> [f32; 8] {
        self.0
    }
}

/// Four numbers.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct Four([f32; 4]);

/// Some of four lanes.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct Set([bool; 4]);

impl Four {
    pub(in crate::bvh) fn new(x: &[f32; 4]) -> Self {
        Self(*x)
    }

    /// The lesser; `other` where either is NaN.
    pub(in crate::bvh) fn min(self, other: Self) -> Self {
        Self(from_fn(|i| min(self.0[i], other.0[i])))
    }

    /// The greater; `other` where either is NaN.
    pub(in crate::bvh) fn max(self, other: Self) -> Self {
        Self(from_fn(|i| max(self.0[i], other.0[i])))
    }

    /// One over each.
    pub(in crate::bvh) fn inverse(self) -> Self {
        Self(self.0.map(|x| 1.0 / x))
    }

    pub(in crate::bvh) fn at_most(self, other: Self) -> Set {
        Set(from_fn(|i| self.0[i] <= other.0[i]))
    }

    pub(in crate::bvh) fn below(self, other: Self) -> Set {
        Set(from_fn(|i| self.0[i] < other.0[i]))
    }

    pub(in crate::bvh) fn is_zero(self) -> Set {
        Set(self.0.map(|x| x == 0.0))
    }

    pub(in crate::bvh) fn to_array(self) -> [f32; 4] {
        self.0
    }
}

impl Set {
    /// The lanes as bits.
    pub(in crate::bvh) fn bits(self) -> u32 {
        (0..4).fold(0, |set, i| set | u32::from(self.0[i]) << i)
    }
}

macro_rules! operators {
    ($($name:ty, $operator:ident, $method:ident, $symbol:tt;)*) => {$(
        impl $operator for $name {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(from_fn(|i| self.0[i] $symbol other.0[i]))
            }
        }
    )*};
}
operators! {
    Four, Add, add, +;
    Four, Sub, sub, -;
    Four, Mul, mul, *;
    Set, BitAnd, bitand, &;
    Set, BitOr, bitor, |;
}
