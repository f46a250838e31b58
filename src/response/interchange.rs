//! An interchange of two rows.

use pulp::Simd;

use super::complex_lanes::ComplexLanes;
use super::eliminated_rows::Rows;
use super::subdiagonal::Subdiagonal;

/// That the active row clears a column, in some lanes, and the next row becomes active in its place.
///
/// With `u` the entry of the active row in the column, `w` that of another complex row, and `h` that of the next row, the
/// rows become
///
/// ```text
/// active row:  h (next row / h) - (h / u) (active row)
/// other row:   (row) - (w / u) (active row)
/// ```
///
/// In the other lanes the next row clears the column, and `u` and `w` times (next row / h) are subtracted. Both are done in
/// two steps: *quotients* times the active row are subtracted (from zero in place of the active row itself), then
/// *multipliers* times (next row / h).
#[derive(Clone, Copy)]
pub struct Interchange<S: Simd> {
    /// The column.
    pub column: usize,
    lanes: S::m64s,
    /// `1 / u`.
    reciprocal: ComplexLanes<S>,
}

impl<S: Simd> Interchange<S> {
    /// None in any lane.
    #[inline(always)]
    pub fn none(simd: S) -> Self {
        let one = ComplexLanes::real(simd, 1.0);
        Self { column: 0, lanes: simd.less_than_f64s(one.re, one.re), reciprocal: one }
    }

    /// In the lanes where the entry `u` of the active row is larger than that of the next row.
    #[inline(always)]
    pub fn new(simd: S, column: usize, subdiagonal: &Subdiagonal, pivot: ComplexLanes<S>) -> Self {
        let lanes = simd.greater_than_f64s(pivot.square(simd), simd.splat_f64s(subdiagonal.square));
        Self { column, lanes, reciprocal: pivot.reciprocal(simd) }
    }

    /// The quotients of rows with these entries: `w / u`, or zero.
    #[inline(always)]
    pub fn quotients<const R: usize>(&self, simd: S, mut entries: Rows<S, R>) -> Rows<S, R> {
        let zero = ComplexLanes::real(simd, 0.0);
        for entry in &mut entries {
            *entry = zero.replaced_where(simd, self.lanes, entry.product(simd, self.reciprocal));
        }
        entries
    }

    /// The quotient of the active row: `h / u`, or -1.
    #[inline(always)]
    pub fn active_quotient(&self, simd: S, subdiagonal: &Subdiagonal) -> ComplexLanes<S> {
        // Zero even where the pivot is zero: nothing of the active row goes on.
        let quotient = if subdiagonal.entry == 0.0 {
            ComplexLanes::real(simd, 0.0)
        } else {
            self.reciprocal.scaled(simd, simd.splat_f64s(subdiagonal.entry))
        };
        ComplexLanes::real(simd, -1.0).replaced_where(simd, self.lanes, quotient)
    }

    /// The multipliers of rows with these entries: zero, or `w`.
    #[inline(always)]
    pub fn multipliers<const R: usize>(&self, simd: S, mut entries: Rows<S, R>) -> Rows<S, R> {
        let zero = ComplexLanes::real(simd, 0.0);
        for entry in &mut entries {
            *entry = entry.replaced_where(simd, self.lanes, zero);
        }
        entries
    }

    /// The multiplier of the active row: `-h`, or `u`.
    #[inline(always)]
    pub fn active_multiplier(&self, simd: S, subdiagonal: &Subdiagonal, pivot: ComplexLanes<S>) -> ComplexLanes<S> {
        pivot.replaced_where(simd, self.lanes, ComplexLanes::real(simd, -subdiagonal.divisor))
    }
}
