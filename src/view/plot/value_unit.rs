//! The units that vertical axes are read in.

use egui_plot::{GridInput, GridMark};

use super::axes::VERTICAL_TICK_GAP;
use super::linear_axis::{Ladder, tick_text};
use super::log_axis::logarithmic_marks;
use super::number::{compact, decimals};
use super::range::Range;
use gdcm_core::units::{db_to_ratio, ratio_to_db};

/// The unit that the values of a pane are read in. What is drawn is in decibels for the first two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueUnit {
    /// Decibels.
    Decibel,
    /// The ratio that decibels mean, on a logarithmic axis.
    Ratio,
    /// Degrees.
    Degree,
    /// Milliseconds.
    Millisecond,
}

impl ValueUnit {
    /// What stands behind a value: " dB", "°".
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Decibel => " dB",
            Self::Ratio => "",
            Self::Degree => "°",
            Self::Millisecond => " ms",
        }
    }

    /// A drawn value in this unit.
    pub fn of_drawn(self, value: f64) -> f64 {
        if self == Self::Ratio { db_to_ratio(value) } else { value }
    }

    /// The drawn value of one in this unit; nothing for a ratio that has no decibels.
    pub fn to_drawn(self, value: f64) -> Option<f64> {
        let drawn = if self == Self::Ratio { ratio_to_db(value) } else { value };
        drawn.is_finite().then_some(drawn)
    }

    /// A drawn value as a reader wants it: "2.9 dB", "−99°".
    pub fn readout(self, value: f64) -> String {
        match self {
            Self::Decibel | Self::Millisecond => format!("{}{}", decimals(value, 1), self.suffix()),
            Self::Degree => format!("{}{}", decimals(value, 0), self.suffix()),
            Self::Ratio => format!("× {}", compact(three_significant(db_to_ratio(value)))),
        }
    }

    /// Values that can be in view, by their width.
    pub(super) fn widths(self) -> Range {
        match self {
            Self::Decibel | Self::Ratio => Range { min: 1e-3, max: 5e3 },
            Self::Degree | Self::Millisecond => Range { min: 1e-2, max: 1e5 },
        }
    }

    /// Ticks as egui_plot asks for them.
    pub(super) fn spacer(self) -> impl Fn(GridInput) -> Vec<GridMark> {
        move |input| {
            let (bounds, per_point) = (input.bounds, input.base_step_size);
            match self {
                Self::Decibel | Self::Millisecond => Ladder::Decimal.marks(bounds, per_point, VERTICAL_TICK_GAP),
                Self::Degree => Ladder::Degrees.marks(bounds, per_point, VERTICAL_TICK_GAP),
                Self::Ratio => {
                    let marks =
                        logarithmic_marks((bounds.0 / DB_OF_DECADE, bounds.1 / DB_OF_DECADE), per_point / DB_OF_DECADE);
                    let in_db = |mark: GridMark| GridMark {
                        value: DB_OF_DECADE * mark.value,
                        step_size: DB_OF_DECADE * mark.step_size,
                    };
                    marks.into_iter().map(in_db).collect()
                }
            }
        }
    }

    /// The text of a tick.
    pub(super) fn tick_text(self, mark: GridMark) -> String {
        match self {
            Self::Ratio => compact(db_to_ratio(mark.value)),
            _ => tick_text(mark),
        }
    }
}

/// Decibels of a factor of ten.
const DB_OF_DECADE: f64 = 20.0;

/// `value` rounded to three significant digits.
fn three_significant(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let step = 10f64.powf(value.abs().log10().floor() - 2.0);
    (value / step).round() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_is_read_from_its_decibels_and_back() {
        let drawn = ValueUnit::Ratio.to_drawn(2.0).unwrap();
        // 20 log10 2, and one rounding of each function.
        assert!((drawn - 6.020_599_913_279_624).abs() < 1e-12);
        assert!((ValueUnit::Ratio.of_drawn(drawn) - 2.0).abs() < 1e-12);
        assert_eq!(ValueUnit::Ratio.to_drawn(0.0), None);
        assert_eq!(ValueUnit::Ratio.to_drawn(-1.0), None);
        assert_eq!(ValueUnit::Ratio.readout(drawn), "× 2");
    }

    #[test]
    fn values_read_in_their_unit() {
        assert_eq!(ValueUnit::Decibel.readout(2.94), "2.9 dB");
        assert_eq!(ValueUnit::Degree.readout(-99.2), "\u{2212}99°");
        assert_eq!(ValueUnit::Millisecond.readout(-56.04), "\u{2212}56.0 ms");
        assert_eq!(ValueUnit::Ratio.readout(-1.7), "× 0.822");
    }

    #[test]
    fn ticks_of_ratios_are_round_ratios() {
        let input = GridInput { bounds: (-20.0, 20.0), base_step_size: 40.0 / 300.0 };
        let marks = ValueUnit::Ratio.spacer()(input);
        let labels: Vec<String> = marks.into_iter().map(|mark| ValueUnit::Ratio.tick_text(mark)).collect();
        for wanted in ["0.1", "0.2", "0.5", "1", "2", "5", "10"] {
            assert!(labels.iter().any(|label| label == wanted), "{wanted}: {labels:?}");
        }
    }
}
