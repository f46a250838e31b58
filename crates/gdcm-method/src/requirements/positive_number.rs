//! Checks user-defined limits.

/// A limit with its field name, for error messages.
pub(super) struct NamedLimit {
    pub(super) name: &'static str,
    /// `None` if the user gives no such limit.
    pub(super) value: Option<f64>,
}

/// A limit that is not finite, or not above zero.
pub(super) struct WrongLimit {
    pub(super) name: &'static str,
    pub(super) value: f64,
}

/// Returns the first limit that is not finite, or not above zero; absent limits are skipped.
pub(super) fn first_not_positive(limits: &[NamedLimit]) -> Option<WrongLimit> {
    for limit in limits {
        let Some(value) = limit.value else { continue };
        if !value.is_finite() || value <= 0.0 {
            return Some(WrongLimit {
                name: limit.name,
                value,
            });
        }
    }
    None
}
