//! Check of user-defined limits.

/// A limit with its field name, for error messages.
pub(super) struct NamedNumber {
    pub(super) name: &'static str,
    pub(super) value: f64,
}

/// Returns the first limit that is not finite, or not above zero; absent limits are skipped.
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
