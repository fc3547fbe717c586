//! Several f32 at once: vector registers where the build's processor has them, arrays elsewhere. Both round alike, with
//! the one exception of [`Eight::multiply_subtract`].

pub(super) use imp::{Eight, Four};

#[cfg(all(target_arch = "x86_64", target_feature = "avx2", target_feature = "fma"))]
mod imp {
    use std::arch::x86_64::*;
    use std::ops::{Add, BitAnd, BitOr, Mul, Sub};

    /// Eight numbers.
    #[derive(Clone, Copy)]
    pub(in crate::bvh) struct Eight(__m256);

    impl Eight {
        #[inline(always)]
        pub(in crate::bvh) fn new(x: &[f32; 8]) -> Self {
            Self(bytemuck::cast(*x))
        }

        #[inline(always)]
        pub(in crate::bvh) fn splat(x: f32) -> Self {
            Self::new(&[x; 8])
        }

        /// `self * b - c`, fused or not.
        #[inline(always)]
        pub(in crate::bvh) fn multiply_subtract(self, b: Self, c: Self) -> Self {
            // SAFETY: the module is only compiled for processors with AVX and FMA.
            Self(unsafe { _mm256_fmsub_ps(self.0, b.0, c.0) })
        }

        /// The lesser; `other` where either is NaN.
        #[inline(always)]
        pub(in crate::bvh) fn min(self, other: Self) -> Self {
            // SAFETY: see `multiply_subtract`.
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }

        /// The greater; `other` where either is NaN.
        #[inline(always)]
        pub(in crate::bvh) fn max(self, other: Self) -> Self {
            // SAFETY: see `multiply_subtract`.
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }

        /// The lanes where this is at most `other`, as bits.
        #[inline(always)]
        pub(in crate::bvh) fn at_most(self, other: Self) -> u32 {
            // SAFETY: see `multiply_subtract`.
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u32 }
        }

        #[inline(always)]
        pub(in crate::bvh) fn to_array(self) -> [f32; 8] {
            bytemuck::cast(self.0)
        }
    }

    /// Four numbers.
    #[derive(Clone, Copy)]
    pub(in crate::bvh) struct Four(__m128);

    /// Some of four lanes.
    #[derive(Clone, Copy)]
    pub(in crate::bvh) struct Set(__m128);

    impl Four {
        #[inline(always)]
        pub(in crate::bvh) fn new(x: &[f32; 4]) -> Self {
            Self(bytemuck::cast(*x))
        }

        #[inline(always)]
        pub(in crate::bvh) fn splat(x: f32) -> Self {
            Self::new(&[x; 4])
        }

        /// The lesser; `other` where either is NaN.
        #[inline(always)]
        pub(in crate::bvh) fn min(self, other: Self) -> Self {
            // SAFETY: SSE is part of x86-64.
            Self(unsafe { _mm_min_ps(self.0, other.0) })
        }

        /// The greater; `other` where either is NaN.
        #[inline(always)]
        pub(in crate::bvh) fn max(self, other: Self) -> Self {
            // SAFETY: SSE is part of x86-64.
            Self(unsafe { _mm_max_ps(self.0, other.0) })
        }

        /// One over each.
        #[inline(always)]
        pub(in crate::bvh) fn inverse(self) -> Self {
            // SAFETY: SSE is part of x86-64.
            Self(unsafe { _mm_div_ps(Self::splat(1.0).0, self.0) })
        }

        #[inline(always)]
        pub(in crate::bvh) fn at_most(self, other: Self) -> Set {
            // SAFETY: SSE is part of x86-64.
            Set(unsafe { _mm_cmple_ps(self.0, other.0) })
        }

        #[inline(always)]
        pub(in crate::bvh) fn below(self, other: Self) -> Set {
            // SAFETY: SSE is part of x86-64.
            Set(unsafe { _mm_cmplt_ps(self.0, other.0) })
        }

        #[inline(always)]
        pub(in crate::bvh) fn is_zero(self) -> Set {
            // SAFETY: SSE is part of x86-64.
            Set(unsafe { _mm_cmpeq_ps(self.0, _mm_setzero_ps()) })
        }

        #[inline(always)]
        pub(in crate::bvh) fn to_array(self) -> [f32; 4] {
            bytemuck::cast(self.0)
        }
    }

    impl Set {
        /// The lanes as bits.
        #[inline(always)]
        pub(in crate::bvh) fn bits(self) -> u32 {
            // SAFETY: SSE is part of x86-64.
            unsafe { _mm_movemask_ps(self.0) as u32 }
        }
    }

    macro_rules! operators {
        ($($name:ty, $operator:ident, $method:ident, $intrinsic:ident;)*) => {$(
            impl $operator for $name {
                type Output = Self;
                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    // SAFETY: SSE is part of x86-64.
                    Self(unsafe { $intrinsic(self.0, other.0) })
                }
            }
        )*};
    }
    operators! {
        Four, Add, add, _mm_add_ps;
        Four, Sub, sub, _mm_sub_ps;
        Four, Mul, mul, _mm_mul_ps;
        Set, BitAnd, bitand, _mm_and_ps;
        Set, BitOr, bitor, _mm_or_ps;
    }
}

#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2", target_feature = "fma")))]
#[path = "lanes_portable.rs"]
mod imp;
