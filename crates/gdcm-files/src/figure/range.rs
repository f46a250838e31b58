//! The part of an axis that is in view.

/// The part of an axis that is in view: finite, `min < max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub min: f64,
    /// Upper end.
    pub max: f64,
}

impl Range {
    /// Every value.
    pub const ALL: Self = Self { min: f64::NEG_INFINITY, max: f64::INFINITY };

    /// The range from `min` to `max`, which need not be in order.
    pub fn new(min: f64, max: f64) -> Self {
        Self { min: min.min(max), max: max.max(min) }
    }

    /// The least range that holds every finite value, or nothing where there is none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let empty = (f64::INFINITY, f64::NEG_INFINITY);
        let finite = values.into_iter().filter(|value| value.is_finite());
        let (min, max) = finite.fold(empty, |(min, max), value| (value.min(min), value.max(max)));
        (min <= max).then_some(Self { min, max })
    }

    /// Upper end minus lower end.
    pub fn width(self) -> f64 {
        self.max - self.min
    }

    /// The value halfway.
    pub fn middle(self) -> f64 {
        0.5 * (self.min + self.max)
    }

    /// The least range that holds this one and `value`.
    pub fn including(self, value: f64) -> Self {
        Self { min: self.min.min(value), max: self.max.max(value) }
    }

    /// This range with `fraction` of its width added on either side, and at least as wide as `least`.
    pub fn with_margin(self, fraction: f64, least: f64) -> Self {
        let half = (0.5 * self.width() * (1.0 + 2.0 * fraction)).max(0.5 * least);
        Self { min: self.middle() - half, max: self.middle() + half }
    }

    /// This range with `by` added to both ends.
    pub fn moved(self, by: f64) -> Self {
        Self { min: self.min + by, max: self.max + by }
    }

    /// This range seen `factor` times closer, with `fixed` staying where it is.
    pub fn zoomed(self, factor: f64, fixed: f64) -> Self {
        if factor == 1.0 {
            // To the last digit.
            return self;
        }
        Self { min: fixed + (self.min - fixed) / factor, max: fixed + (self.max - fixed) / factor }
    }

    /// This range where its width lies in `widths`, else the nearest range about the same middle whose width does.
    ///
    /// Keeps zooming and panning away from where numbers lose their meaning; a range that is not finite gives nothing.
    pub fn limited(self, widths: Self) -> Option<Self> {
        let (width, middle) = (self.width(), self.middle());
        if !(width.is_finite() && middle.is_finite()) {
            return None;
        }
        let limited = width.clamp(widths.min, widths.max);
        Some(if limited == width { self } else { Self { min: middle - 0.5 * limited, max: middle + 0.5 * limited } })
    }

    /// Whether `value` lies in the range, ends included.
    pub fn contains(self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_not_finite_do_not_count() {
        assert_eq!(Range::of([f64::NAN, 2.0, f64::NEG_INFINITY, -1.0]), Some(Range::new(-1.0, 2.0)));
        assert_eq!(Range::of([f64::NAN]), None);
    }

    #[test]
    fn zooming_keeps_the_fixed_value_in_its_place() {
        let zoomed = Range::new(0.0, 10.0).zoomed(2.0, 4.0);
        assert_eq!(zoomed, Range::new(2.0, 7.0));
    }

    #[test]
    fn a_range_of_no_width_gets_the_least_one() {
        assert_eq!(Range::new(3.0, 3.0).with_margin(0.05, 2.0), Range::new(2.0, 4.0));
    }

    #[test]
    fn zooming_stops_at_the_limits() {
        let widths = Range::new(1.0, 100.0);
        assert_eq!(Range::new(0.0, 1e9).limited(widths).map(Range::width), Some(100.0));
        assert_eq!(Range::new(0.0, 1e-9).limited(widths).map(Range::width), Some(1.0));
        assert_eq!(Range { min: f64::NAN, max: 1.0 }.limited(widths), None);
    }
}
