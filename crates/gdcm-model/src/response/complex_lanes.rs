//! Complex arithmetic on vector registers.
//!
//! Each lane of a register, one of its elements, belongs to another frequency (`elimination.rs`).

use nalgebra::Complex;
use pulp::Simd;

/// A complex number per lane; real and imaginary parts in separate vector registers.
///
/// Aligned to a cache line: a 512-bit load across two lines costs twice as much.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct ComplexLanes<S: Simd> {
    pub(super) re: S::f64s,
    pub(super) im: S::f64s,
}

impl<S: Simd> ComplexLanes<S> {
    /// Returns a real value, repeated in every lane.
    #[inline(always)]
    pub(super) fn real(simd: S, value: f64) -> Self {
        Self {
            re: simd.splat_f64s(value),
            im: simd.splat_f64s(0.0),
        }
    }

    /// Returns `self - factor * real`: 2 fused operations.
    #[inline(always)]
    pub(super) fn minus_real_product(self, simd: S, factor: Self, real: S::f64s) -> Self {
        Self {
            re: simd.negate_mul_add_e_f64s(factor.re, real, self.re),
            im: simd.negate_mul_add_e_f64s(factor.im, real, self.im),
        }
    }

    /// Returns `self + left * right`: 4 fused operations.
    #[inline(always)]
    pub(super) fn plus_product(self, simd: S, left: Self, right: Self) -> Self {
        let re = simd.mul_add_e_f64s(left.re, right.re, self.re);
        let im = simd.mul_add_e_f64s(left.im, right.re, self.im);
        Self {
            re: simd.negate_mul_add_e_f64s(left.im, right.im, re),
            im: simd.mul_add_e_f64s(left.re, right.im, im),
        }
    }

    #[inline(always)]
    pub(super) fn minus(self, simd: S, other: Self) -> Self {
        Self {
            re: simd.sub_f64s(self.re, other.re),
            im: simd.sub_f64s(self.im, other.im),
        }
    }

    /// Returns the value in a lane.
    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> Complex<f64> {
        let re: &[f64] = bytemuck::cast_slice(std::slice::from_ref(&self.re));
        let im: &[f64] = bytemuck::cast_slice(std::slice::from_ref(&self.im));
        Complex::new(re[lane], im[lane])
    }

    /// Returns `self - left * right`: 4 fused operations.
    #[inline(always)]
    pub(super) fn minus_product(self, simd: S, left: Self, right: Self) -> Self {
        let Self { re, im } = self.minus_real_product(simd, left, right.re);
        Self {
            re: simd.mul_add_e_f64s(left.im, right.im, re),
            im: simd.negate_mul_add_e_f64s(left.re, right.im, im),
        }
    }

    #[inline(always)]
    pub(super) fn product(self, simd: S, other: Self) -> Self {
        let re = simd.mul_f64s(self.re, other.re);
        let im = simd.mul_f64s(self.re, other.im);
        Self {
            re: simd.negate_mul_add_e_f64s(self.im, other.im, re),
            im: simd.mul_add_e_f64s(self.im, other.re, im),
        }
    }

    /// Returns `self * scale`, with a real scale per lane.
    #[inline(always)]
    pub(super) fn scaled(self, simd: S, scale: S::f64s) -> Self {
        Self {
            re: simd.mul_f64s(self.re, scale),
            im: simd.mul_f64s(self.im, scale),
        }
    }

    /// Returns `1 / self = conj(self) / |self|^2`; not finite in the lanes where `self` is zero.
    #[inline(always)]
    pub(super) fn reciprocal(self, simd: S) -> Self {
        let inverse = simd.div_f64s(simd.splat_f64s(1.0), self.square(simd));
        Self {
            re: simd.mul_f64s(self.re, inverse),
            im: simd.neg_f64s(simd.mul_f64s(self.im, inverse)),
        }
    }

    /// Returns `|self|^2`.
    #[inline(always)]
    pub(super) fn square(self, simd: S) -> S::f64s {
        simd.mul_add_e_f64s(self.im, self.im, simd.mul_f64s(self.re, self.re))
    }

    /// Returns `chosen` in the lanes where `mask` is set, and `self` in the other lanes.
    #[inline(always)]
    pub(super) fn replaced_where(self, simd: S, mask: S::m64s, chosen: Self) -> Self {
        Self {
            re: simd.select_f64s(mask, chosen.re, self.re),
            im: simd.select_f64s(mask, chosen.im, self.im),
        }
    }
}
