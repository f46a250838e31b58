//! Numbers as text at ticks and in captions.

/// Formats `value` with up to six significant digits and twelve decimals, without trailing zeros,
/// with a true minus sign.
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
    with_true_minus(text)
}

/// Formats `value` with `count` decimals and a true minus sign.
pub fn decimals(value: f64, count: usize) -> String {
    with_true_minus(&format!("{value:.count$}"))
}

/// Formats `value` with three significant digits; below 1, with three decimals.
pub(super) fn three_digits(value: f64) -> String {
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 3.0) as usize;
    format!("{value:.decimals$}")
}

/// Replaces the hyphen before a number by a minus sign, as wide as a plus, and drops it before a
/// number that rounds to zero.
fn with_true_minus(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| matches!(c, '0' | '.')) => digits.to_owned(),
        Some(digits) => format!("\u{2212}{digits}"),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_no_more_digits_than_they_need() {
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
    fn a_number_that_rounds_to_zero_has_no_sign() {
        assert_eq!(decimals(-0.04, 1), "0.0");
        assert_eq!(decimals(-0.06, 1), "\u{2212}0.1");
    }
}
