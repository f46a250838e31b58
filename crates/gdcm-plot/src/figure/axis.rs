//! An axis of a panel: its quantity and unit, the range shown, its ticks and labels.

use serde::{Deserialize, Serialize};

use gdcm_model::number_format::compact;
use gdcm_model::units::rad_s_to_hz;

/// Margin on either side of the shown values, as a fraction of their range.
const MARGIN: f64 = 0.05;

/// Mapping of values to positions along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Linear, with ticks at 1, 2 and 5 times a power of ten.
    Linear,
    /// Linear, with ticks at fractions of a turn.
    Degrees,
    Logarithmic,
}

/// An axis: its quantity with the unit, its scale, and its visible range.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit: `Frequency [rad/s]`.
    pub label: String,
    pub scale: Scale,
    /// The range shown; fitted to all marks if `None`.
    pub range: Option<Range>,
    /// Values that are always shown.
    pub including: Vec<f64>,
    /// Minimum width shown, in the unit of the axis.
    pub least: f64,
    /// Names at places, instead of numeric ticks.
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

    /// Creates an axis of angles \[deg\].
    pub fn degrees(label: impl Into<String>) -> Self {
        Self::new(label, Scale::Degrees)
    }

    /// Creates a logarithmic axis, which does not show nonpositive values.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self::new(label, Scale::Logarithmic)
    }

    /// Creates an axis of named places at 0, 1, 2, …
    pub fn named(
        label: impl Into<String>,
        names: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        let names: Vec<_> = names
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

    /// Returns the axis with exactly this range shown.
    pub fn showing(self, range: Option<Range>) -> Self {
        Self {
            range: range.or(self.range),
            ..self
        }
    }

    /// Returns the axis with `value` always shown.
    pub fn including(mut self, value: f64) -> Self {
        self.including.push(value);
        self
    }

    /// Returns the axis with at least this width shown, in its unit.
    pub fn at_least(self, least: f64) -> Self {
        Self { least, ..self }
    }

    /// Returns the range that shows `values`, unless one is given: exact on a logarithmic axis,
    /// otherwise with a margin.
    pub(super) fn fitted(&self, values: impl Iterator<Item = f64>) -> Range {
        if let Some(range) = self.range {
            return range;
        }
        let shown = values
            .chain(self.including.iter().copied())
            .filter(|value| self.can_show(*value));
        let range = Range::of(shown).unwrap_or(Range::new(1.0, 10.0));
        match self.scale {
            Scale::Logarithmic if range.min < range.max => range,
            Scale::Logarithmic => Range::new(range.min / 2.0, range.max * 2.0),
            Scale::Linear | Scale::Degrees => {
                let least = if self.least > 0.0 {
                    self.least
                } else {
                    1e-3 * range.middle().abs().max(1e-6)
                };
                range.with_margin(MARGIN, least)
            }
        }
    }

    /// Returns whether the axis can show a value.
    pub(super) fn can_show(&self, value: f64) -> bool {
        value.is_finite() && (self.scale != Scale::Logarithmic || value > 0.0)
    }

    /// Returns the position of a value along the axis: 0 at the lower end of `range`, 1 at the
    /// upper; `None` if the value cannot be shown.
    pub(super) fn fraction(&self, value: f64, range: Range) -> Option<f64> {
        let place = |value: f64| match self.scale {
            Scale::Logarithmic => value.log10(),
            Scale::Linear | Scale::Degrees => value,
        };
        let low = place(range.min);
        let high = place(range.max);
        self.can_show(value)
            .then(|| (place(value) - low) / (high - low))
    }
}

/// The visible range of an axis: finite, `min < max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub min: f64,
    pub max: f64,
}

impl Range {
    /// Every value.
    pub const ALL: Self = Self {
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
    };

    /// Creates the range between `min` and `max`, in either order.
    pub fn new(min: f64, max: f64) -> Self {
        Self {
            min: min.min(max),
            max: max.max(min),
        }
    }

    /// Returns the smallest range with every finite value, or `None` if there is none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let empty = (f64::INFINITY, f64::NEG_INFINITY);
        let finite = values.into_iter().filter(|value| value.is_finite());
        let (min, max) = finite.fold(empty, |(min, max), value| (value.min(min), value.max(max)));
        (min <= max).then_some(Self { min, max })
    }

    /// Returns the upper end minus the lower end.
    pub fn width(self) -> f64 {
        self.max - self.min
    }

    /// Returns the centre.
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

    /// Returns the smallest range that contains both.
    pub fn union(self, other: Self) -> Self {
        self.including(other.min).including(other.max)
    }

    /// Returns this range with `fraction` of its width added on either side, and at least as wide
    /// as `least`.
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

    /// Returns this range magnified `factor` times, with `fixed` staying in place.
    pub fn zoomed(self, factor: f64, fixed: f64) -> Self {
        if factor == 1.0 {
            // Exact, without rounding.
            return self;
        }
        Self {
            min: fixed + (self.min - fixed) / factor,
            max: fixed + (self.max - fixed) / factor,
        }
    }

    /// Returns this range if its width lies in `widths`, otherwise the nearest range with the same
    /// centre whose width does.
    ///
    /// Keeps zooming and panning away from widths at which numbers lose their meaning; returns
    /// `None` for a range that is not finite.
    pub fn limited(self, widths: Self) -> Option<Self> {
        let width = self.width();
        let middle = self.middle();
        if !(width.is_finite() && middle.is_finite()) {
            return None;
        }
        let limited = width.clamp(widths.min, widths.max);
        Some(if limited == width {
            self
        } else {
            Self {
                min: middle - 0.5 * limited,
                max: middle + 0.5 * limited,
            }
        })
    }

    /// Returns whether `value` lies in the range, ends included.
    pub fn contains(self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}

/// Below this width \[decades\], equal steps may be labelled instead of parts of a decade.
const LINEAR_BELOW: f64 = 0.9;
/// Degrees between ticks, from about 1° up; below that, decimal steps.
const DEGREE_STEPS: [f64; 13] = [
    5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0, 180.0, 360.0, 720.0, 1800.0, 3600.0, 7200.0,
];

/// A tick on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    /// Label; `None` for a minor tick.
    pub label: Option<String>,
}

/// Minimum distances between ticks of an axis \[pt\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickGaps {
    /// Between labels.
    pub labels: f64,
    /// Between labels at equal steps instead of parts of a decade.
    pub equal_steps: f64,
    /// Between grid lines within a decade.
    pub lines: f64,
}

/// Distance from 9 to 10, the narrowest gap between the lines of a decade \[decades\].
const NINE_TO_TEN: f64 = 0.045_757_490_560_675_115;
/// Minimum distance between labels if all nine of a decade are labelled \[pt\]: a row of many close
/// numbers is hard to read.
const NINE_LABELS_GAP: f64 = 44.0;

/// Returns the ticks of `axis` for `range` shown on `length_pt`, with labels at least `gap_pt`
/// apart.
pub(super) fn ticks(axis: &Axis, range: Range, length_pt: f64, gap_pt: f64) -> Vec<Tick> {
    if let Some(names) = &axis.names {
        let shown: Vec<_> = names.iter().filter(|(at, _)| range.contains(*at)).collect();
        let apart = length_pt / range.width();
        let every = (gap_pt / apart).ceil().max(1.0) as usize;
        return shown
            .into_iter()
            .step_by(every)
            .map(|(at, name)| labelled(*at, name.clone()))
            .collect();
    }
    ticks_of(
        axis.scale,
        range,
        length_pt,
        TickGaps {
            labels: gap_pt,
            equal_steps: gap_pt,
            lines: 0.0,
        },
    )
}

/// Returns the ticks of a numeric axis for `range` shown on `length_pt`.
pub fn ticks_of(scale: Scale, range: Range, length_pt: f64, gaps: TickGaps) -> Vec<Tick> {
    let least = gaps.labels * range.width() / length_pt;
    match scale {
        Scale::Linear => equal_steps(range, step_above(least)),
        Scale::Degrees => equal_steps(range, degree_step(least)),
        Scale::Logarithmic => decades(range, length_pt, gaps),
    }
}

fn labelled(value: f64, label: String) -> Tick {
    Tick {
        value,
        label: Some(label),
    }
}

fn equal_steps(range: Range, step: f64) -> Vec<Tick> {
    let slack = 1e-6;
    let indices =
        (range.min / step - slack).ceil() as i64..=(range.max / step + slack).floor() as i64;
    indices
        .map(|k| k as f64 * step)
        .map(|value| labelled(value, compact(value)))
        .collect()
}

/// Returns the smallest fraction of a turn \[deg\] that is at least `least`.
pub fn degree_step(least: f64) -> f64 {
    match DEGREE_STEPS.into_iter().find(|step| *step >= least) {
        Some(step) if least > 2.0 => step,
        _ => step_above(least),
    }
}

/// Returns the smallest of 1, 2 and 5 times a power of ten that is at least `least`.
pub fn step_above(least: f64) -> f64 {
    if !(least > 0.0 && least.is_finite()) {
        return 1.0;
    }
    let power = 10f64.powf(least.log10().floor());
    // A step that should be round may exceed itself by a rounding error.
    let fits = |factor: f64| factor * power >= least * (1.0 - 1e-9);
    let factor = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|factor| fits(*factor))
        .unwrap_or(10.0);
    factor * power
}

/// Returns ticks at 1 to 9 of each decade, labelled at 1, 2 and 5 or at the decades, whichever
/// fits; for a small part of a decade, equal steps.
fn decades(range: Range, length_pt: f64, gaps: TickGaps) -> Vec<Tick> {
    let low = range.min.log10();
    let high = range.max.log10();
    let decade_pt = length_pt / (high - low);
    let has_two_and_five = decade_pt * 2f64.log10() >= gaps.labels;
    let has_nine = decade_pt * NINE_TO_TEN >= NINE_LABELS_GAP;
    let has_lines = decade_pt * NINE_TO_TEN >= gaps.lines;
    let every = (gaps.labels / decade_pt).ceil().max(1.0) as i64;
    let slack = 1e-9 * (1.0 + high - low);
    let is_labelled = |mantissa: u8, exponent: i64| match mantissa {
        1 => exponent.rem_euclid(every) == 0,
        2 | 5 => has_two_and_five,
        _ => has_nine,
    };
    let is_drawn =
        |mantissa: u8, exponent: i64| has_lines || mantissa == 1 || is_labelled(mantissa, exponent);
    let all = (low.floor() as i64..=high.floor() as i64)
        .flat_map(|exponent| (1..=9u8).map(move |mantissa| (mantissa, exponent)))
        .filter(|(mantissa, exponent)| is_drawn(*mantissa, *exponent))
        .map(|(mantissa, exponent)| {
            (
                mantissa,
                exponent,
                f64::from(mantissa) * 10f64.powi(exponent as i32),
            )
        })
        .filter(|(.., value)| (low - slack..=high + slack).contains(&value.log10()));
    let ticks: Vec<Tick> = all
        .map(|(mantissa, exponent, value)| Tick {
            value,
            label: is_labelled(mantissa, exponent).then(|| compact(value)),
        })
        .collect();
    let count = ticks.iter().filter(|tick| tick.label.is_some()).count();
    // Equal steps are closest at the upper end.
    let linear = equal_steps(
        range,
        step_above(gaps.equal_steps * range.max * std::f64::consts::LN_10 / decade_pt),
    );
    if high - low < LINEAR_BELOW && linear.len() > count {
        linear
    } else {
        ticks
    }
}

/// Unit of displayed frequencies; internally they are always rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum FrequencyUnit {
    /// Angular frequency.
    #[default]
    RadPerSecond,
    /// Cycles per second.
    Hertz,
}

impl FrequencyUnit {
    /// The symbol of the unit.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::RadPerSecond => "rad/s",
            Self::Hertz => "Hz",
        }
    }

    /// Converts the angular frequency `omega` \[rad/s\] to this unit.
    pub fn of_omega(self, omega: f64) -> f64 {
        match self {
            Self::RadPerSecond => omega,
            Self::Hertz => rad_s_to_hz(omega),
        }
    }

    /// Formats an angular frequency with its symbol and unit: "ω 2.05 rad/s" or "f 0.326 Hz".
    pub fn readout(self, omega: f64) -> String {
        let quantity = match self {
            Self::RadPerSecond => "ω",
            Self::Hertz => "f",
        };
        format!(
            "{quantity} {} {}",
            three_digits(self.of_omega(omega)),
            self.symbol()
        )
    }

    /// Label of the axis.
    pub fn axis_label(self) -> String {
        format!("Frequency [{}]", self.symbol())
    }
}

/// Unit of the magnitude of a response.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum MagnitudeUnit {
    #[default]
    Decibel,
    /// Ratio of output to input, in their units.
    Ratio,
}

/// Representation of the phase of a response.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PhaseUnit {
    /// Continuous over frequency (M2).
    #[default]
    Unwrapped,
    /// Between −180° and 180°.
    Wrapped,
}

/// Representation of a phase error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PhaseErrorUnit {
    /// Δφ.
    #[default]
    Degree,
    /// Δφ/ω: the equivalent delay.
    Millisecond,
}

/// Formats three significant digits; below 1, three decimals.
fn three_digits(value: f64) -> String {
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 3.0) as usize;
    format!("{value:.decimals$}")
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
    fn an_axis_shows_what_it_has_to_and_no_less_than_its_least_width() {
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

    #[test]
    fn values_that_are_not_finite_do_not_count() {
        assert_eq!(
            Range::of([f64::NAN, 2.0, f64::NEG_INFINITY, -1.0]),
            Some(Range::new(-1.0, 2.0))
        );
        assert_eq!(Range::of([f64::NAN]), None);
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
        assert_eq!(
            Range::new(0.0, 1e9).limited(widths).map(Range::width),
            Some(100.0)
        );
        assert_eq!(
            Range::new(0.0, 1e-9).limited(widths).map(Range::width),
            Some(1.0)
        );
        assert_eq!(
            Range {
                min: f64::NAN,
                max: 1.0
            }
            .limited(widths),
            None
        );
    }

    fn labels(axis: &Axis, range: Range, length_pt: f64) -> Vec<String> {
        ticks(axis, range, length_pt, 14.0)
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
        let minor = ticks(&axis, Range::new(1.0, 10.0), 60.0, 14.0)
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
    fn names_stand_at_their_places_and_are_thinned_where_they_have_no_room() {
        let axis = Axis::named("Condition", (1..=11).map(|id| id.to_string()));
        let range = axis.fitted(std::iter::empty());
        assert_eq!(labels(&axis, range, 160.0).len(), 11);
        assert_eq!(labels(&axis, range, 80.0), ["1", "3", "5", "7", "9", "11"]);
    }

    #[test]
    fn a_step_is_the_next_round_number() {
        for (least, step) in [
            (0.011, 0.02),
            (0.2, 0.2),
            (3.0, 5.0),
            (6.0, 10.0),
            (1e-7, 1e-7),
        ] {
            assert!(
                (step_above(least) / step - 1.0).abs() < 1e-9,
                "{least}: {}",
                step_above(least)
            );
        }
        assert_eq!(
            (degree_step(40.0), degree_step(1.5), degree_step(1e5)),
            (45.0, 2.0, 1e5)
        );
    }

    #[test]
    fn a_frequency_reads_in_its_unit() {
        assert_eq!(FrequencyUnit::RadPerSecond.readout(2.0494), "ω 2.05 rad/s");
        assert_eq!(FrequencyUnit::Hertz.readout(2.0494), "f 0.326 Hz");
    }
}
