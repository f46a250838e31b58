//! Ticks and grid lines for egui_plot axes: adapts the ticks chosen by [`ticks_of`], which also
//! serves printed figures, to egui_plot.
//!
//! A *tick* has a value and perhaps a label. egui_plot knows no ticks but *marks*, each with a
//! value and a step size, from which it decides whether to draw the label and how strongly to draw
//! the grid line. Therefore the mark of a tick with a label gets a step size of [`LABELLED`]
//! points, that of a tick without a label [`MINOR`] points, whatever the true distance.
//!
//! A *place* is an axis coordinate, in which egui_plot works: `log10` of a frequency, or decibels
//! for a ratio. The *gap* is the distance between neighbouring labels.

use egui::Rangef;
use egui_plot::{GridInput, GridMark};

use gdcm_model::number_format::compact;
use gdcm_model::units::{db_to_ratio, ratio_to_db};
use gdcm_plot::figure::Range;
use gdcm_plot::figure::axis::{FrequencyUnit, Scale, Tick, TickGaps, ticks_of};

/// Minimum distance between ticks on a vertical axis \[pt\].
pub(super) const VERTICAL_TICK_GAP: f64 = 27.0;

/// Step size given to every mark with a label \[pt\].
const LABELLED: f64 = 100.0;
/// Step size given to every mark without a label \[pt\].
const MINOR: f64 = 25.0;

/// `grid_spacing` with which egui_plot draws marks with the step size [`LABELLED`] in full strength
/// and marks with [`MINOR`] in half strength.
pub(super) const GRID_SPACING: Rangef = Rangef {
    min: 1.0,
    max: 100.0,
};
/// `label_spacing` with which egui_plot labels marks with the step size [`LABELLED`] in full
/// strength, and marks with [`MINOR`] not at all.
pub(super) const LABEL_SPACING: Rangef = Rangef {
    min: 50.0,
    max: 51.0,
};

/// Minimum distance between two labels within a decade \[pt\].
const DECADE_LABEL_GAP: f64 = 34.0;
/// Minimum distance between two grid lines within a decade \[pt\].
const DECADE_LINE_GAP: f64 = 5.0;
/// Minimum number of labels with which the scale of an axis can be read: two values and the
/// distance between them.
const USUAL_LEAST_LABELS: usize = 2;
/// Minimum distance between labels that move together until there are two \[pt\]; letters are 11 pt
/// high.
const LEAST_GAP_OF_TWO: f64 = 13.0;
/// Minimum distance between labels that move together until there are more than two \[pt\]: a
/// larger value gives low plots fewer labels, a smaller one crowds them.
const LEAST_GAP_OF_MORE: f64 = 15.0;
/// Factor by which labels in a low plot move together until it has enough.
const GAP_REDUCTION: f64 = 0.8;
/// Minimum distance between labels at equal steps on a logarithmic axis, relative to other labels:
/// 2.2 and 2.4 are wider than 2 and 5.
const EQUAL_STEPS_APART: f64 = 1.5;
/// Space between two labels along a horizontal axis \[digit widths\].
const LABEL_SPACE: f64 = 0.6;
/// Minimum gap between two names along an axis \[pt\].
const NAME_GAP: f64 = 6.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ticks {
    /// Plain values, such as decibels, knots and gains, with labels usually at least this far apart
    /// \[pt\].
    Decimal(f64),
    /// Degrees, labelled at fractions of a turn.
    Degrees,
    /// Values of `log10(omega)`, labelled as frequencies in a unit.
    Frequency(FrequencyUnit),
    /// Decibels, labelled as ratios.
    Ratio,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct TickLabel {
    /// Axis coordinate.
    pub(super) place: f64,
    pub(super) text: String,
}

impl Ticks {
    /// Converts an axis coordinate to the displayed value.
    pub(super) fn number(self, place: f64) -> f64 {
        match self {
            Self::Decimal(_) | Self::Degrees => place,
            Self::Frequency(unit) => unit.of_omega(10f64.powf(place)),
            Self::Ratio => db_to_ratio(place),
        }
    }

    /// Converts a displayed value to the axis coordinate; not finite if there is none.
    pub(super) fn place(self, number: f64) -> f64 {
        match self {
            Self::Decimal(_) | Self::Degrees => number,
            Self::Frequency(unit) => (number / unit.of_omega(1.0)).log10(),
            Self::Ratio => ratio_to_db(number),
        }
    }

    /// Returns the ticks and grid lines between two axis coordinates; a mark's step size determines
    /// whether egui_plot labels it.
    pub(super) fn marks(self, bounds: (f64, f64), units_per_point: f64) -> Vec<GridMark> {
        self.marks_with_labels(bounds, units_per_point, USUAL_LEAST_LABELS)
    }

    /// Like [`Self::marks`], with at least `least` labels if they fit:
    ///
    /// 1. choose the ticks with the usual gap between labels;
    /// 2. in a low plot, with fewer labels, reduce the gap step by step down to the minimum;
    /// 3. make each tick a mark, whose step size says whether it has a label.
    ///
    /// Empty if the bounds are empty or not finite.
    pub(super) fn marks_with_labels(
        self,
        bounds: (f64, f64),
        units_per_point: f64,
        least: usize,
    ) -> Vec<GridMark> {
        let is_finite = [bounds.0, bounds.1, units_per_point]
            .into_iter()
            .all(f64::is_finite);
        if !(is_finite && units_per_point > 0.0 && bounds.0 < bounds.1) {
            return Vec::new();
        }
        // Step 1.
        let mut gap = self.label_gap();
        let mut ticks = self.ticks_between(bounds, units_per_point, gap);
        // Step 2.
        let least_gap = if least > USUAL_LEAST_LABELS {
            LEAST_GAP_OF_MORE
        } else {
            LEAST_GAP_OF_TWO
        };
        while count_labels(&ticks) < least && gap > least_gap {
            gap = (GAP_REDUCTION * gap).max(least_gap);
            ticks = self.ticks_between(bounds, units_per_point, gap);
        }
        // Step 3.
        let mut marks = Vec::with_capacity(ticks.len());
        for tick in ticks {
            let step_pt = if tick.label.is_some() {
                LABELLED
            } else {
                MINOR
            };
            marks.push(GridMark {
                value: self.place(tick.value),
                step_size: step_pt * units_per_point,
            });
        }
        marks
    }

    /// Returns the labels of an axis with this range, `length_pt` points long.
    pub(super) fn labels(self, range: Range, length_pt: f64) -> Vec<TickLabel> {
        let units_per_point = range.width() / length_pt;
        let mut labels = Vec::new();
        for mark in self.marks((range.min, range.max), units_per_point) {
            // The step size is either `LABELLED` or `MINOR` points.
            if mark.step_size > 0.5 * (LABELLED + MINOR) * units_per_point {
                labels.push(TickLabel {
                    place: mark.value,
                    text: self.text(mark),
                });
            }
        }
        labels
    }

    /// Returns the usual minimum distance between two labels \[pt\].
    fn label_gap(self) -> f64 {
        match self {
            Self::Decimal(gap) => gap,
            Self::Degrees => VERTICAL_TICK_GAP,
            Self::Frequency(_) | Self::Ratio => DECADE_LABEL_GAP,
        }
    }

    /// Returns the ticks between two axis coordinates, with labels at least `gap` points apart.
    fn ticks_between(self, bounds: (f64, f64), units_per_point: f64, gap: f64) -> Vec<Tick> {
        let scale = match self {
            Self::Decimal(_) => Scale::Linear,
            Self::Degrees => Scale::Degrees,
            Self::Frequency(_) | Self::Ratio => Scale::Logarithmic,
        };
        let range = Range::new(self.number(bounds.0), self.number(bounds.1));
        let length = (bounds.1 - bounds.0) / units_per_point;
        let gaps = TickGaps {
            labels: gap,
            equal_steps: EQUAL_STEPS_APART * gap,
            lines: DECADE_LINE_GAP,
        };
        ticks_of(scale, range, length, gaps)
    }

    /// Returns [`Self::marks`] for a horizontal axis, far enough apart for the widest label if a
    /// digit is `digit_pt` points wide. Only decimal values can be set further apart; the other
    /// kinds have a fixed gap.
    pub(super) fn horizontal_marks(
        self,
        bounds: (f64, f64),
        units_per_point: f64,
        digit_pt: f64,
    ) -> Vec<GridMark> {
        let marks = self.marks(bounds, units_per_point);
        let longest = marks
            .iter()
            .map(|mark| self.text(*mark).chars().count())
            .max()
            .unwrap_or(0);
        let needed_gap = (longest as f64 + LABEL_SPACE) * digit_pt;
        match self {
            Self::Decimal(gap) if gap < needed_gap => {
                Self::Decimal(needed_gap).marks(bounds, units_per_point)
            }
            _ => marks,
        }
    }

    /// Returns the label at a mark.
    pub(super) fn text(self, mark: GridMark) -> String {
        compact(self.number(mark.value))
    }
}

fn count_labels(ticks: &[Tick]) -> usize {
    ticks.iter().filter(|tick| tick.label.is_some()).count()
}

/// Returns marks for `count` names at 0, 1, 2 …; only for every n-th name if the widest name does
/// not fit otherwise.
pub(super) fn named_marks(input: &GridInput, count: usize, widest_pt: f64) -> Vec<GridMark> {
    let every = ((widest_pt + NAME_GAP) * input.base_step_size)
        .ceil()
        .max(1.0);
    let mut marks = Vec::new();
    for index in (0..count).step_by(every as usize) {
        marks.push(GridMark {
            value: index as f64,
            step_size: LABELLED * input.base_step_size,
        });
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::super::steady_range::labelled_range;
    use super::*;

    /// Returns whether a mark has a label on an axis with `units_per_point`.
    fn is_labelled(mark: GridMark, units_per_point: f64) -> bool {
        mark.step_size / units_per_point > f64::from(LABEL_SPACING.min)
    }

    fn values(ticks: Ticks, bounds: (f64, f64), points: f64) -> Vec<f64> {
        let marks = ticks.marks(bounds, (bounds.1 - bounds.0) / points);
        marks.into_iter().map(|mark| mark.value).collect()
    }

    #[test]
    fn labels_are_the_labelled_marks() {
        let range = Range::new(-1.0, 1.0);
        let labels = Ticks::Frequency(FrequencyUnit::RadPerSecond).labels(range, 100.0);
        let texts: Vec<&str> = labels.iter().map(|label| label.text.as_str()).collect();
        assert_eq!(texts, ["0.1", "1", "10"]);
        assert_eq!(labels[0].place, -1.0);
    }

    #[test]
    fn magnitudes_are_labelled_at_five_ten_or_twenty_decibels() {
        assert_eq!(
            values(Ticks::Decimal(28.0), (-26.0, 10.0), 290.0),
            [-25.0, -20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0]
        );
        assert_eq!(
            values(Ticks::Decimal(28.0), (-80.0, 20.0), 290.0),
            [
                -80.0, -70.0, -60.0, -50.0, -40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0
            ]
        );
    }

    #[test]
    fn a_low_bode_pane_has_five_labels_at_any_range_that_was_fitted() {
        for height in [137.0, 160.0, 200.0] {
            for width in 3..400 {
                for lower in [-361.0, -53.0, -47.0, -1.0] {
                    for (ticks, scale) in [
                        (Ticks::Decimal(VERTICAL_TICK_GAP), Scale::Linear),
                        (Ticks::Degrees, Scale::Degrees),
                    ] {
                        let range = Range::new(lower, lower + f64::from(width));
                        let range = labelled_range(range, scale);
                        let per_point = range.width() / height;
                        let bounds = (range.min, range.max);
                        let marks = ticks.marks_with_labels(bounds, per_point, 5);
                        let labels = marks.iter().filter(|mark| is_labelled(**mark, per_point));
                        assert!(labels.count() >= 5, "{range:?} {scale:?} in {height} pt");
                    }
                }
            }
        }
    }

    #[test]
    fn phases_are_labelled_at_parts_of_a_turn() {
        assert_eq!(
            values(Ticks::Degrees, (-330.0, 60.0), 200.0),
            [-300.0, -240.0, -180.0, -120.0, -60.0, 0.0, 60.0]
        );
        assert_eq!(
            values(Ticks::Degrees, (-200.0, 10.0), 250.0),
            [-180.0, -150.0, -120.0, -90.0, -60.0, -30.0, 0.0]
        );
        assert_eq!(
            values(Ticks::Degrees, (-900.0, 0.0), 200.0),
            [-900.0, -720.0, -540.0, -360.0, -180.0, 0.0]
        );
    }

    #[test]
    fn numbers_beside_one_another_have_the_room_of_the_widest() {
        let values = |bounds: (f64, f64), points: f64| -> Vec<f64> {
            let marks =
                Ticks::Decimal(26.0).horizontal_marks(bounds, (bounds.1 - bounds.0) / points, 6.5);
            marks.into_iter().map(|mark| mark.value).collect()
        };
        // "−120" and "−110" need 29 pt each; 27 pt are available.
        assert_eq!(
            values((-130.0, 8.0), 360.0),
            [-120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0]
        );
        assert_eq!(
            values((40.0, 145.0), 150.0),
            [40.0, 60.0, 80.0, 100.0, 120.0, 140.0]
        );
    }

    #[test]
    fn invalid_bounds_give_no_ticks() {
        assert!(Ticks::Decimal(28.0).marks((1.0, 1.0), 0.0).is_empty());
        // Chart of a record, 58 points high.
        assert_eq!(
            values(Ticks::Decimal(28.0), (-8.0, 8.0), 58.0),
            [-5.0, 0.0, 5.0]
        );
        assert!(Ticks::Degrees.marks((0.0, f64::NAN), f64::NAN).is_empty());
    }

    fn labels(unit: FrequencyUnit, omega: (f64, f64), points: f64) -> Vec<String> {
        let bounds = (omega.0.log10(), omega.1.log10());
        let decades_per_point = (bounds.1 - bounds.0) / points;
        let marks = Ticks::Frequency(unit).marks(bounds, decades_per_point);
        marks
            .into_iter()
            .filter(|mark| is_labelled(*mark, decades_per_point))
            .map(|mark| Ticks::Frequency(unit).text(mark))
            .collect()
    }

    #[test]
    fn a_usual_plot_is_labelled_at_one_two_five() {
        assert_eq!(
            labels(FrequencyUnit::RadPerSecond, (0.3, 20.0), 800.0),
            ["0.5", "1", "2", "5", "10", "20"]
        );
    }

    #[test]
    fn a_narrow_plot_is_labelled_at_decades_only() {
        assert_eq!(
            labels(FrequencyUnit::RadPerSecond, (0.05, 200.0), 300.0),
            ["0.1", "1", "10", "100"]
        );
        assert_eq!(
            labels(FrequencyUnit::RadPerSecond, (1e-6, 1e6), 200.0).len(),
            5
        );
    }

    #[test]
    fn a_close_view_is_labelled_in_equal_steps() {
        assert_eq!(
            labels(FrequencyUnit::RadPerSecond, (1.98, 2.32), 800.0)
                .first()
                .map(String::as_str),
            Some("2")
        );
        assert!(labels(FrequencyUnit::RadPerSecond, (2.0001, 2.0009), 800.0).len() > 3);
        let texts = labels(FrequencyUnit::RadPerSecond, (1.2, 4.2), 900.0);
        assert_eq!(texts, ["1.5", "2", "2.5", "3", "3.5", "4"]);
    }

    #[test]
    fn ticks_in_hertz_are_round_in_hertz() {
        assert_eq!(
            labels(FrequencyUnit::Hertz, (0.3, 20.0), 800.0),
            ["0.05", "0.1", "0.2", "0.5", "1", "2"]
        );
    }

    #[test]
    fn no_two_labels_are_closer_than_the_gap_at_any_zoom() {
        for width in [1e-4, 0.01, 0.1, 0.4, 0.8, 1.3, 1.8, 3.0, 7.0, 12.0] {
            for points in [150.0, 400.0, 900.0, 2500.0] {
                let per_point = width / points;
                let marks = Ticks::Frequency(FrequencyUnit::RadPerSecond)
                    .marks((-0.52, -0.52 + width), per_point);
                let labelled: Vec<_> = marks
                    .iter()
                    .filter(|m| is_labelled(**m, per_point))
                    .collect();
                assert!(labelled.len() < 80, "{width} {points}: {}", labelled.len());
                for pair in labelled.windows(2) {
                    let gap = (pair[1].value - pair[0].value) / per_point;
                    assert!(gap > 0.99 * DECADE_LABEL_GAP, "{width} {points}: {gap}");
                }
            }
        }
    }

    #[test]
    fn a_decade_has_nine_lines_where_there_is_room() {
        let marks =
            Ticks::Frequency(FrequencyUnit::RadPerSecond).marks((0.0, 1.0 - 1e-6), 1.0 / 400.0);
        assert_eq!(marks.len(), 9);
    }

    #[test]
    fn invalid_frequencies_give_no_marks() {
        assert!(
            Ticks::Frequency(FrequencyUnit::RadPerSecond)
                .marks((1.0, 1.0), 0.1)
                .is_empty()
        );
        assert!(
            Ticks::Frequency(FrequencyUnit::RadPerSecond)
                .marks((f64::NAN, 1.0), 0.1)
                .is_empty()
        );
    }
}
