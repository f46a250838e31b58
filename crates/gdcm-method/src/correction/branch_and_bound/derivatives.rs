//! Value, slope and curvature at a point, and their range over an interval.

use super::rounded::Rounded;

/// A function's value and slope at a point, with bounds on their rounding errors, and its
/// curvature.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Derivatives {
    pub(crate) value: Rounded,
    pub(crate) slope: Rounded,
    pub(crate) curvature: f64,
}

impl Derivatives {
    /// Adds `f(-u)` to this function of `u`. `mirrored` holds `f` and its derivatives with respect
    /// to its own argument `-u`, so that its slope changes sign.
    pub(super) fn plus_mirrored(self, mirrored: Self) -> Self {
        let mut value = self.value;
        value.add(mirrored.value);
        let mut slope = self.slope;
        slope.add(-mirrored.slope);
        Self {
            value,
            slope,
            curvature: self.curvature + mirrored.curvature,
        }
    }
}

/// A derivative's minimum and maximum over an interval, rounded outward.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Range {
    pub(crate) least: f64,
    pub(crate) most: f64,
    /// Bound on the summands' magnitudes, added up; the rounding errors are proportional to it.
    pub(crate) size: f64,
}
