//! A panel of neighbouring columns of a few rows, held in registers, and what elimination subtracts from it.

use pulp::Simd;

use super::complex_lanes::ComplexLanes;
use super::hessenberg_form::{Entries, PANEL};

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
