//! Threshold pivoting: which of two rows clears a column, and what that makes of the others.

use pulp::Simd;

use super::complex_lanes::ComplexLanes;
use super::panel::Rows;

/// Subdiagonal entries below this part the model in two; the largest entry is of order 1, and a double has 16 digits.
const NEGLIGIBLE: f64 = 1e-70;

/// How much larger than the entry of the next row that of the active row must be for both to be interchanged, times the
/// order (`n tau`).
///
/// With tau = 1 elimination is partial pivoting. Real rows take a half to a third of the work of complex ones; they cost at
/// most this factor in accuracy: `n tau` times the unit roundoff of 1.1e-16 is 3e-11, for every order. The errors of the
/// models in `benches/responses.rs` are up to 7e-13 of their largest value.
const PIVOT_THRESHOLD: f64 = (1_u32 << 18) as f64;

/// The one entry of a column of G below the diagonal, `h`, and how it is eliminated.
#[derive(Clone, Copy, Debug)]
pub struct Subdiagonal {
    /// `h`; zero where that is negligible.
    pub entry: f64,
    /// What the row of `h` is divided by, so that it has a one in place of `h`: `h`, or one where that is negligible.
    pub divisor: f64,
    /// One over [`divisor`](Self::divisor).
    pub reciprocal: f64,
    /// `1 / (tau h)^2`; not a number, so that no comparison holds, where `h` is negligible.
    pub inverse_square_threshold: f64,
    /// `h^2`; below every square where `h` is negligible.
    pub square: f64,
}

impl Subdiagonal {
    /// That of a column after which no row follows: nothing is subtracted, and no interchange asked for.
    pub const NONE: Self =
        Self { entry: 0.0, divisor: 1.0, reciprocal: 0.0, inverse_square_threshold: 0.0, square: f64::INFINITY };

    /// Of a model of an order.
    pub fn new(entry: f64, order: usize) -> Self {
        if entry.abs() < NEGLIGIBLE {
            return Self {
                entry: 0.0,
                divisor: 1.0,
                reciprocal: 1.0,
                inverse_square_threshold: f64::NAN,
                square: -1.0,
            };
        }
        let largest = PIVOT_THRESHOLD / order as f64 * entry;
        let (reciprocal, inverse_square_threshold) = (1.0 / entry, 1.0 / (largest * largest));
        Self { entry, divisor: entry, reciprocal, inverse_square_threshold, square: entry * entry }
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_that_is_negligible_always_asks_for_an_interchange() {
        let subdiagonal = Subdiagonal::new(1e-80, 12);
        for active in [0.0, 1e-90, 1.0] {
            assert!(active > subdiagonal.square, "the active row is chosen");
            let asks = active * subdiagonal.inverse_square_threshold;
            assert!(asks.is_nan(), "no comparison holds");
        }
        assert_eq!((subdiagonal.entry, subdiagonal.reciprocal), (0.0, 1.0));
    }

    #[test]
    fn the_pivot_threshold_times_the_order_is_the_same_for_every_order() {
        for order in [2, 12, 60, 500] {
            let tau = Subdiagonal::new(0.5, order).inverse_square_threshold.sqrt().recip() / 0.5;
            // A handful of roundings.
            assert!((tau * order as f64 / PIVOT_THRESHOLD - 1.0).abs() < 1e-14);
        }
    }
}
