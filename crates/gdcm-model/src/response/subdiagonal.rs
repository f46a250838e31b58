//! Subdiagonal entries in a Hessenberg matrix, with the constants for elimination.

/// Magnitude below which a subdiagonal entry counts as zero, which splits the model in two. The
/// largest entry is near 1 and a double has 16 digits, so that the error is far below rounding.
const NEGLIGIBLE: f64 = 1e-70;

/// The pivot threshold tau times the order n. Active and next row are interchanged where the active
/// entry is more than tau times as large as the next row's entry.
///
/// With tau = 1 elimination is partial pivoting. Real rows cost a half to a third as much as
/// complex rows, and increase the rounding error by a factor of at most `n tau`: times the unit
/// roundoff 1.1e-16 this is 3e-11, for any order. The models in `benches/responses.rs` have errors
/// up to 7e-13, relative to their largest value.
const PIVOT_THRESHOLD: f64 = (1_u32 << 18) as f64;

/// The subdiagonal entry `h` in a column of G, with the constants for its elimination.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subdiagonal {
    /// `h`; zero where negligible.
    pub entry: f64,
    /// Divisor that normalises `h` to 1: `h`, or 1 where `h` is negligible.
    pub divisor: f64,
    /// Reciprocal of [`divisor`](Self::divisor).
    pub reciprocal: f64,
    /// `1 / (tau h)^2`; NaN where `h` is negligible, so that no comparison holds.
    pub inverse_square_threshold: f64,
    /// `h^2`; less than every square where `h` is negligible.
    pub square: f64,
}

impl Subdiagonal {
    /// Creates the constants for a model of the given order.
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
        let reciprocal = 1.0 / entry;
        let inverse_square_threshold = 1.0 / (largest * largest);
        Self {
            entry,
            divisor: entry,
            reciprocal,
            inverse_square_threshold,
            square: entry * entry,
        }
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
            let tau = Subdiagonal::new(0.5, order)
                .inverse_square_threshold
                .sqrt()
                .recip()
                / 0.5;
            // Rounding errors of a few operations.
            assert!((tau * order as f64 / PIVOT_THRESHOLD - 1.0).abs() < 1e-14);
        }
    }
}
