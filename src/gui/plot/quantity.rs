//! Quantities and units in the two stacked panes. M4 and M6 are sections of docs/method.md.

pub use gdcm_plot::figure::axis::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};

use super::drawn_curves::Pane;
use super::value_unit::ValueUnit;

/// Quantity shown by the two stacked panes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodeQuantity<'a> {
    /// Responses: magnitudes above, phases below.
    Response {
        magnitude: MagnitudeUnit,
        phase: PhaseUnit,
        /// Output unit over input unit, such as "(deg/s)/in".
        ratio_unit: &'a str,
        subject: ResponseSubject,
    },
    /// Ratio and phase difference that enter the cost J (M4): `20 log10(|H_ref| / |H_sim|)` above,
    /// phase difference between `H_ref` and `H_sim` below (M6). `H_ref` is the identified response,
    /// `H_sim` a physics model's response.
    Error { phase: PhaseErrorUnit },
    /// Scheduled minus identified response in every condition.
    ScheduleError,
}

/// Subject of a response plot, which distinguishes its controls from those in other plots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResponseSubject {
    /// The displayed condition.
    #[default]
    Condition,
    /// Every condition, in the plot across conditions.
    EveryCondition,
    /// A model found in a file.
    FoundModel,
}

/// Texts that distinguish a plot's controls from those in other plots.
struct PlotNames {
    /// Id salt for the plot's widgets.
    salt: &'static str,
    /// Suffix for the labels of controls.
    label_suffix: &'static str,
    /// Suffix for pane names.
    pane_suffix: &'static str,
    /// Suffix for pane names within a sentence.
    sentence_suffix: &'static str,
}

const CONDITION_NAMES: PlotNames = PlotNames {
    salt: "bode",
    label_suffix: "",
    pane_suffix: "",
    sentence_suffix: " plot",
};
const EVERY_CONDITION_NAMES: PlotNames = PlotNames {
    salt: "airspeeds",
    label_suffix: ", plot of every condition",
    pane_suffix: " in every condition",
    sentence_suffix: " plot of every condition",
};
const FOUND_MODEL_NAMES: PlotNames = PlotNames {
    salt: "found model",
    label_suffix: ", plot of a model in the files",
    pane_suffix: " of a model in the files",
    sentence_suffix: " plot of a model in the files",
};
const SCHEDULE_ERROR_NAMES: PlotNames = PlotNames {
    salt: "schedule error",
    label_suffix: ", error of the schedule",
    pane_suffix: " error in every condition",
    sentence_suffix: " error of the schedule",
};
const ERROR_NAMES: PlotNames = PlotNames {
    salt: "error",
    label_suffix: ", error plot",
    pane_suffix: " error",
    sentence_suffix: " error plot",
};

impl Default for BodeQuantity<'_> {
    fn default() -> Self {
        Self::RESPONSE
    }
}

impl BodeQuantity<'_> {
    /// Responses in the displayed condition, in decibels and degrees.
    pub const RESPONSE: BodeQuantity<'static> = Self::with_subject(ResponseSubject::Condition);
    /// Responses in every condition, in decibels and degrees.
    pub const RESPONSE_OF_EVERY_CONDITION: BodeQuantity<'static> =
        Self::with_subject(ResponseSubject::EveryCondition);
    /// Responses from a model found in a file, in decibels and degrees.
    pub const RESPONSE_OF_FOUND_MODEL: BodeQuantity<'static> =
        Self::with_subject(ResponseSubject::FoundModel);

    const fn with_subject(subject: ResponseSubject) -> BodeQuantity<'static> {
        BodeQuantity::Response {
            magnitude: MagnitudeUnit::Decibel,
            phase: PhaseUnit::Unwrapped,
            ratio_unit: "",
            subject,
        }
    }

    /// Returns the texts that distinguish this plot from others.
    fn names(self) -> PlotNames {
        let subject = match self {
            Self::Response { subject, .. } => subject,
            Self::Error { .. } => return ERROR_NAMES,
            Self::ScheduleError => return SCHEDULE_ERROR_NAMES,
        };
        match subject {
            ResponseSubject::Condition => CONDITION_NAMES,
            ResponseSubject::EveryCondition => EVERY_CONDITION_NAMES,
            ResponseSubject::FoundModel => FOUND_MODEL_NAMES,
        }
    }

    /// Returns the id salt that distinguishes this plot's widgets from others.
    pub(super) fn salt(self) -> &'static str {
        self.names().salt
    }

    /// Returns the suffix that distinguishes this plot's labels from those in the Bode plot.
    pub(super) fn label_suffix(self) -> &'static str {
        self.names().label_suffix
    }

    /// Returns whether the plot shows the displayed condition, rather than a comparison across
    /// conditions or a model found in a file.
    pub(crate) fn is_of_condition(self) -> bool {
        matches!(
            self,
            Self::Error { .. }
                | Self::Response {
                    subject: ResponseSubject::Condition,
                    ..
                }
        )
    }

    /// Returns a pane's name, such as "Magnitude".
    pub(super) fn name(self, pane: Pane) -> String {
        format!("{pane:?}{}", self.names().pane_suffix)
    }

    /// Returns a pane's name within a sentence, such as "magnitude plot".
    pub(super) fn name_in_sentence(self, pane: Pane) -> String {
        let pane = format!("{pane:?}").to_lowercase();
        format!("{pane}{}", self.names().sentence_suffix)
    }

    /// Returns a pane's display unit.
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

    /// Returns the label for a pane's values as the curves hold them: responses always in \[dB\]
    /// and \[deg\].
    pub(crate) fn drawn_label(self, pane: Pane) -> String {
        match self {
            Self::Response { .. } => Self::RESPONSE.axis_label(pane),
            Self::Error { .. } | Self::ScheduleError => self.axis_label(pane),
        }
    }

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
            (Self::ScheduleError, Pane::Magnitude) => "Error of magnitude [dB]".to_owned(),
            (Self::ScheduleError, Pane::Phase) => "Error of phase [deg]".to_owned(),
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

    /// Returns the minimum height that a pane shows after fitting \[dB\], \[deg\] or \[ms\].
    pub(super) fn least_height(self, pane: Pane) -> f64 {
        match (self, pane) {
            (Self::Response { .. }, Pane::Magnitude) => 4.0,
            (Self::Response { .. }, Pane::Phase) => 20.0,
            (Self::Error { .. } | Self::ScheduleError, Pane::Magnitude) => 1.0,
            (Self::Error { .. } | Self::ScheduleError, Pane::Phase) => 5.0,
        }
    }
}
