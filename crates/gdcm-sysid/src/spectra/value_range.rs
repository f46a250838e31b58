//! A channel's minimum and maximum.

/// A channel's minimum and maximum; infinity and minus infinity without values.
pub(crate) struct ValueRange {
    pub(crate) least: f64,
    pub(crate) greatest: f64,
}

impl ValueRange {
    pub(crate) fn new(values: &[f64]) -> Self {
        let mut range = Self {
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
        };
        for value in values {
            range.least = range.least.min(*value);
            range.greatest = range.greatest.max(*value);
        }
        range
    }
}
