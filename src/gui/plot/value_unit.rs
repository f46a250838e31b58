//! Display units for the values in a Bode pane.

use gdcm_model::number_format::{compact, decimals};
use gdcm_model::units::db_to_ratio;
use gdcm_plot::figure::Range;
use gdcm_plot::figure::axis::Scale;

use super::ticks::{Ticks, VERTICAL_TICK_GAP};

/// A pane's display unit. Decibels and ratios are both drawn from values in decibels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueUnit {
    Decibel,
    /// Ratio corresponding to the decibels, on a logarithmic axis.
    Ratio,
    Degree,
    Millisecond,
}

impl ValueUnit {
    /// Returns the suffix after a value, such as " dB" or "°"; empty for a ratio.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Decibel => " dB",
            Self::Ratio => "",
            Self::Degree => "°",
            Self::Millisecond => " ms",
        }
    }

    /// Formats a drawn value for display, such as "2.9 dB" or "−99°".
    pub fn readout(self, value: f64) -> String {
        match self {
            Self::Decibel | Self::Millisecond => format!("{}{}", decimals(value, 1), self.suffix()),
            Self::Degree => format!("{}{}", decimals(value, 0), self.suffix()),
            Self::Ratio => format!("× {}", compact(three_significant(db_to_ratio(value)))),
        }
    }

    /// Returns the permitted widths for the visible range: the lower limit is far below what can be
    /// read, the upper limit far above any response.
    pub(super) fn widths(self) -> Range {
        match self {
            Self::Decibel | Self::Ratio => Range {
                min: 1e-3,
                max: 5e3,
            },
            Self::Degree | Self::Millisecond => Range {
                min: 1e-2,
                max: 1e5,
            },
        }
    }

    /// Returns the scale that determines the steps between tick labels.
    pub(super) fn scale(self) -> Scale {
        match self {
            Self::Decibel | Self::Millisecond => Scale::Linear,
            Self::Degree => Scale::Degrees,
            Self::Ratio => Scale::Logarithmic,
        }
    }

    pub(super) fn ticks(self) -> Ticks {
        match self {
            Self::Decibel | Self::Millisecond => Ticks::Decimal(VERTICAL_TICK_GAP),
            Self::Degree => Ticks::Degrees,
            Self::Ratio => Ticks::Ratio,
        }
    }
}

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
        let ticks = ValueUnit::Ratio.ticks();
        let drawn = ticks.place(2.0);
        // 20 log10 2; the tolerances allow for rounding errors of both functions.
        assert!((drawn - 6.020_599_913_279_624).abs() < 1e-12);
        assert!((ticks.number(drawn) - 2.0).abs() < 1e-12);
        assert!(!ticks.place(0.0).is_finite() && !ticks.place(-1.0).is_finite());
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
        let input = egui_plot::GridInput {
            bounds: (-20.0, 20.0),
            base_step_size: 40.0 / 300.0,
        };
        let marks = ValueUnit::Ratio
            .ticks()
            .marks(input.bounds, input.base_step_size);
        let labels: Vec<String> = marks
            .into_iter()
            .map(|mark| ValueUnit::Ratio.ticks().text(mark))
            .collect();
        for wanted in ["0.1", "0.2", "0.5", "1", "2", "5", "10"] {
            assert!(
                labels.iter().any(|label| label == wanted),
                "{wanted}: {labels:?}"
            );
        }
    }
}
