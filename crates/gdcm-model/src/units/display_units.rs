//! Conversions between internal units (SI, rad/s, rad, ratios) and display units.

/// Converts a magnitude ratio to decibels: `20 log10 r`. Zero gives minus infinity.
pub fn ratio_to_db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// Converts decibels to a magnitude ratio: `10^(db/20)`.
pub fn db_to_ratio(db: f64) -> f64 {
    10.0_f64.powf(db / 20.0)
}

/// Converts the natural logarithm of a magnitude ratio, such as a small relative deviation, to
/// decibels: `20 neper / ln 10`.
pub fn neper_to_db(neper: f64) -> f64 {
    const DB_PER_NEPER: f64 = 8.685_889_638_065_037;
    DB_PER_NEPER * neper
}

/// Converts an angular frequency \[rad/s\] to a frequency \[Hz\]: `f = omega / 2 pi`.
pub fn rad_s_to_hz(omega: f64) -> f64 {
    omega / std::f64::consts::TAU
}

/// Converts a frequency \[Hz\] to an angular frequency \[rad/s\]: `omega = 2 pi f`.
pub fn hz_to_rad_s(frequency: f64) -> f64 {
    std::f64::consts::TAU * frequency
}

/// Converts milliseconds to seconds.
pub fn ms_to_s(milliseconds: f64) -> f64 {
    1e-3 * milliseconds
}

/// Converts seconds to milliseconds.
pub fn s_to_ms(seconds: f64) -> f64 {
    1e3 * seconds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decibels_and_ratios_are_inverse() {
        for ratio in [1e-6, 0.5, 1.0, 2.0, 1e6] {
            // Tolerance: a few ulp of log10 and powf, amplified by |db| / 8.7 <= 14.
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
