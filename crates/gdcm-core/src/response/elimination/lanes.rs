//! Complex numbers of many frequencies at once, one frequency to a lane of a vector register, and panels of them.

use pulp::Simd;

use super::{Entries, PANEL};

/// One complex number for each lane; real and imaginary parts in a vector register each.
///
/// Aligned to a cache line: a 512-bit load across two lines costs twice.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct ComplexLanes<S: Simd> {
    /// Real parts.
    pub re: S::f64s,
    /// Imaginary parts.
    pub im: S::f64s,
}

impl<S: Simd> ComplexLanes<S> {
    /// The same real number in every lane.
    #[inline(always)]
    pub fn real(simd: S, value: f64) -> Self {
        Self { re: simd.splat_f64s(value), im: simd.splat_f64s(0.0) }
    }

    /// The numbers in the order of [`frequencies`], each in two neighbouring places.
    #[inline(always)]
    pub fn interleaved(self, simd: S) -> [S::f64s; 2] {
        simd.interleave_shfl_f64s([self.re, self.im])
    }

    /// `self - factor real`: 2 fused operations.
    #[inline(always)]
    pub fn minus_real_product(self, simd: S, factor: Self, real: S::f64s) -> Self {
        Self {
            re: simd.negate_mul_add_e_f64s(factor.re, real, self.re),
            im: simd.negate_mul_add_e_f64s(factor.im, real, self.im),
        }
    }

    /// `self + factor j imaginary`: 2 fused operations.
    #[inline(always)]
    pub fn plus_imaginary_product(self, simd: S, factor: Self, imaginary: S::f64s) -> Self {
        Self {
            re: simd.negate_mul_add_e_f64s(factor.im, imaginary, self.re),
            im: simd.mul_add_e_f64s(factor.re, imaginary, self.im),
        }
    }

    /// `self - left right`: 4 fused operations.
    #[inline(always)]
    pub fn minus_product(self, simd: S, left: Self, right: Self) -> Self {
        let Self { re, im } = self.minus_real_product(simd, left, right.re);
        Self { re: simd.mul_add_e_f64s(left.im, right.im, re), im: simd.negate_mul_add_e_f64s(left.re, right.im, im) }
    }

    /// `self other`.
    #[inline(always)]
    pub fn product(self, simd: S, other: Self) -> Self {
        let re = simd.mul_f64s(self.re, other.re);
        let im = simd.mul_f64s(self.re, other.im);
        Self { re: simd.negate_mul_add_e_f64s(self.im, other.im, re), im: simd.mul_add_e_f64s(self.im, other.re, im) }
    }

    /// `self scale`, with a real scale for each lane.
    #[inline(always)]
    pub fn scaled(self, simd: S, scale: S::f64s) -> Self {
        Self { re: simd.mul_f64s(self.re, scale), im: simd.mul_f64s(self.im, scale) }
    }

    /// `1 / self = conj(self) / |self|^2`; not finite in the lanes where `self` is zero.
    #[inline(always)]
    pub fn reciprocal(self, simd: S) -> Self {
        let inverse = simd.div_f64s(simd.splat_f64s(1.0), self.square(simd));
        Self { re: simd.mul_f64s(self.re, inverse), im: simd.neg_f64s(simd.mul_f64s(self.im, inverse)) }
    }

    /// `|self|^2`.
    #[inline(always)]
    pub fn square(self, simd: S) -> S::f64s {
        simd.mul_add_e_f64s(self.im, self.im, simd.mul_f64s(self.re, self.re))
    }

    /// `chosen` in the lanes of `mask`, `self` in the others.
    #[inline(always)]
    pub fn replaced_where(self, simd: S, mask: S::m64s, chosen: Self) -> Self {
        Self { re: simd.select_f64s(mask, chosen.re, self.re), im: simd.select_f64s(mask, chosen.im, self.im) }
    }
}

/// A vector of frequencies, in the order that makes interleaving a shuffle; if there are fewer, the last in the other
/// lanes.
#[inline(always)]
pub fn frequencies<S: Simd>(simd: S, omega: &[f64]) -> S::f64s {
    let mut pairs = [simd.splat_f64s(omega.last().copied().unwrap_or(0.0)); 2];
    let (places, _) = bytemuck::cast_slice_mut::<_, f64>(&mut pairs).as_chunks_mut::<2>();
    for (place, omega) in places.iter_mut().zip(omega) {
        *place = [*omega; 2];
    }
    let [frequencies, _] = simd.deinterleave_shfl_f64s(pairs);
    frequencies
}

/// So many copies of a value. Unlike those of `vec!`, its instructions are those of the vectors that the caller works on.
#[inline(always)]
pub fn filled<T: Copy>(value: T, count: usize) -> Vec<T> {
    let mut values = Vec::with_capacity(count);
    for _ in 0..count {
        values.push(value);
    }
    values
}

/// Whether a mask holds in any lane.
#[inline(always)]
pub fn any<S: Simd>(simd: S, mask: S::m64s) -> bool {
    simd.first_true_m64s(mask) < S::F64_LANES
}

/// A number of `R` rows, in each lane.
pub type Rows<S, const R: usize> = [ComplexLanes<S>; R];

/// Neighbouring columns of `R` rows.
pub type Panel<S, const R: usize> = [Rows<S, R>; PANEL];

/// The active row in neighbouring columns.
pub type Pivots<S> = [ComplexLanes<S>; PANEL];

/// A panel of rows before anything is eliminated.
#[inline(always)]
pub fn real_panel<S: Simd, const R: usize>(simd: S, rows: &[Entries; R]) -> Panel<S, R> {
    let mut panel = [[ComplexLanes::real(simd, 0.0); R]; PANEL];
    for offset in 0..PANEL {
        for row in 0..R {
            panel[offset][row].re = simd.splat_f64s(rows[row][offset]);
        }
    }
    panel
}

/// Subtracts multiples of the imaginary part of a next row, `-shift` right of the column that it clears.
#[inline(always)]
pub fn subtract_diagonal<S: Simd, const R: usize>(
    simd: S,
    entries: &mut Rows<S, R>,
    multipliers: Rows<S, R>,
    shift: S::f64s,
) {
    for row in 0..R {
        entries[row] = entries[row].plus_imaginary_product(simd, multipliers[row], shift);
    }
}

/// `panel - sum of multipliers times next rows`: nearly all the work of an elimination.
#[inline(always)]
pub fn subtract_multiples<S: Simd, const R: usize>(
    simd: S,
    mut panel: Panel<S, R>,
    multipliers: &[Rows<S, R>],
    next: &[Entries],
) -> Panel<S, R> {
    for (next, multipliers) in next.iter().zip(multipliers) {
        let (a, b, c) = (simd.splat_f64s(next[0]), simd.splat_f64s(next[1]), simd.splat_f64s(next[2]));
        // In this order sixteen registers hold the panel of two rows, three entries and one part of a multiplier.
        for row in 0..R {
            let ComplexLanes { re, im } = multipliers[row];
            panel[0][row].re = simd.negate_mul_add_e_f64s(re, a, panel[0][row].re);
            panel[1][row].re = simd.negate_mul_add_e_f64s(re, b, panel[1][row].re);
            panel[2][row].re = simd.negate_mul_add_e_f64s(re, c, panel[2][row].re);
            panel[0][row].im = simd.negate_mul_add_e_f64s(im, a, panel[0][row].im);
            panel[1][row].im = simd.negate_mul_add_e_f64s(im, b, panel[1][row].im);
            panel[2][row].im = simd.negate_mul_add_e_f64s(im, c, panel[2][row].im);
        }
    }
    panel
}

/// `panel - quotients pivots`: 4 fused operations on real numbers for each entry.
#[inline(always)]
pub fn subtract_pivots<S: Simd, const R: usize>(
    simd: S,
    mut panel: Panel<S, R>,
    quotients: &Rows<S, R>,
    pivots: &Pivots<S>,
) -> Panel<S, R> {
    for row in 0..R {
        for offset in 0..PANEL {
            panel[offset][row] = panel[offset][row].minus_product(simd, quotients[row], pivots[offset]);
        }
    }
    panel
}

/// [`subtract_pivots`] of the tile whose first row is the active one: that is kept as `pivots`, and has zero in its place.
#[inline(always)]
pub fn subtract_active<S: Simd, const R: usize>(
    simd: S,
    mut panel: Panel<S, R>,
    quotients: &Rows<S, R>,
    pivots: &mut Pivots<S>,
) -> Panel<S, R> {
    let zero = ComplexLanes::real(simd, 0.0);
    for row in 1..R {
        for entries in &mut panel {
            entries[row] = entries[row].minus_product(simd, quotients[row], entries[0]);
        }
    }
    // The active row last, so that it need not be copied.
    for (pivot, rows) in pivots.iter_mut().zip(&mut panel) {
        *pivot = rows[0];
        rows[0] = zero.minus_product(simd, quotients[0], rows[0]);
    }
    panel
}
