//! Converts numbers to text: the formats shared by messages, files, plots and the window.
//!
//! Each function has a fixed minus sign: a hyphen for messages and files, a true minus sign for
//! plots, the window and sentences. Where a value that may be negative gets a hyphen but needs a
//! true minus sign, [`with_minus_sign`] converts it.
//!
//! | function | digits | minus sign |
//! |---|---|---|
//! | [`number`] | shortest text that parses to the same number | hyphen |
//! | [`full_precision`] | the same, for files; empty if not finite | hyphen |
//! | [`six_digits`] | at most 6 significant | hyphen |
//! | [`compact`] | at most 6 significant, or all before the point; no trailing zeros | true |
//! | [`five_digits`] | 5 significant | true |
//! | [`significant`] | 3 significant | hyphen |
//! | [`three_digits`] | 3 significant; below 1, 3 decimals | hyphen |
//! | [`rounded_to_three_digits`] | at most 3 significant, without trailing zeros | none (positive) |
//! | [`gain_text`] | 3 decimals, or 2 if the third is zero; below 0.1, 3 significant | none (positive) |
//! | [`decimals`], [`decimals_or_dash`] | given decimals | true |
//! | [`signed`] | given decimals, with plus sign | true |
//! | [`telling`] | given decimals; 2 significant below one unit in the last decimal | hyphen |
//! | [`conjugate_pair`] | real and imaginary part, each as by [`telling`] | true |
//! | [`told_apart`] | given decimals, or as many as distinguish two values | hyphen |
//!
//! Counts with their nouns: [`counted`].

/// The true minus sign, which is as wide as a plus sign.
const MINUS: char = '\u{2212}';

/// Mark for a missing value in tables and lists.
pub const NO_VALUE: &str = "–";

/// Formats a number for a message: the shortest text that parses to the same number. A very large
/// or small number has an exponent (1e300, 2.5e-12).
pub fn number(value: f64) -> String {
    /// Maximum length of the plain form if the exponent form is shorter.
    const LONGEST: usize = 10;
    let plain = value.to_string();
    let exponent = format!("{value:e}");
    if plain.len() > LONGEST && exponent.len() < plain.len() {
        exponent
    } else {
        plain
    }
}

/// Formats a count with its noun, whose plural ends in s: "1 state", "3 states".
pub fn counted(count: usize, noun: &str) -> String {
    if count == 1 {
        format!("1 {noun}")
    } else {
        format!("{count} {noun}s")
    }
}

/// Formats a value for display with at most six significant digits: "0.530279", "12", "1e300".
pub fn six_digits(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    number(rounded)
}

/// Removes the sign from a formatted zero: "0.0" for "-0.0"; any other text is unchanged.
pub fn without_sign_of_zero(text: &str) -> &str {
    let Some(digits) = text.strip_prefix(['-', MINUS]) else {
        return text;
    };
    let is_zero = digits.contains('0') && digits.chars().all(|digit| matches!(digit, '0' | '.'));
    if is_zero { digits } else { text }
}

/// Formats a value with the given number of decimals. A nonzero value that is smaller than one unit
/// in the last decimal gets two significant digits instead.
pub fn telling(value: f64, decimals: usize) -> String {
    /// Maximum number of decimals; a value that needs more is given an exponent.
    const MOST: i32 = 6;
    if value == 0.0 || !value.is_finite() || value.abs() >= 10_f64.powi(-(decimals as i32)) {
        return format!("{value:.decimals$}");
    }
    let needed = 1 - value.abs().log10().floor() as i32;
    if needed > MOST {
        format!("{value:.1e}")
    } else {
        format!("{value:.*}", needed as usize)
    }
}

/// Formats two values with the given number of decimals, or with as many more as needed to
/// distinguish them; equal values keep the given number.
pub fn told_apart(a: f64, b: f64, decimals: usize) -> (String, String) {
    /// Maximum number of decimals: as many as an `f64` near 1 has.
    const MOST: usize = 15;
    let texts = |decimals: usize| (format!("{a:.decimals$}"), format!("{b:.decimals$}"));
    let enough = (decimals..=MOST).find(|&decimals| texts(decimals).0 != texts(decimals).1);
    texts(enough.unwrap_or(decimals))
}

/// Formats a change with its sign and the given number of decimals: "+12.3", "−0.4". A change that
/// rounds to zero has no sign.
pub fn signed(change: f64, decimals: usize) -> String {
    let text = format!("{change:+.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '+' | '-' | '0' | '.'));
    if is_zero {
        text[1..].to_owned()
    } else {
        with_minus_sign(&text)
    }
}

/// Formats a value with up to six significant digits (at most 12 decimals, and all digits before
/// the decimal point) and a true minus sign, without trailing zeros.
pub fn compact(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    let decimals = (5 - value.abs().log10().floor() as i64).clamp(0, 12) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    with_minus_sign(without_sign_of_zero(text))
}

/// Formats a value with `count` decimals and a true minus sign; zero has no sign.
pub fn decimals(value: f64, count: usize) -> String {
    with_minus_sign(without_sign_of_zero(&format!("{value:.count$}")))
}

/// Formats a value with `count` decimals and a true minus sign; zero has no sign, and a missing
/// value becomes [`NO_VALUE`].
pub fn decimals_or_dash(value: Option<f64>, count: usize) -> String {
    match value {
        Some(value) => decimals(value, count),
        None => NO_VALUE.to_owned(),
    }
}

/// Formats a real number, or a number and its complex conjugate: "−2.54 ± j1.26". The j comes
/// before the imaginary part, because "−2.54 ± 1.26j" reads like a value with its error. Each part
/// has as many decimals as [`telling`] gives it.
pub fn conjugate_pair(re: f64, im: f64, decimals: usize) -> String {
    let real = telling(re, decimals);
    let real = with_minus_sign(without_sign_of_zero(&real));
    if im == 0.0 {
        return real;
    }
    let imaginary = with_minus_sign(&telling(im.abs(), decimals));
    format!("{real} ± j{imaginary}")
}

/// Replaces hyphens by true minus signs.
pub fn with_minus_sign(number: &str) -> String {
    number.replace('-', &MINUS.to_string())
}

/// Formats a value with five significant digits and a true minus sign; below 1e-5 and from 1e8 on
/// with an exponent, and below 1e8 with all digits before the decimal point.
pub fn five_digits(value: f64) -> String {
    const SIGNIFICANT: i32 = 5;
    /// Powers of ten of the values that have no exponent.
    const PLAIN: std::ops::RangeInclusive<i32> = -5..=7;
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    let exponent = value.abs().log10().floor() as i32;
    let text = if PLAIN.contains(&exponent) {
        format!("{value:.*}", (SIGNIFICANT - 1 - exponent).max(0) as usize)
    } else {
        format!("{value:.4e}")
    };
    with_minus_sign(&text)
}

/// Formats a positive value with up to three significant digits, without trailing zeros.
pub fn rounded_to_three_digits(value: f64) -> String {
    let scale = 10_f64.powf(2.0 - value.log10().floor());
    number((value * scale).round() / scale)
}

/// Formats a value with three significant digits; below 1, with three decimals; from 1000 on,
/// without decimals.
pub fn three_digits(value: f64) -> String {
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 3.0) as usize;
    format!("{value:.decimals$}")
}

/// Formats a value with three significant digits, or four from 1000 on; with an exponent below
/// 0.001 and from 10 000 on.
pub fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if (-3.0..4.0).contains(&magnitude) {
        format!("{value:.*}", (2.0 - magnitude).max(0.0) as usize)
    } else {
        format!("{value:.2e}")
    }
}

/// Formats a gain with three decimals, or with two if the third is zero. A gain below 0.1 is given
/// three significant digits.
pub fn gain_text(gain: f64) -> String {
    if gain < 0.1 {
        return significant(gain);
    }
    let text = format!("{gain:.3}");
    text.strip_suffix('0').map(str::to_owned).unwrap_or(text)
}

/// Formats a value at full precision for a file; empty if it is missing or not finite.
pub fn full_precision(value: Option<f64>) -> String {
    match value {
        // `{value:?}` writes an exponent, whereas `{value}` would write up to hundreds of zeros.
        Some(value) if value.is_finite() => format!("{value:?}"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_figure_is_given_to_the_digits_that_tell_it() {
        let figures = [12.34, 0.1, 0.06, 0.0123, -0.000_04, 0.0, 3e-9];
        assert_eq!(
            figures.map(|value| telling(value, 1)),
            [
                "12.3",
                "0.1",
                "0.060",
                "0.012",
                "-0.000040",
                "0.0",
                "3.0e-9"
            ]
        );
        assert_eq!(
            told_apart(1.2, 1.4, 3),
            ("1.200".to_owned(), "1.400".to_owned())
        );
        assert_eq!(
            told_apart(1.000_04, 1.0, 3),
            ("1.00004".to_owned(), "1.00000".to_owned())
        );
        assert_eq!(
            told_apart(2.0, 2.0, 1),
            ("2.0".to_owned(), "2.0".to_owned())
        );
    }

    #[test]
    fn a_change_has_its_sign_unless_it_rounds_to_nothing() {
        assert_eq!(
            [12.34, -0.44, -0.04, 0.0].map(|change| signed(change, 1)),
            ["+12.3", "−0.4", "0.0", "0.0"]
        );
    }

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
    fn figures_for_people_have_six_digits_and_zeros_no_sign() {
        let figures = [0.530_278_677_112_3, 12.0, 1e300, -1e-12, 0.0, 1e3 * 0.0123];
        assert_eq!(
            figures.map(six_digits),
            ["0.530279", "12", "1e300", "-1e-12", "0", "12.3"]
        );
        let texts = [
            "-0.0",
            "\u{2212}0.00",
            "-0",
            "-0.01",
            "-",
            "-.",
            "0.0",
            "-0.0 dB",
            "-x",
        ];
        let expected = [
            "0.0", "0.00", "0", "-0.01", "-", "-.", "0.0", "-0.0 dB", "-x",
        ];
        assert_eq!(texts.map(without_sign_of_zero), expected);
    }

    #[test]
    fn alpha_is_shown_with_three_significant_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (0.00123, "0.00123"),
            (120.0, "120"),
            (1e6, "1.00e6"),
        ] {
            assert_eq!(significant(value), text);
        }
    }

    #[test]
    fn a_gain_is_shown_with_two_or_three_digits_behind_the_point() {
        for (value, text) in [
            (1.0, "1.00"),
            (1.25, "1.25"),
            (1.2346, "1.235"),
            (1e-6, "1.00e-6"),
        ] {
            assert_eq!(gain_text(value), text);
        }
    }

    #[test]
    fn a_figure_has_five_digits() {
        let figures = [1.234_567, -0.012_345_6, 123_456.7, 0.0, 1e-9, 2.0];
        assert_eq!(
            figures.map(five_digits),
            ["1.2346", "−0.012346", "123457", "0", "1.0000e−9", "2.0000"]
        );
    }

    #[test]
    fn a_compact_number_has_no_more_digits_than_it_needs() {
        for (value, text) in [
            (0.3, "0.3"),
            (1.0 - 1e-12, "1"),
            (20.0, "20"),
            (-25.0, "\u{2212}25"),
            (0.0, "0"),
            (1.25, "1.25"),
            (100_000.0, "100000"),
        ] {
            assert_eq!(compact(value), text);
        }
    }

    #[test]
    fn a_pair_of_complex_numbers_is_no_value_with_an_error_bar() {
        assert_eq!(conjugate_pair(-2.54, 1.26, 2), "\u{2212}2.54 ± j1.26");
        assert_eq!(conjugate_pair(0.3, -1.2, 3), "0.300 ± j1.200");
        assert_eq!(conjugate_pair(-0.5, 0.0, 2), "\u{2212}0.50");
        assert_eq!(conjugate_pair(-0.0, 0.012, 1), "0.0 ± j0.012");
    }

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!(decimals(-0.04, 1), "0.0");
        assert_eq!(decimals(-0.06, 1), "\u{2212}0.1");
    }
}
