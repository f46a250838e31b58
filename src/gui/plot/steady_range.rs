//! Hysteresis for axes: a range changes only if the data leave it or fill little of it, and then to
//! round ends.
//! `figure_view` uses it for the axes of figures, `bode_view` for the values in a Bode plot,
//! `overview_ranges` for those in the overview.

use gdcm_plot::figure::Range;
use gdcm_plot::figure::axis::{Scale, step_above};

/// Share of an axis by which data may exceed it before it grows.
const OVERSHOOT: f64 = 0.02;
/// An axis shrinks if its data fill less than this share of it.
const LEAST_USE: f64 = 0.6;
/// Maximum number of steps on an axis before its ends are moved outwards to multiples of the step,
/// which is 1, 2 or 5 times a power of ten.
const MOST_STEPS: f64 = 20.0;

/// Minimum number of labels on a value axis in a Bode plot or in the overview.
const LEAST_LABELS: f64 = 5.0;
/// Maximum factor by which an axis is extended to hold [`LEAST_LABELS`] labels.
const MOST_EXTENSION: f64 = 1.25;
/// Divisor that leads from a decimal step to the next smaller: more than 2.5, the largest ratio
/// between neighbours in 1, 2, 5, 10.
const TO_NEXT_STEP: f64 = 2.6;

/// Stage of an update to the displayed results.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisUpdate {
    /// The results are complete: axes may grow and shrink.
    #[default]
    Complete,
    /// Something is being dragged: axes only grow, and everything else waits for the release.
    Dragging,
    /// The results are older than the settings: axes stay.
    Pending,
}

/// Returns the range of an axis after an update: `shown` while it suits the data, whose own range
/// is `fitted`; otherwise a range with round ends.
pub(super) fn steady_range(shown: Range, fitted: Range, update: AxisUpdate) -> Range {
    match changed_range(shown, fitted, update) {
        Some(changed) => rounded_out(changed),
        None => shown,
    }
}

/// Returns the range to which an axis changes, before its ends are rounded; `None` while `shown`
/// suits the data, whose own range is `fitted`. With the union of both ranges as `grown`:
///
/// 1. results pending: no change;
/// 2. dragging: `grown` if the data exceed the axis by more than [`OVERSHOOT`], otherwise no
///    change;
/// 3. results complete: `fitted` if it uses less than [`LEAST_USE`] of `grown` (the axis shrinks,
///    or the data have moved away); else `grown` if the data exceed the axis; else no change.
pub(super) fn changed_range(shown: Range, fitted: Range, update: AxisUpdate) -> Option<Range> {
    // Step 1.
    if update == AxisUpdate::Pending {
        return None;
    }
    let spare = OVERSHOOT * shown.width();
    let exceeds = fitted.min < shown.min - spare || fitted.max > shown.max + spare;
    let grown = shown.union(fitted);
    // Step 2.
    if update == AxisUpdate::Dragging {
        return if exceeds { Some(grown) } else { None };
    }
    // Step 3.
    if fitted.width() < LEAST_USE * grown.width() {
        Some(fitted)
    } else if exceeds {
        Some(grown)
    } else {
        None
    }
}

/// Returns a range with round ends that contains at least [`LEAST_LABELS`] multiples of a usual
/// step between labels, for an axis that must be readable in a low plot:
///
/// 1. move the ends of `range` outwards to round values; on a logarithmic axis, that is all;
/// 2. from the largest step downwards, extend the range until it contains enough multiples;
/// 3. stop at the first step for which it becomes at most [`MOST_EXTENSION`] times as wide.
pub(super) fn labelled_range(range: Range, scale: Scale) -> Range {
    // Step 1.
    let rounded = rounded_out(range);
    if scale == Scale::Logarithmic {
        return rounded;
    }
    // Steps 2 and 3.
    let mut step = step_above(rounded.width());
    loop {
        let labelled = with_labels(rounded, step);
        if labelled.width() <= MOST_EXTENSION * rounded.width() {
            return labelled;
        }
        step = match scale {
            Scale::Degrees => degree_step_below(step),
            _ => decimal_step_below(step),
        };
    }
}

/// Returns the range, extended at the nearer end until it contains enough multiples of `step`.
fn with_labels(range: Range, step: f64) -> Range {
    /// Allowance for rounding errors \[steps\].
    const SLACK: f64 = 1e-9;
    let mut first = (range.min / step - SLACK).ceil();
    let mut last = (range.max / step + SLACK).floor();
    let mut labelled = range;
    while last - first < LEAST_LABELS - 1.0 {
        let below = labelled.min - (first - 1.0) * step;
        let above = (last + 1.0) * step - labelled.max;
        if below <= above {
            first -= 1.0;
            labelled.min = first * step;
        } else {
            last += 1.0;
            labelled.max = last * step;
        }
    }
    labelled
}

/// Returns the next smaller step between labelled angles \[deg\]; decimal below 10.
fn degree_step_below(step: f64) -> f64 {
    const STEPS: [f64; 9] = [720.0, 360.0, 180.0, 90.0, 60.0, 45.0, 30.0, 15.0, 10.0];
    match STEPS.into_iter().find(|smaller| *smaller < step) {
        Some(smaller) => smaller,
        None => decimal_step_below(step),
    }
}

/// Returns the next smaller step among 1, 2 and 5 times the powers of ten.
fn decimal_step_below(step: f64) -> f64 {
    step_above(step / TO_NEXT_STEP)
}

/// Returns the range with its ends moved outwards to multiples of a round step.
pub(super) fn rounded_out(range: Range) -> Range {
    let step = step_above(range.width() / MOST_STEPS);
    // The slack keeps an end that is a multiple of the step up to a rounding error.
    let slack = 1e-9 * step;
    Range::new(
        ((range.min + slack) / step).floor() * step,
        ((range.max - slack) / step).ceil() * step,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHOWN: Range = Range {
        min: -40.0,
        max: 10.0,
    };

    fn complete(min: f64, max: f64) -> Range {
        steady_range(SHOWN, Range::new(min, max), AxisUpdate::Complete)
    }

    #[test]
    fn an_axis_stays_while_the_data_fit_and_use_it() {
        assert_eq!(complete(-38.0, 9.0), SHOWN);
        assert_eq!(complete(-40.9, 10.9), SHOWN, "by 1.8 % of the range");
        assert_eq!(complete(-28.0, 3.0), SHOWN, "62 % in use");
    }

    #[test]
    fn an_axis_grows_in_round_steps() {
        assert_eq!(complete(-41.1, 9.0), Range::new(-45.0, 10.0));
        assert_eq!(complete(-40.0, 31.0), Range::new(-40.0, 35.0));
    }

    #[test]
    fn an_axis_shrinks_when_little_of_it_is_in_use() {
        assert_eq!(complete(-20.3, 3.0), Range::new(-22.0, 4.0));
        // A range far away is fitted, not joined.
        assert_eq!(complete(100.0, 110.0), Range::new(100.0, 110.0));
    }

    #[test]
    fn a_dragged_axis_only_grows_and_an_older_one_stays() {
        let small = Range::new(-5.0, 0.0);
        let large = Range::new(-80.0, 12.0);
        assert_eq!(steady_range(SHOWN, small, AxisUpdate::Dragging), SHOWN);
        let grown = steady_range(SHOWN, large, AxisUpdate::Dragging);
        assert_eq!(grown, Range::new(-80.0, 15.0));
        assert_eq!(steady_range(grown, SHOWN, AxisUpdate::Dragging), grown);
        assert_eq!(steady_range(SHOWN, large, AxisUpdate::Pending), SHOWN);
    }

    #[test]
    fn an_axis_of_a_low_plot_has_five_labels() {
        let range = labelled_range(Range::new(-14.0, 8.0), Scale::Linear);
        assert_eq!(range, Range::new(-15.0, 8.0), "every 5 dB");
        let range = labelled_range(Range::new(-33.0, 13.0), Scale::Linear);
        assert_eq!(range, Range::new(-35.0, 15.0), "every 10 dB");
        let range = labelled_range(Range::new(-300.0, 20.0), Scale::Degrees);
        assert_eq!(range, Range::new(-360.0, 20.0), "every 90 degrees");
        for width in 1..400 {
            for min in [-720.0, -361.0, -97.0, -3.0, 0.0] {
                for scale in [Scale::Linear, Scale::Degrees] {
                    let range = Range::new(min, min + f64::from(width));
                    let labelled = labelled_range(range, scale);
                    assert!(labelled.min <= range.min && labelled.max >= range.max);
                    assert!(labelled.width() < 1.6 * range.width() + 1e-9, "{range:?}");
                }
            }
        }
    }

    #[test]
    fn round_ends_stay() {
        for range in [SHOWN, Range::new(0.7, 1.6), Range::new(-0.35, 0.2)] {
            let rounded = rounded_out(range);
            assert!((rounded.min - range.min).abs() < 1e-12, "{rounded:?}");
            assert!((rounded.max - range.max).abs() < 1e-12, "{rounded:?}");
        }
    }
}
