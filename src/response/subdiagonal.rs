//! What elimination does with the entry below the diagonal.

/// Subdiagonal entries below this part the model in two; the largest entry is of order 1, and a double has 16 digits.
const NEGLIGIBLE: f64 = 1e-70;

/// How much larger than the entry of the next row that of the active row must be for both to be interchanged, times the
/// order (`n tau`).
///
/// With tau = 1 elimination is partial pivoting. Real rows take a half to a third of the work of complex ones; they cost at
/// most this factor in accuracy: `n tau` times the unit roundoff of 1.1e-16 is 3e-11, for every order. The errors of the
/// models in `benches/responses.rs` are up to 7e-13 of their largest value.
const PREFERENCE_FOR_REAL: f64 = (1_u32 << 18) as f64;

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
    pub sensitivity: f64,
    /// `h^2`; below every square where `h` is negligible.
    pub square: f64,
}

impl Subdiagonal {
    /// That of a column after which no row follows: nothing is subtracted, and no interchange asked for.
    pub const NONE: Self = Self { entry: 0.0, divisor: 1.0, reciprocal: 0.0, sensitivity: 0.0, square: f64::INFINITY };

    /// Of a model of an order.
    pub fn new(entry: f64, order: usize) -> Self {
        if entry.abs() < NEGLIGIBLE {
            return Self { entry: 0.0, divisor: 1.0, reciprocal: 1.0, sensitivity: f64::NAN, square: -1.0 };
        }
        let largest = PREFERENCE_FOR_REAL / order as f64 * entry;
        let (reciprocal, sensitivity) = (1.0 / entry, 1.0 / (largest * largest));
        Self { entry, divisor: entry, reciprocal, sensitivity, square: entry * entry }
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
            let asks = active * subdiagonal.sensitivity;
            assert!(asks.is_nan(), "no comparison holds");
        }
        assert_eq!((subdiagonal.entry, subdiagonal.reciprocal), (0.0, 1.0));
    }

    #[test]
    fn the_preference_times_the_order_is_the_same_for_every_order() {
        for order in [2, 12, 60, 500] {
            let tau = Subdiagonal::new(0.5, order).sensitivity.sqrt().recip() / 0.5;
            // A handful of roundings.
            assert!((tau * order as f64 / PREFERENCE_FOR_REAL - 1.0).abs() < 1e-14);
        }
    }
}
