//! Figures rounded so that they still suffice.

/// The least number of three significant digits that is not below `value`.
pub(crate) fn three_digits_up(value: f64) -> f64 {
    three_digits(value, f64::ceil)
}

/// The greatest number of three significant digits that is not above `value`.
pub(crate) fn three_digits_down(value: f64) -> f64 {
    three_digits(value, f64::floor)
}

fn three_digits(value: f64, round: impl Fn(f64) -> f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let exponent = value.abs().log10().floor() as i32 - 2;
    // A value that is three digits up to rounding stays as it is. Negative powers are divided by: 1.87 is 187 / 100 exactly.
    let digits = if exponent < 0 { value * 10f64.powi(-exponent) } else { value / 10f64.powi(exponent) };
    let nearest = digits.round();
    let digits = if (digits - nearest).abs() <= 1e-9 * nearest.abs() { nearest } else { round(digits) };
    if exponent < 0 { digits / 10f64.powi(-exponent) } else { digits * 10f64.powi(exponent) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_rounded_to_three_digits_so_that_it_still_suffices() {
        assert_eq!((three_digits_up(1.8681), three_digits_down(1.8681)), (1.87, 1.86));
        assert_eq!((three_digits_up(0.060_801), three_digits_down(0.060_801)), (0.0609, 0.0608));
        assert_eq!((three_digits_up(1234.0), three_digits_down(1234.0)), (1240.0, 1230.0));
        assert_eq!((three_digits_up(0.999_7), three_digits_down(0.999_7)), (1.0, 0.999));
    }

    #[test]
    fn a_figure_of_three_digits_up_to_rounding_stays() {
        assert_eq!((three_digits_up(0.7 * 2.5), three_digits_down(1.4 / 2.5)), (1.75, 0.56));
        assert_eq!((three_digits_up(0.0), three_digits_down(0.0)), (0.0, 0.0));
    }
}
