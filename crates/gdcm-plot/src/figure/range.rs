//! A range on an axis, with the operations for margins, panning and zooming.

/// The part of an axis that a panel displays: `min <= max`, both finite except in [`Self::ALL`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub min: f64,
    pub max: f64,
}

impl Range {
    /// The whole real line, used as a range without limits.
    pub const ALL: Self = Self {
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
    };

    /// Creates the range between two ends, in either order.
    pub fn new(min: f64, max: f64) -> Self {
        Self {
            min: min.min(max),
            max: max.max(min),
        }
    }

    /// Returns the smallest range that contains every finite value; `None` if no value is finite.
    pub fn spanning(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut range = Self {
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
        };
        for value in values {
            if value.is_finite() {
                range.min = value.min(range.min);
                range.max = value.max(range.max);
            }
        }
        if range.min <= range.max {
            Some(range)
        } else {
            None
        }
    }

    /// Returns the distance between the ends.
    pub fn width(self) -> f64 {
        self.max - self.min
    }

    /// Returns the mean of both ends.
    pub fn middle(self) -> f64 {
        0.5 * (self.min + self.max)
    }

    /// Returns the smallest range that contains this range and `value`.
    pub fn including(self, value: f64) -> Self {
        Self {
            min: self.min.min(value),
            max: self.max.max(value),
        }
    }

    /// Returns the smallest range that contains both ranges.
    pub fn union(self, other: Self) -> Self {
        self.including(other.min).including(other.max)
    }

    /// Returns this range, extended by `fraction` of its width at both ends, and to a width of at
    /// least `least`; the middle is unchanged.
    pub fn with_margin(self, fraction: f64, least: f64) -> Self {
        let half = (0.5 * self.width() * (1.0 + 2.0 * fraction)).max(0.5 * least);
        Self {
            min: self.middle() - half,
            max: self.middle() + half,
        }
    }

    /// Returns this range with `by` added to both ends.
    pub fn moved(self, by: f64) -> Self {
        Self {
            min: self.min + by,
            max: self.max + by,
        }
    }

    /// Returns this range zoomed in by `factor` about the value `fixed`, which keeps its position
    /// on the axis.
    pub fn zoomed(self, factor: f64, fixed: f64) -> Self {
        if factor == 1.0 {
            // Without this exception, rounding would change the ends.
            return self;
        }
        Self {
            min: fixed + (self.min - fixed) / factor,
            max: fixed + (self.max - fixed) / factor,
        }
    }

    /// Returns this range if its width lies in `widths`, otherwise a range with the same middle and
    /// the nearest permitted width. `None` if the range is not finite.
    ///
    /// Prevents zooming and panning to widths at which floating-point values lose their precision.
    pub fn limited(self, widths: Self) -> Option<Self> {
        let width = self.width();
        let middle = self.middle();
        if !(width.is_finite() && middle.is_finite()) {
            return None;
        }
        let limited = width.clamp(widths.min, widths.max);
        if limited == width {
            return Some(self);
        }
        Some(Self {
            min: middle - 0.5 * limited,
            max: middle + 0.5 * limited,
        })
    }

    /// Returns whether `value` lies in the range, ends included.
    pub fn contains(self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_not_finite_do_not_count() {
        assert_eq!(
            Range::spanning([f64::NAN, 2.0, f64::NEG_INFINITY, -1.0]),
            Some(Range::new(-1.0, 2.0))
        );
        assert_eq!(Range::spanning([f64::NAN]), None);
    }

    #[test]
    fn zooming_keeps_the_fixed_value_in_its_place() {
        let zoomed = Range::new(0.0, 10.0).zoomed(2.0, 4.0);
        assert_eq!(zoomed, Range::new(2.0, 7.0));
    }

    #[test]
    fn a_range_of_no_width_gets_the_least_one() {
        assert_eq!(
            Range::new(3.0, 3.0).with_margin(0.05, 2.0),
            Range::new(2.0, 4.0)
        );
    }

    #[test]
    fn zooming_stops_at_the_limits() {
        let widths = Range::new(1.0, 100.0);
        let limited_width = |max: f64| Range::new(0.0, max).limited(widths).map(Range::width);
        assert_eq!(limited_width(1e9), Some(100.0));
        assert_eq!(limited_width(1e-9), Some(1.0));
        let undefined = Range {
            min: f64::NAN,
            max: 1.0,
        };
        assert_eq!(undefined.limited(widths), None);
    }
}
