//! Every conversion between the units inside (SI, rad/s, rad, ratios) and those the engineer reads.

/// Magnitude ratio to decibels: `20 log10 r`. Zero gives minus infinity.
pub fn ratio_to_db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// Decibels to magnitude ratio: `10^(db/20)`.
pub fn db_to_ratio(db: f64) -> f64 {
    10.0_f64.powf(db / 20.0)
}

/// Angular frequency \[rad/s\] to frequency \[Hz\]: `f = omega / 2 pi`.
pub fn rad_s_to_hz(omega: f64) -> f64 {
    omega / std::f64::consts::TAU
}

/// Seconds to milliseconds.
pub fn s_to_ms(seconds: f64) -> f64 {
    1e3 * seconds
}

/// A number as a message repeats it: the shortest text that reads back as the same number, with an exponent where the digits
/// before or after the point would hide it (1e300, 2.5e-12).
pub fn number(value: f64) -> String {
    /// Longest text without an exponent, where one with it would be shorter.
    const LONGEST: usize = 10;
    let (plain, exponent) = (value.to_string(), format!("{value:e}"));
    if plain.len() > LONGEST && exponent.len() < plain.len() { exponent } else { plain }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_in_a_message_is_short_and_never_another_number() {
        for (value, text) in [
            (1e6, "1000000"),
            (1e-6, "0.000001"),
            (-1.0, "-1"),
            (1e300, "1e300"),
            (f64::MIN_POSITIVE, "2.2250738585072014e-308"),
            (0.1 + 0.2, "0.30000000000000004"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn decibels_and_ratios_are_inverse() {
        for ratio in [1e-6, 0.5, 1.0, 2.0, 1e6] {
            // A few ulp of log10 and powf, amplified by |db| / 8.7 <= 14.
            assert!((db_to_ratio(ratio_to_db(ratio)) / ratio - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn a_factor_of_ten_is_twenty_decibels() {
        assert_eq!(ratio_to_db(10.0), 20.0);
    }

    #[test]
    fn one_hertz_is_two_pi_radians_per_second() {
        assert_eq!(rad_s_to_hz(std::f64::consts::TAU), 1.0);
    }
}
