//! Rounds suggested bounds to three digits.

/// Rounds `value` to three significant digits with `round` (`f64::ceil` or `f64::floor`). A value
/// that already has three digits, apart from rounding errors, is not changed.
pub(super) fn three_digits(value: f64, round: fn(f64) -> f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    // `value` is `digits 10^exponent` with `digits` from 100 to 999.
    let exponent = value.abs().log10().floor() as i32 - 2;
    // Divide, do not multiply by a negative power: 187 / 100 is 1.87 exactly.
    let digits = if exponent < 0 {
        value * 10f64.powi(-exponent)
    } else {
        value / 10f64.powi(exponent)
    };
    let nearest = digits.round();
    let digits = if (digits - nearest).abs() <= 1e-9 * nearest.abs() {
        nearest
    } else {
        round(digits)
    };
    if exponent < 0 {
        digits / 10f64.powi(-exponent)
    } else {
        digits * 10f64.powi(exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_rounded_to_three_digits_so_that_it_still_suffices() {
        assert_eq!(three_digits(1.8681, f64::ceil), 1.87);
        assert_eq!(three_digits(1.8681, f64::floor), 1.86);
        assert_eq!(three_digits(0.060_801, f64::ceil), 0.0609);
        assert_eq!(three_digits(0.060_801, f64::floor), 0.0608);
        assert_eq!(three_digits(1234.0, f64::ceil), 1240.0);
        assert_eq!(three_digits(1234.0, f64::floor), 1230.0);
        assert_eq!(three_digits(0.999_7, f64::ceil), 1.0);
        assert_eq!(three_digits(0.999_7, f64::floor), 0.999);
    }

    #[test]
    fn a_figure_of_three_digits_up_to_rounding_stays() {
        assert_eq!(three_digits(0.7 * 2.5, f64::ceil), 1.75);
        assert_eq!(three_digits(1.4 / 2.5, f64::floor), 0.56);
        assert_eq!(three_digits(0.0, f64::ceil), 0.0);
        assert_eq!(three_digits(0.0, f64::floor), 0.0);
    }
}
