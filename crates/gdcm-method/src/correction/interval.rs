//! Interval for a single variable.

/// Interval `low <= u <= high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Interval {
    /// Returns the interval for `-u`.
    pub(crate) fn mirrored(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }

    /// Raises the upper end to the lower end if rounding has made the interval empty.
    pub(crate) fn not_empty(self) -> Self {
        Self {
            low: self.low,
            high: self.high.max(self.low),
        }
    }

    /// Returns the point in the interval nearest to `u`.
    pub(crate) fn nearest(self, u: f64) -> f64 {
        u.clamp(self.low, self.high)
    }

    pub(crate) fn width(self) -> f64 {
        self.high - self.low
    }
}
