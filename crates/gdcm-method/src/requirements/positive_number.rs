//! Check of user-defined limits.

/// A number with the field name that a message cites.
pub(super) struct NamedNumber {
    pub(super) name: &'static str,
    pub(super) value: f64,
}

/// Returns the first number that is not finite, or not above zero; absent numbers are skipped.
pub(super) fn first_not_positive<const N: usize>(
    numbers: [(&'static str, Option<f64>); N],
) -> Option<NamedNumber> {
    for (name, number) in numbers {
        let Some(value) = number else { continue };
        if !value.is_finite() || value <= 0.0 {
            return Some(NamedNumber { name, value });
        }
    }
    None
}
