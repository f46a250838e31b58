//! Ticks on a numeric axis: round values, labelled as densely as the room permits.

use gdcm_model::number_format::compact;

use super::range::Range;

/// Mapping from values to positions along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Linear, with ticks at 1, 2 and 5 times a power of ten.
    Linear,
    /// Linear, with ticks at fractions or multiples of a turn; on a narrow range, as for
    /// [`Self::Linear`].
    Degrees,
    Logarithmic,
}

/// A tick on an axis, with a label or without.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    /// Text at the tick; `None` for a minor tick.
    pub label: Option<String>,
}

impl Tick {
    /// Creates a tick with a label.
    pub(super) fn labelled(value: f64, label: String) -> Self {
        Self {
            value,
            label: Some(label),
        }
    }
}

/// Minimum distances \[pt\] at which ticks are drawn or labelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickGaps {
    /// Minimum distance between labels.
    pub labels: f64,
    /// Minimum distance between labels at equal steps on a logarithmic axis.
    pub equal_steps: f64,
    /// Minimum distance between grid lines within a decade.
    pub lines: f64,
}

/// Maximum width \[decades\] at which a logarithmic axis may be labelled at equal steps.
const LINEAR_BELOW: f64 = 0.9;
/// Round steps for angles \[deg\].
const DEGREE_STEPS: [f64; 13] = [
    5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0, 180.0, 360.0, 720.0, 1800.0, 3600.0, 7200.0,
];
/// Maximum step \[deg\] that is chosen as a decimal number; wider steps come from [`DEGREE_STEPS`].
const DECIMAL_DEGREES: f64 = 2.0;
/// `log10(10 / 9)`: the smallest distance between lines in a decade \[decades\].
const NINE_TO_TEN: f64 = 0.045_757_490_560_675_115;
/// Minimum distance from 9 to 10 \[pt\] at which all nine lines in a decade are labelled; labels
/// that are closer together are hard to read.
const NINE_LABELS_GAP: f64 = 44.0;
/// Tolerance for rounding: fraction of a step by which a tick may lie outside the range.
const STEP_SLACK: f64 = 1e-6;

/// Returns the ticks within `range` on an axis `length_pt` long, in ascending order.
pub fn ticks_of(scale: Scale, range: Range, length_pt: f64, gaps: TickGaps) -> Vec<Tick> {
    let least = gaps.labels * range.width() / length_pt;
    match scale {
        Scale::Linear => equal_steps(range, step_above(least)),
        Scale::Degrees => equal_steps(range, degree_step(least)),
        Scale::Logarithmic => logarithmic_ticks(range, length_pt, gaps),
    }
}

/// Returns labelled ticks at multiples of `step`.
fn equal_steps(range: Range, step: f64) -> Vec<Tick> {
    let first = (range.min / step - STEP_SLACK).ceil() as i64;
    let last = (range.max / step + STEP_SLACK).floor() as i64;
    let mut ticks = Vec::new();
    for k in first..=last {
        let value = k as f64 * step;
        ticks.push(Tick::labelled(value, compact(value)));
    }
    ticks
}

/// Returns the smallest round angle step \[deg\] not below `least`: a fraction or a multiple of a
/// turn, or a decimal number if `least` is at most [`DECIMAL_DEGREES`], or beyond all
/// [`DEGREE_STEPS`].
fn degree_step(least: f64) -> f64 {
    match DEGREE_STEPS.into_iter().find(|step| *step >= least) {
        Some(step) if least > DECIMAL_DEGREES => step,
        _ => step_above(least),
    }
}

/// Returns the smallest of 1, 2 and 5 times a power of ten not below `least`; 1 if `least` is not
/// positive and finite.
pub fn step_above(least: f64) -> f64 {
    if !(least > 0.0 && least.is_finite()) {
        return 1.0;
    }
    let power = 10f64.powf(least.log10().floor());
    for factor in [1.0, 2.0, 5.0] {
        // The factor allows for `least` to exceed a round step by a rounding error.
        if factor * power >= least * (1.0 - 1e-9) {
            return factor * power;
        }
    }
    10.0 * power
}

/// Returns the ticks on a logarithmic axis: within decades, or at equal steps if the range is
/// narrower than [`LINEAR_BELOW`] and equal steps give more labels.
fn logarithmic_ticks(range: Range, length_pt: f64, gaps: TickGaps) -> Vec<Tick> {
    let decades = range.max.log10() - range.min.log10();
    let decade_pt = length_pt / decades;
    let in_decades = DecadeLabels::new(decade_pt, gaps).ticks(range);
    // The step follows from the upper end of the axis, where equal steps are closest together.
    let in_steps = equal_steps(
        range,
        step_above(gaps.equal_steps * range.max * std::f64::consts::LN_10 / decade_pt),
    );
    let labelled_count = in_decades
        .iter()
        .filter(|tick| tick.label.is_some())
        .count();
    if decades < LINEAR_BELOW && in_steps.len() > labelled_count {
        in_steps
    } else {
        in_decades
    }
}

/// Density of lines and labels within a decade.
struct DecadeLabels {
    /// Whether there is room for labels at 2 and 5.
    has_two_and_five: bool,
    /// Whether there is room for labels at 3, 4, 6, 7, 8 and 9 as well.
    has_nine: bool,
    /// Whether there is room for lines without labels.
    has_lines: bool,
    /// Decades from each labelled power of ten to the next.
    every: i64,
}

impl DecadeLabels {
    /// Chooses how dense the labels are; a decade is `decade_pt` long.
    fn new(decade_pt: f64, gaps: TickGaps) -> Self {
        Self {
            has_two_and_five: decade_pt * 2f64.log10() >= gaps.labels,
            has_nine: decade_pt * NINE_TO_TEN >= NINE_LABELS_GAP,
            has_lines: decade_pt * NINE_TO_TEN >= gaps.lines,
            every: (gaps.labels / decade_pt).ceil().max(1.0) as i64,
        }
    }

    /// Returns the ticks in `range`, at `mantissa * 10^exponent` with mantissas from 1 to 9.
    fn ticks(&self, range: Range) -> Vec<Tick> {
        let low = range.min.log10();
        let high = range.max.log10();
        let slack = 1e-9 * (1.0 + high - low);
        let shown = low - slack..=high + slack;
        let mut ticks = Vec::new();
        for exponent in low.floor() as i64..=high.floor() as i64 {
            for mantissa in 1..=9u8 {
                let is_labelled = self.is_labelled(mantissa, exponent);
                let is_drawn = self.has_lines || mantissa == 1 || is_labelled;
                let value = f64::from(mantissa) * 10f64.powi(exponent as i32);
                if !is_drawn || !shown.contains(&value.log10()) {
                    continue;
                }
                let label = if is_labelled {
                    Some(compact(value))
                } else {
                    None
                };
                ticks.push(Tick { value, label });
            }
        }
        ticks
    }

    /// Returns whether there is room for a label at `mantissa * 10^exponent`.
    fn is_labelled(&self, mantissa: u8, exponent: i64) -> bool {
        match mantissa {
            1 => exponent.rem_euclid(self.every) == 0,
            2 | 5 => self.has_two_and_five,
            _ => self.has_nine,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        for (least, step) in [(40.0, 45.0), (1.5, 2.0), (1e5, 1e5)] {
            assert_eq!(degree_step(least), step, "{least}");
        }
    }
}
