//! Numbers as ticks and readouts show them.

/// The shortest text of `value` to six significant digits, without trailing zeros, with a true minus sign.
pub fn compact(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    let decimals = (5 - value.abs().log10().floor() as i64).clamp(0, 12) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    signed(text)
}

/// `value` with so many decimals, with a true minus sign.
pub fn decimals(value: f64, count: usize) -> String {
    signed(&format!("{value:.count$}"))
}

/// A value that rounds to zero has no sign; a negative one has a minus sign, as wide as a plus, instead of a hyphen.
fn signed(text: &str) -> String {
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
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!(decimals(-0.04, 1), "0.0");
        assert_eq!(decimals(-0.06, 1), "\u{2212}0.1");
    }
}
