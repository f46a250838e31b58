//! The logarithmic frequency axis: everything that knows that a plot's x is `log10(omega)`.

use egui_plot::{GridInput, GridMark};
pub use gdcm_files::figure::FrequencyUnit;
use gdcm_files::figure::compact;

use super::axes::{is_labelled, labelled_mark, minor_mark};

/// Least distance between two labels \[pt\].
const LABEL_GAP: f64 = 34.0;
/// Least distance between two labels where all nine of a decade are shown \[pt\]: a row of many close numbers is hard to read.
const NINE_LABELS_GAP: f64 = 44.0;
/// Least distance between two minor lines \[pt\].
const LINE_GAP: f64 = 5.0;

/// Where less than this is in view \[decades\], equal steps may be labelled instead of parts of a decade.
const LINEAR_BELOW: f64 = 0.9;
/// From 9 to 10, the narrowest gap between the lines of a decade \[decades\].
const NINE_TO_TEN: f64 = 0.045_757_490_560_675_115;

/// The axis of `log10(omega)` in a unit of frequency.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LogAxis(pub FrequencyUnit);

impl LogAxis {
    /// The text of the tick at `mark`, a `log10(omega)`.
    pub fn tick_text(self, mark: GridMark) -> String {
        compact(self.0.of_omega(10f64.powf(mark.value)))
    }

    /// Ticks and grid lines between `bounds`, both `log10(omega)`, on an axis of `decades_per_point`.
    pub fn marks(self, bounds: (f64, f64), decades_per_point: f64) -> Vec<GridMark> {
        if !(decades_per_point > 0.0 && bounds.0 < bounds.1 && bounds.0.is_finite() && bounds.1.is_finite()) {
            return Vec::new();
        }
        let shift = self.0.of_omega(1.0).log10();
        let marks = logarithmic_marks((bounds.0 + shift, bounds.1 + shift), decades_per_point);
        marks.into_iter().map(|mark| GridMark { value: mark.value - shift, ..mark }).collect()
    }

    /// [`Self::marks`] as egui_plot asks for them, where the base step is one point.
    pub fn spacer(self) -> impl Fn(GridInput) -> Vec<GridMark> {
        move |input| self.marks(input.bounds, input.base_step_size)
    }
}

/// What is labelled within a decade.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Labels {
    /// Every so many decades.
    Decades(i64),
    /// 1, 2 and 5.
    OneTwoFive,
    /// 1 to 9.
    Nine,
}

impl Labels {
    fn for_density(points_per_decade: f64) -> Self {
        if points_per_decade * NINE_TO_TEN >= NINE_LABELS_GAP {
            Self::Nine
        } else if points_per_decade * 2f64.log10() >= LABEL_GAP {
            Self::OneTwoFive
        } else {
            Self::Decades((LABEL_GAP / points_per_decade).ceil().max(1.0) as i64)
        }
    }

    fn include(self, mantissa: u8, exponent: i64) -> bool {
        match self {
            Self::Decades(every) => mantissa == 1 && exponent.rem_euclid(every) == 0,
            Self::OneTwoFive => matches!(mantissa, 1 | 2 | 5),
            Self::Nine => true,
        }
    }
}

/// Ticks and grid lines between `bounds`, both common logarithms, on an axis of `decades_per_point`.
pub(super) fn logarithmic_marks(bounds: (f64, f64), decades_per_point: f64) -> Vec<GridMark> {
    let decades = decade_marks(bounds, decades_per_point);
    if bounds.1 - bounds.0 > LINEAR_BELOW {
        return decades;
    }
    let labelled = decades.iter().filter(|mark| is_labelled(**mark, decades_per_point)).count();
    let linear = linear_marks(bounds, decades_per_point);
    if linear.len() > labelled { linear } else { decades }
}

fn decade_marks(bounds: (f64, f64), decades_per_point: f64) -> Vec<GridMark> {
    let labels = Labels::for_density(1.0 / decades_per_point);
    let has_minor_lines = NINE_TO_TEN / decades_per_point >= LINE_GAP;
    let decades = bounds.0.floor() as i64..=bounds.1.floor() as i64;
    let candidates = decades.flat_map(|exponent| (1..=9u8).map(move |mantissa| (mantissa, exponent)));
    candidates
        .filter_map(|(mantissa, exponent)| {
            let value = f64::from(mantissa).log10() + exponent as f64;
            let has_label = labels.include(mantissa, exponent);
            if !within(value, bounds) || !(has_label || has_minor_lines || mantissa == 1) {
                None
            } else if has_label {
                Some(labelled_mark(value, decades_per_point))
            } else {
                Some(minor_mark(value, decades_per_point))
            }
        })
        .collect()
}

/// Equal steps in the unit itself: so close that the axis is nearly linear.
fn linear_marks(bounds: (f64, f64), decades_per_point: f64) -> Vec<GridMark> {
    let (low, high) = (10f64.powf(bounds.0), 10f64.powf(bounds.1));
    // The upper end is where equal steps are closest.
    let units_per_point = high * decades_per_point * std::f64::consts::LN_10;
    let step = gdcm_files::figure::step_above(LABEL_GAP * 1.5 * units_per_point);
    let indices = (low / step).ceil() as i64..=(high / step).floor() as i64;
    indices.map(|k| labelled_mark((k as f64 * step).log10(), decades_per_point)).collect()
}

/// Whether `value` lies in `bounds`, whose ends may miss a round number by rounding.
fn within(value: f64, bounds: (f64, f64)) -> bool {
    let slack = 1e-9 * (1.0 + (bounds.1 - bounds.0));
    (bounds.0 - slack..=bounds.1 + slack).contains(&value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(unit: FrequencyUnit, omega: (f64, f64), points: f64) -> Vec<String> {
        let bounds = (omega.0.log10(), omega.1.log10());
        let decades_per_point = (bounds.1 - bounds.0) / points;
        let marks = LogAxis(unit).marks(bounds, decades_per_point);
        marks
            .into_iter()
            .filter(|mark| is_labelled(*mark, decades_per_point))
            .map(|mark| LogAxis(unit).tick_text(mark))
            .collect()
    }

    #[test]
    fn a_usual_plot_is_labelled_at_one_two_five() {
        assert_eq!(labels(FrequencyUnit::RadPerSecond, (0.3, 20.0), 800.0), ["0.5", "1", "2", "5", "10", "20"]);
    }

    #[test]
    fn a_narrow_plot_is_labelled_at_decades_only() {
        assert_eq!(labels(FrequencyUnit::RadPerSecond, (0.05, 200.0), 300.0), ["0.1", "1", "10", "100"]);
        assert_eq!(labels(FrequencyUnit::RadPerSecond, (1e-6, 1e6), 200.0).len(), 5);
    }

    #[test]
    fn a_close_view_is_labelled_in_equal_steps() {
        assert_eq!(labels(FrequencyUnit::RadPerSecond, (1.98, 2.32), 800.0).first().map(String::as_str), Some("2"));
        assert!(labels(FrequencyUnit::RadPerSecond, (2.0001, 2.0009), 800.0).len() > 3);
        let texts = labels(FrequencyUnit::RadPerSecond, (1.2, 4.2), 900.0);
        assert_eq!(texts, ["1.5", "2", "2.5", "3", "3.5", "4"]);
    }

    #[test]
    fn ticks_in_hertz_are_round_in_hertz() {
        assert_eq!(labels(FrequencyUnit::Hertz, (0.3, 20.0), 800.0), ["0.05", "0.1", "0.2", "0.5", "1", "2"]);
    }

    #[test]
    fn no_two_labels_are_closer_than_the_gap_at_any_zoom() {
        for width in [1e-4, 0.01, 0.1, 0.4, 0.8, 1.3, 1.8, 3.0, 7.0, 12.0] {
            for points in [150.0, 400.0, 900.0, 2500.0] {
                let per_point = width / points;
                let marks = LogAxis(FrequencyUnit::RadPerSecond).marks((-0.52, -0.52 + width), per_point);
                let labelled: Vec<_> = marks.iter().filter(|m| is_labelled(**m, per_point)).collect();
                assert!(labelled.len() < 80, "{width} {points}: {}", labelled.len());
                for pair in labelled.windows(2) {
                    let gap = (pair[1].value - pair[0].value) / per_point;
                    assert!(gap > 0.99 * LABEL_GAP, "{width} {points}: {gap}");
                }
            }
        }
    }

    #[test]
    fn a_decade_has_nine_lines_where_there_is_room() {
        let marks = LogAxis(FrequencyUnit::RadPerSecond).marks((0.0, 1.0 - 1e-6), 1.0 / 400.0);
        assert_eq!(marks.len(), 9);
    }

    #[test]
    fn bounds_that_are_no_range_give_no_marks() {
        assert!(LogAxis(FrequencyUnit::RadPerSecond).marks((1.0, 1.0), 0.1).is_empty());
        assert!(LogAxis(FrequencyUnit::RadPerSecond).marks((f64::NAN, 1.0), 0.1).is_empty());
    }
}
