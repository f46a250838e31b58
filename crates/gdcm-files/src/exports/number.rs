//! Numbers in programs.

/// A finite number with 17 significant digits: it comes back to the last one in every language.
pub(super) fn number(value: f64) -> String {
    format!("{value:.16e}")
}

/// Numbers with commas between them.
pub(super) fn list(values: &[f64]) -> String {
    values.iter().map(|&value| number(value)).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_number_comes_back_to_the_last_digit(value in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL) {
            prop_assert_eq!(number(value).parse::<f64>().unwrap(), value);
        }
    }
}
