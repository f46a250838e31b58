//! What the two stacked panes show, and in which units.

use gdcm_model::units::db_to_ratio;
use gdcm_plot::figure::axis::compact;
pub use gdcm_plot::figure::axis::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use gdcm_plot::figure::{Range, decimals};

use super::axes::{Ticks, VERTICAL_TICK_GAP};
use super::drawn_curves::Pane;

/// What the two stacked panes show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodeQuantity<'a> {
    /// Responses: their magnitudes above, their phases below.
    Response {
        /// How magnitudes are read.
        magnitude: MagnitudeUnit,
        /// How phases are drawn.
        phase: PhaseUnit,
        /// The unit of a ratio: "(deg/s)/in".
        ratio_unit: &'a str,
        /// In which plot they are.
        place: ResponsePlace,
    },
    /// What the fit sees of them: `20 log10 |H_ref| / |H_sim|` above, `Delta phi(H_sim, H_ref)` below (M6).
    Error {
        /// How differences of phases are drawn.
        phase: PhaseErrorUnit,
    },
}

/// In which plot responses are, which tells its controls from the same ones of the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResponsePlace {
    /// That of the condition shown.
    #[default]
    Condition,
    /// That of every condition.
    EveryCondition,
    /// That of a model that was found in a file.
    FoundModel,
}

impl Default for BodeQuantity<'_> {
    fn default() -> Self {
        Self::RESPONSE
    }
}

impl BodeQuantity<'_> {
    /// Responses in decibels and degrees.
    pub const RESPONSE: BodeQuantity<'static> = Self::in_place(ResponsePlace::Condition);
    /// The same of every condition.
    pub const RESPONSE_OF_EVERY_CONDITION: BodeQuantity<'static> =
        Self::in_place(ResponsePlace::EveryCondition);
    /// The same of a model that was found in a file.
    pub const RESPONSE_OF_FOUND_MODEL: BodeQuantity<'static> =
        Self::in_place(ResponsePlace::FoundModel);

    const fn in_place(place: ResponsePlace) -> BodeQuantity<'static> {
        BodeQuantity::Response {
            magnitude: MagnitudeUnit::Decibel,
            phase: PhaseUnit::Unwrapped,
            ratio_unit: "",
            place,
        }
    }

    /// What tells this plot from the others: its widgets, its labels, and what stands behind the name of a pane and behind its place.
    fn words(self) -> [&'static str; 4] {
        match self {
            Self::Response {
                place: ResponsePlace::Condition,
                ..
            } => ["bode", "", "", " plot"],
            Self::Response {
                place: ResponsePlace::EveryCondition,
                ..
            } => [
                "airspeeds",
                ", plot of airspeeds",
                " in every condition",
                " plot of every condition",
            ],
            Self::Response {
                place: ResponsePlace::FoundModel,
                ..
            } => [
                "found model",
                ", plot of a found model",
                " of a found model",
                " plot of a found model",
            ],
            Self::Error { .. } => ["error", ", error plot", " error", " error plot"],
        }
    }

    /// Tells this plot's widgets from those of the others.
    pub(super) fn salt(self) -> &'static str {
        self.words()[0]
    }

    /// What tells labels of this plot from the same ones of the Bode plot.
    pub(super) fn label_suffix(self) -> &'static str {
        self.words()[1]
    }

    /// Whether it is of the condition shown, and not of others beside it or of a file.
    pub(crate) fn is_of_condition(self) -> bool {
        matches!(
            self,
            Self::Error { .. }
                | Self::Response {
                    place: ResponsePlace::Condition,
                    ..
                }
        )
    }

    /// What a pane shows: "Magnitude".
    pub(super) fn name(self, pane: Pane) -> String {
        format!("{pane:?}{}", self.words()[2])
    }

    /// A pane as part of a sentence: "magnitude plot".
    pub(super) fn place(self, pane: Pane) -> String {
        format!("{}{}", format!("{pane:?}").to_lowercase(), self.words()[3])
    }

    /// The unit that a pane is read in.
    pub(crate) fn unit(self, pane: Pane) -> ValueUnit {
        match (self, pane) {
            (
                Self::Response {
                    magnitude: MagnitudeUnit::Ratio,
                    ..
                },
                Pane::Magnitude,
            ) => ValueUnit::Ratio,
            (_, Pane::Magnitude) => ValueUnit::Decibel,
            (
                Self::Error {
                    phase: PhaseErrorUnit::Millisecond,
                },
                Pane::Phase,
            ) => ValueUnit::Millisecond,
            (_, Pane::Phase) => ValueUnit::Degree,
        }
    }

    /// What the numbers of a curve in a pane are, with the unit that they are drawn in.
    pub(crate) fn drawn_label(self, pane: Pane) -> String {
        match self {
            Self::Response { .. } => Self::RESPONSE.axis_label(pane),
            Self::Error { .. } => self.axis_label(pane),
        }
    }

    /// What stands beside a pane's axis.
    pub(super) fn axis_label(self, pane: Pane) -> String {
        match (self, pane) {
            (
                Self::Response {
                    magnitude: MagnitudeUnit::Ratio,
                    ratio_unit,
                    ..
                },
                Pane::Magnitude,
            ) => {
                format!("Magnitude [{ratio_unit}]")
            }
            (Self::Response { .. }, Pane::Magnitude) => "Magnitude [dB]".to_owned(),
            (Self::Response { .. }, Pane::Phase) => "Phase [deg]".to_owned(),
            (Self::Error { .. }, Pane::Magnitude) => "|ident.| / |model| [dB]".to_owned(),
            (
                Self::Error {
                    phase: PhaseErrorUnit::Degree,
                },
                Pane::Phase,
            ) => "Δφ [deg]".to_owned(),
            (
                Self::Error {
                    phase: PhaseErrorUnit::Millisecond,
                },
                Pane::Phase,
            ) => "Δφ/ω [ms]".to_owned(),
        }
    }

    /// The least height that fitting gives a pane.
    pub(super) fn least_height(self, pane: Pane) -> f64 {
        match (self, pane) {
            (Self::Response { .. }, Pane::Magnitude) => 4.0,
            (Self::Response { .. }, Pane::Phase) => 20.0,
            (Self::Error { .. }, Pane::Magnitude) => 1.0,
            (Self::Error { .. }, Pane::Phase) => 5.0,
        }
    }
}

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

    /// How its axis is told.
    pub(super) fn ticks(self) -> Ticks {
        match self {
            Self::Decibel | Self::Millisecond => Ticks::Decimal(VERTICAL_TICK_GAP),
            Self::Degree => Ticks::Degrees,
            Self::Ratio => Ticks::Ratio,
        }
    }
}

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
        let ticks = ValueUnit::Ratio.ticks();
        let drawn = ticks.place(2.0);
        // 20 log10 2, and one rounding of each function.
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
        let marks = ValueUnit::Ratio.ticks().spacer()(input);
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
