//! Subdiagonal entries in a Hessenberg matrix, with the constants for eliminating them
//! ([`super::elimination`]).

/// Magnitude below which a subdiagonal entry is set to zero, which splits the model in two. Since
/// the largest entry is near 1, the error is far below the rounding error.
const NEGLIGIBLE: f64 = 1e-70;

/// The pivot threshold tau times the order n. The active row and the next row are interchanged if
/// the active entry is more than tau times as large as the next row's entry.
///
/// With tau = 1 the elimination is Gaussian elimination with partial pivoting. A larger tau uses
/// real rows more often, which cost a half to a third as much as complex rows, and increases the
/// rounding error by at most a factor `n tau`: with the unit roundoff 1.1e-16 it is at most 3e-11,
/// for any order. The models in `benches/responses.rs` have errors up to 7e-13, relative to their
/// largest value.
const PIVOT_THRESHOLD: f64 = (1_u32 << 18) as f64;

/// Subdiagonal entry `h` in a column of G, with the constants for eliminating it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subdiagonal {
    /// `h`; zero if negligible.
    pub entry: f64,
    /// Divisor that scales `h` to 1: `h`, or 1 if `h` is negligible.
    pub divisor: f64,
    /// Reciprocal of [`divisor`](Self::divisor).
    pub reciprocal: f64,
    /// `1 / (tau h)^2`; NaN if `h` is negligible, so that no active entry is found to be below the
    /// threshold and the rows are interchanged.
    pub inverse_square_threshold: f64,
    /// `h^2`; -1 if `h` is negligible, so that the active entry is larger in every lane.
    pub square: f64,
}

impl Subdiagonal {
    /// Creates the constants for a subdiagonal entry in a model with `order` states.
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
        let threshold = PIVOT_THRESHOLD / order as f64 * entry;
        Self {
            entry,
            divisor: entry,
            reciprocal: 1.0 / entry,
            inverse_square_threshold: 1.0 / (threshold * threshold),
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
            // Tolerance: rounding errors of a few operations.
            assert!((tau * order as f64 / PIVOT_THRESHOLD - 1.0).abs() < 1e-14);
        }
    }
}
