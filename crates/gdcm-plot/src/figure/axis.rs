//! A panel's axis: its quantity and unit, its scale, the range shown, and its ticks.

pub use super::display_units::{FrequencyUnit, MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
pub use super::range::Range;
pub use super::ticks::{Scale, Tick, TickGaps, step_above, ticks_of};

/// Margin at both ends of a fitted range, relative to its width.
const MARGIN: f64 = 0.05;
/// Range shown if an axis has no values.
const EMPTY: Range = Range {
    min: 1.0,
    max: 10.0,
};

/// An axis: its quantity with the unit, its scale, and the range shown.
///
/// If `range` is `None`, the panel fits the range to its marks
/// ([`Panel::shown`](super::figure::Panel::shown)), extended by `including` and `least`.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit: `Frequency [rad/s]`.
    pub label: String,
    pub scale: Scale,
    /// Displayed range; fitted to the marks if `None`.
    pub range: Option<Range>,
    /// Values that a fitted range must contain.
    pub including: Vec<f64>,
    /// Minimum width for a fitted linear range, in the axis unit.
    pub least: f64,
    /// Positions with names, which replace the numeric ticks.
    pub names: Option<Vec<(f64, String)>>,
}

impl Axis {
    fn new(label: impl Into<String>, scale: Scale) -> Self {
        Self {
            label: label.into(),
            scale,
            range: None,
            including: Vec::new(),
            least: 0.0,
            names: None,
        }
    }

    /// Creates an axis with decimal ticks.
    pub fn linear(label: impl Into<String>) -> Self {
        Self::new(label, Scale::Linear)
    }

    /// Creates an axis for angles \[deg\].
    pub fn degrees(label: impl Into<String>) -> Self {
        Self::new(label, Scale::Degrees)
    }

    /// Creates a logarithmic axis, which does not show nonpositive values.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self::new(label, Scale::Logarithmic)
    }

    /// Creates an axis with names at 0, 1, 2, …; its range extends half a step beyond the first and
    /// the last name.
    pub fn named(
        label: impl Into<String>,
        names: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        let names: Vec<(f64, String)> = names
            .into_iter()
            .enumerate()
            .map(|(at, name)| (at as f64, name.into()))
            .collect();
        let range = Range::new(-0.5, (names.len() as f64 - 0.5).max(0.5));
        Self {
            names: Some(names),
            range: Some(range),
            ..Self::new(label, Scale::Linear)
        }
    }

    /// Returns the axis with this range; unchanged if `None`.
    pub fn showing(self, range: Option<Range>) -> Self {
        Self {
            range: range.or(self.range),
            ..self
        }
    }

    /// Returns the axis with a fitted range that contains `value`.
    pub fn including(mut self, value: f64) -> Self {
        self.including.push(value);
        self
    }

    /// Returns the axis with a minimum width for a fitted linear range, in the axis unit.
    pub fn at_least(self, least: f64) -> Self {
        Self { least, ..self }
    }

    /// Returns the fixed range if there is one, otherwise a range fitted to `values` and
    /// `including`: with a margin on a linear axis, without one on a logarithmic axis, where a
    /// single value is shown in a range from half to twice its size. Values that the axis cannot
    /// show are skipped.
    pub(super) fn fitted(&self, values: impl Iterator<Item = f64>) -> Range {
        if let Some(range) = self.range {
            return range;
        }
        let shown = values
            .chain(self.including.iter().copied())
            .filter(|value| self.can_show(*value));
        let range = Range::spanning(shown).unwrap_or(EMPTY);
        match self.scale {
            Scale::Logarithmic if range.min < range.max => range,
            Scale::Logarithmic => Range::new(range.min / 2.0, range.max * 2.0),
            Scale::Linear | Scale::Degrees => {
                // By default, equal values are shown in a range as wide as a thousandth of their
                // size.
                let least = if self.least > 0.0 {
                    self.least
                } else {
                    1e-3 * range.middle().abs().max(1e-6)
                };
                range.with_margin(MARGIN, least)
            }
        }
    }

    /// Returns whether a value can be drawn on the axis.
    fn can_show(&self, value: f64) -> bool {
        value.is_finite() && (self.scale != Scale::Logarithmic || value > 0.0)
    }

    /// Returns a value's position along the axis: 0 at the lower end of `range`, 1 at the upper
    /// end; `None` if the axis cannot show the value.
    pub(super) fn fraction(&self, value: f64, range: Range) -> Option<f64> {
        if !self.can_show(value) {
            return None;
        }
        let low = self.place(range.min);
        let high = self.place(range.max);
        Some((self.place(value) - low) / (high - low))
    }

    /// Returns the coordinate along the axis: the value on a linear axis, its logarithm on a
    /// logarithmic axis.
    fn place(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Logarithmic => value.log10(),
            Scale::Linear | Scale::Degrees => value,
        }
    }

    /// Returns the ticks of `range` on an axis `length_pt` long, with labels at least `gap_pt`
    /// apart.
    pub(super) fn ticks(&self, range: Range, length_pt: f64, gap_pt: f64) -> Vec<Tick> {
        match &self.names {
            Some(names) => name_ticks(names, range, length_pt, gap_pt),
            None => {
                let gaps = TickGaps {
                    labels: gap_pt,
                    equal_steps: gap_pt,
                    lines: 0.0,
                };
                ticks_of(self.scale, range, length_pt, gaps)
            }
        }
    }
}

/// Returns a tick for each name in `range`, or for every n-th name if the ticks would otherwise be
/// too close.
fn name_ticks(names: &[(f64, String)], range: Range, length_pt: f64, gap_pt: f64) -> Vec<Tick> {
    let apart_pt = length_pt / range.width();
    let every = (gap_pt / apart_pt).ceil().max(1.0) as usize;
    names
        .iter()
        .filter(|(at, _)| range.contains(*at))
        .step_by(every)
        .map(|(at, name)| Tick::labelled(*at, name.clone()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decade_is_as_long_as_another_on_a_logarithmic_axis() {
        let axis = Axis::logarithmic("Frequency [rad/s]");
        let range = Range::new(0.1, 10.0);
        assert_eq!(axis.fraction(0.1, range), Some(0.0));
        assert!((axis.fraction(1.0, range).unwrap() - 0.5).abs() < 1e-15);
        assert_eq!(axis.fraction(-1.0, range), None);
        assert_eq!(axis.fraction(0.0, range), None);
    }

    #[test]
    fn a_fitted_range_includes_given_values_and_has_at_least_the_given_width() {
        let axis = Axis::linear("Gain [-]").including(1.0).at_least(0.5);
        let fitted = axis.fitted([1.2, f64::NAN].into_iter());
        assert!(
            fitted.contains(1.0) && fitted.contains(1.2) && (fitted.width() - 0.5).abs() < 1e-12
        );
        assert_eq!(
            axis.showing(Some(Range::new(0.0, 2.0)))
                .fitted([5.0].into_iter()),
            Range::new(0.0, 2.0)
        );
    }

    #[test]
    fn an_axis_without_values_still_has_a_range() {
        assert!(Axis::linear("").fitted(std::iter::empty()).width() > 0.0);
        assert!(Axis::logarithmic("").fitted([2.0].into_iter()).width() > 0.0);
    }

    fn labels(axis: &Axis, range: Range, length_pt: f64) -> Vec<String> {
        axis.ticks(range, length_pt, 14.0)
            .into_iter()
            .filter_map(|tick| tick.label)
            .collect()
    }

    #[test]
    fn a_band_of_comparison_is_labelled_at_one_two_and_five() {
        let axis = Axis::logarithmic("Frequency [rad/s]");
        assert_eq!(
            labels(&axis, Range::new(0.3, 20.4), 130.0),
            ["0.5", "1", "2", "5", "10", "20"]
        );
        assert_eq!(labels(&axis, Range::new(0.3, 20.4), 60.0), ["1", "10"]);
        let minor = axis
            .ticks(Range::new(1.0, 10.0), 60.0, 14.0)
            .into_iter()
            .filter(|tick| tick.label.is_none());
        assert_eq!(minor.count(), 6, "3, 4, 6, 7, 8 and 9");
    }

    #[test]
    fn a_small_part_of_a_decade_has_equal_steps() {
        let axis = Axis::logarithmic("Frequency [rad/s]");
        assert_eq!(
            labels(&axis, Range::new(1.9, 3.1), 130.0),
            ["2", "2.2", "2.4", "2.6", "2.8", "3"]
        );
    }

    #[test]
    fn phases_have_ticks_at_parts_of_a_turn_and_magnitudes_at_round_numbers() {
        assert_eq!(
            labels(&Axis::degrees(""), Range::new(-200.0, 10.0), 60.0),
            ["−180", "−120", "−60", "0"]
        );
        assert_eq!(
            labels(&Axis::linear(""), Range::new(-26.0, 10.0), 60.0),
            ["−20", "−10", "0", "10"]
        );
    }

    #[test]
    fn names_without_room_are_thinned_evenly() {
        let axis = Axis::named("Condition", (1..=11).map(|id| id.to_string()));
        let range = axis.fitted(std::iter::empty());
        assert_eq!(labels(&axis, range, 160.0).len(), 11);
        assert_eq!(labels(&axis, range, 80.0), ["1", "3", "5", "7", "9", "11"]);
    }
}
