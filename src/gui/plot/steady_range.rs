//! Hysteresis of axes: a range changes only if the data no longer fit, and then to round ends.

use gdcm_plot::figure::Range;
use gdcm_plot::figure::axis::step_above;

/// Part of an axis by which data may exceed it before it grows.
const OVERSHOOT: f64 = 0.02;
/// Part of an axis in use below which it shrinks.
const LEAST_USE: f64 = 0.6;
/// Number of steps on an axis at least; the ends are multiples of the step, which is 1, 2 or 5 times
/// a power of ten.
const LEAST_STEPS: f64 = 20.0;

/// How far an update of the displayed results has come.
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

/// Returns the range of an axis after an update: `shown` while it fits the data, whose fitted range
/// is `wanted`.
pub(super) fn steady_range(shown: Range, wanted: Range, update: AxisUpdate) -> Range {
    let spare = OVERSHOOT * shown.width();
    let exceeds = wanted.min < shown.min - spare || wanted.max > shown.max + spare;
    let is_unused = wanted.width() < LEAST_USE * shown.width();
    match update {
        AxisUpdate::Pending => shown,
        AxisUpdate::Dragging if exceeds => rounded_out(shown.union(wanted)),
        AxisUpdate::Dragging => shown,
        AxisUpdate::Complete if exceeds => {
            let grown = shown.union(wanted);
            if wanted.width() < LEAST_USE * grown.width() {
                rounded_out(wanted)
            } else {
                rounded_out(grown)
            }
        }
        AxisUpdate::Complete if is_unused => rounded_out(wanted),
        AxisUpdate::Complete => shown,
    }
}

/// Returns the range with its ends moved outwards to multiples of a round step.
pub(super) fn rounded_out(range: Range) -> Range {
    let step = step_above(range.width() / LEAST_STEPS);
    // The factor keeps an end that is a multiple of the step up to a rounding error.
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
    fn round_ends_stay() {
        for range in [SHOWN, Range::new(0.7, 1.6), Range::new(-0.35, 0.2)] {
            let rounded = rounded_out(range);
            assert!((rounded.min - range.min).abs() < 1e-12, "{rounded:?}");
            assert!((rounded.max - range.max).abs() < 1e-12, "{rounded:?}");
        }
    }
}
