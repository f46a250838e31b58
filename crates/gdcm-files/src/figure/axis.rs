//! An axis of a panel: what is along it, and which part of it is shown.

/// Space on either side of what is shown, as a part of its width.
const MARGIN: f64 = 0.05;

/// How values lie along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// In proportion, with ticks at 1, 2, 5 times a power of ten.
    Linear,
    /// In proportion, with ticks at parts of a turn.
    Degrees,
    /// By their logarithm.
    Logarithmic,
}

/// An axis: its quantity with the unit, its scale, and the part that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit: `Frequency [rad/s]`.
    pub label: String,
    /// How values lie along it.
    pub scale: Scale,
    /// The part shown; what holds all marks, where none is given.
    pub range: Option<Range>,
    /// Values that are shown in any case.
    pub including: Vec<f64>,
    /// The least width shown, in the axis' unit.
    pub least: f64,
    /// Names at places, in place of ticks with numbers.
    pub names: Option<Vec<(f64, String)>>,
}

impl Axis {
    fn new(label: impl Into<String>, scale: Scale) -> Self {
        Self { label: label.into(), scale, range: None, including: Vec::new(), least: 0.0, names: None }
    }

    /// An axis of decimal ticks.
    pub fn linear(label: impl Into<String>) -> Self {
        Self::new(label, Scale::Linear)
    }

    /// An axis of angles \[deg\].
    pub fn degrees(label: impl Into<String>) -> Self {
        Self::new(label, Scale::Degrees)
    }

    /// A logarithmic axis; values that are not positive are not shown.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self::new(label, Scale::Logarithmic)
    }

    /// An axis of named places, the first at 0, the others at whole numbers from there.
    pub fn named(label: impl Into<String>, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let names: Vec<_> = names.into_iter().enumerate().map(|(at, name)| (at as f64, name.into())).collect();
        let range = Range::new(-0.5, (names.len() as f64 - 0.5).max(0.5));
        Self { names: Some(names), range: Some(range), ..Self::new(label, Scale::Linear) }
    }

    /// The same axis that shows exactly this part.
    pub fn showing(self, range: Option<Range>) -> Self {
        Self { range: range.or(self.range), ..self }
    }

    /// The same axis that shows `value` too.
    pub fn including(mut self, value: f64) -> Self {
        self.including.push(value);
        self
    }

    /// The same axis that shows at least this width, in its unit.
    pub fn at_least(self, least: f64) -> Self {
        Self { least, ..self }
    }

    /// The part that shows `values`, where none is given: on a logarithmic axis exactly those, else with some space around.
    pub(super) fn fitted(&self, values: impl Iterator<Item = f64>) -> Range {
        if let Some(range) = self.range {
            return range;
        }
        let shown = values.chain(self.including.iter().copied()).filter(|value| self.can_show(*value));
        let range = Range::of(shown).unwrap_or(Range::new(1.0, 10.0));
        match self.scale {
            Scale::Logarithmic if range.min < range.max => range,
            Scale::Logarithmic => Range::new(range.min / 2.0, range.max * 2.0),
            Scale::Linear | Scale::Degrees => {
                let least = if self.least > 0.0 { self.least } else { 1e-3 * range.middle().abs().max(1e-6) };
                range.with_margin(MARGIN, least)
            }
        }
    }

    /// Whether a value has a place on the axis.
    pub(super) fn can_show(&self, value: f64) -> bool {
        value.is_finite() && (self.scale != Scale::Logarithmic || value > 0.0)
    }

    /// Where a value is along the axis: 0 at the lower end of `range`, 1 at the upper; nowhere for what cannot be shown.
    pub(super) fn fraction(&self, value: f64, range: Range) -> Option<f64> {
        let place = |value: f64| match self.scale {
            Scale::Logarithmic => value.log10(),
            Scale::Linear | Scale::Degrees => value,
        };
        let (low, high) = (place(range.min), place(range.max));
        self.can_show(value).then(|| (place(value) - low) / (high - low))
    }
}

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

    /// The least range that holds both.
    pub fn union(self, other: Self) -> Self {
        self.including(other.min).including(other.max)
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
    fn a_decade_is_as_long_as_another_on_a_logarithmic_axis() {
        let (axis, range) = (Axis::logarithmic("Frequency [rad/s]"), Range::new(0.1, 10.0));
        assert_eq!(axis.fraction(0.1, range), Some(0.0));
        assert!((axis.fraction(1.0, range).unwrap() - 0.5).abs() < 1e-15);
        assert_eq!(axis.fraction(-1.0, range), None);
        assert_eq!(axis.fraction(0.0, range), None);
    }

    #[test]
    fn an_axis_shows_what_it_has_to_and_no_less_than_its_least_width() {
        let axis = Axis::linear("Gain [-]").including(1.0).at_least(0.5);
        let fitted = axis.fitted([1.2, f64::NAN].into_iter());
        assert!(fitted.contains(1.0) && fitted.contains(1.2) && (fitted.width() - 0.5).abs() < 1e-12);
        assert_eq!(axis.showing(Some(Range::new(0.0, 2.0))).fitted([5.0].into_iter()), Range::new(0.0, 2.0));
    }

    #[test]
    fn an_axis_without_values_still_has_a_range() {
        assert!(Axis::linear("").fitted(std::iter::empty()).width() > 0.0);
        assert!(Axis::logarithmic("").fitted([2.0].into_iter()).width() > 0.0);
    }
}

#[cfg(test)]
mod tests2 {
    use super::super::axis::*;

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
