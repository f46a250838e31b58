//! Numbers as text, for messages and tables.

/// Formats a number for a message: the shortest text that parses to the same number, with an
/// exponent where the digits before or after the point would hide it (1e300, 2.5e-12).
pub fn number(value: f64) -> String {
    /// Longest text without an exponent, where the exponent form would be shorter.
    const LONGEST: usize = 10;
    let plain = value.to_string();
    let exponent = format!("{value:e}");
    if plain.len() > LONGEST && exponent.len() < plain.len() {
        exponent
    } else {
        plain
    }
}

/// Formats a value for display with at most six significant digits: "0.530279", "12", "1e300".
pub fn six_digits(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    number(rounded)
}

/// Removes the sign of a formatted zero: "0.0" for "-0.0"; any other text is unchanged.
pub fn without_sign_of_zero(text: &str) -> &str {
    let Some(digits) = text.strip_prefix(['-', '\u{2212}']) else {
        return text;
    };
    let is_zero = digits.contains('0') && digits.chars().all(|digit| matches!(digit, '0' | '.'));
    if is_zero { digits } else { text }
}

/// Formats a value with the given decimals; a nonzero value that would round to zero gets two
/// significant digits instead.
pub fn telling(value: f64, decimals: usize) -> String {
    /// Most decimals; beyond, an exponent is shorter.
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

/// Formats two values with the given decimals, or with as many more as distinguish them.
pub fn told_apart(a: f64, b: f64, decimals: usize) -> (String, String) {
    /// All decimals of a number near 1.
    const MOST: usize = 15;
    for decimals in decimals..=MOST {
        let first = format!("{a:.decimals$}");
        let second = format!("{b:.decimals$}");
        if first != second {
            return (first, second);
        }
    }
    (format!("{a:.decimals$}"), format!("{b:.decimals$}"))
}

/// Formats a change with its sign and the given decimals: "+12.3", "−0.4"; a change that rounds to
/// zero has no sign.
pub fn signed(change: f64, decimals: usize) -> String {
    let text = format!("{change:+.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '+' | '-' | '0' | '.'));
    if is_zero {
        text[1..].to_owned()
    } else {
        text.replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_values_keep_two_significant_digits() {
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
    fn a_change_has_its_sign_unless_it_rounds_to_zero() {
        assert_eq!(
            [12.34, -0.44, -0.04, 0.0].map(|change| signed(change, 1)),
            ["+12.3", "−0.4", "0.0", "0.0"]
        );
    }

    #[test]
    fn a_number_in_a_message_parses_to_the_same_number() {
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
    fn displayed_values_have_six_digits_and_zeros_no_sign() {
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
}
