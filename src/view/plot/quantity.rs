//! What the two stacked panes show, and in which units.

use super::curve::Pane;
use super::value_unit::ValueUnit;
pub use gdcm_files::figure::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};

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

impl BodeQuantity<'_> {
    /// Responses in decibels and degrees.
    pub const RESPONSE: BodeQuantity<'static> = Self::in_place(ResponsePlace::Condition);
    /// The same of every condition.
    pub const RESPONSE_OF_EVERY_CONDITION: BodeQuantity<'static> = Self::in_place(ResponsePlace::EveryCondition);
    /// The same of a model that was found in a file.
    pub const RESPONSE_OF_FOUND_MODEL: BodeQuantity<'static> = Self::in_place(ResponsePlace::FoundModel);

    const fn in_place(place: ResponsePlace) -> BodeQuantity<'static> {
        BodeQuantity::Response { magnitude: MagnitudeUnit::Decibel, phase: PhaseUnit::Unwrapped, ratio_unit: "", place }
    }

    /// Tells this plot's widgets from those of the others.
    pub(super) fn salt(self) -> &'static str {
        match self {
            Self::Response { place: ResponsePlace::EveryCondition, .. } => "airspeeds",
            Self::Response { place: ResponsePlace::FoundModel, .. } => "found model",
            Self::Response { .. } => "bode",
            Self::Error { .. } => "error",
        }
    }

    /// What tells labels of this plot from the same ones of the Bode plot.
    pub(super) fn label_suffix(self) -> &'static str {
        match self {
            Self::Response { place: ResponsePlace::EveryCondition, .. } => ", plot of airspeeds",
            Self::Response { place: ResponsePlace::FoundModel, .. } => ", plot of a found model",
            Self::Response { .. } => "",
            Self::Error { .. } => ", error plot",
        }
    }

    /// What a pane shows: "Magnitude".
    pub(super) fn name(self, pane: Pane) -> &'static str {
        match (self, pane) {
            (Self::Response { place: ResponsePlace::EveryCondition, .. }, Pane::Magnitude) => {
                "Magnitude in every condition"
            }
            (Self::Response { place: ResponsePlace::FoundModel, .. }, Pane::Magnitude) => "Magnitude of a found model",
            (Self::Response { place: ResponsePlace::EveryCondition, .. }, Pane::Phase) => "Phase in every condition",
            (Self::Response { place: ResponsePlace::FoundModel, .. }, Pane::Phase) => "Phase of a found model",
            (Self::Response { .. }, Pane::Magnitude) => "Magnitude",
            (Self::Response { .. }, Pane::Phase) => "Phase",
            (Self::Error { .. }, Pane::Magnitude) => "Magnitude error",
            (Self::Error { .. }, Pane::Phase) => "Phase error",
        }
    }

    /// A pane as part of a sentence: "magnitude plot".
    pub(super) fn place(self, pane: Pane) -> &'static str {
        match (self, pane) {
            (Self::Response { place: ResponsePlace::EveryCondition, .. }, Pane::Magnitude) => {
                "magnitude plot of every condition"
            }
            (Self::Response { place: ResponsePlace::FoundModel, .. }, Pane::Magnitude) => {
                "magnitude plot of a found model"
            }
            (Self::Response { place: ResponsePlace::EveryCondition, .. }, Pane::Phase) => {
                "phase plot of every condition"
            }
            (Self::Response { place: ResponsePlace::FoundModel, .. }, Pane::Phase) => "phase plot of a found model",
            (Self::Response { .. }, Pane::Magnitude) => "magnitude plot",
            (Self::Response { .. }, Pane::Phase) => "phase plot",
            (Self::Error { .. }, Pane::Magnitude) => "magnitude error plot",
            (Self::Error { .. }, Pane::Phase) => "phase error plot",
        }
    }

    /// The unit that a pane is read in.
    pub(super) fn unit(self, pane: Pane) -> ValueUnit {
        match (self, pane) {
            (Self::Response { magnitude: MagnitudeUnit::Ratio, .. }, Pane::Magnitude) => ValueUnit::Ratio,
            (_, Pane::Magnitude) => ValueUnit::Decibel,
            (Self::Error { phase: PhaseErrorUnit::Millisecond }, Pane::Phase) => ValueUnit::Millisecond,
            (_, Pane::Phase) => ValueUnit::Degree,
        }
    }

    /// What stands above a column of values of a pane, or of their changes.
    pub(crate) fn column(self, pane: Pane, is_change: bool) -> &'static str {
        match (self.unit(pane), is_change) {
            (ValueUnit::Decibel, false) => "dB",
            (ValueUnit::Ratio, false) => "ratio",
            (ValueUnit::Degree, false) => "deg",
            (ValueUnit::Millisecond, false) => "ms",
            (ValueUnit::Decibel | ValueUnit::Ratio, true) => "Δ dB",
            (ValueUnit::Degree, true) => "Δ deg",
            (ValueUnit::Millisecond, true) => "Δ ms",
        }
    }

    /// Digits behind the point of a value of a pane.
    pub(crate) fn decimals(self, pane: Pane) -> usize {
        match (self, self.unit(pane)) {
            (_, ValueUnit::Ratio) => 3,
            (Self::Error { .. }, ValueUnit::Decibel) => 2,
            (Self::Response { .. }, ValueUnit::Degree) => 0,
            _ => 1,
        }
    }

    /// A drawn value of a pane in the unit that it is read in.
    pub(crate) fn shown_value(self, pane: Pane, value: f64) -> f64 {
        self.unit(pane).of_drawn(value)
    }

    /// What the numbers of a curve in a pane are, with the unit that they are drawn in.
    pub(crate) fn drawn_label(self, pane: Pane) -> String {
        match self {
            Self::Response { phase, .. } => Self::Response {
                magnitude: MagnitudeUnit::Decibel,
                phase,
                ratio_unit: "",
                place: ResponsePlace::Condition,
            }
            .axis_label(pane),
            Self::Error { .. } => self.axis_label(pane),
        }
    }

    /// What stands beside a pane's axis.
    pub(super) fn axis_label(self, pane: Pane) -> String {
        match (self, pane) {
            (Self::Response { magnitude: MagnitudeUnit::Ratio, ratio_unit, .. }, Pane::Magnitude) => {
                format!("Magnitude [{ratio_unit}]")
            }
            (Self::Response { .. }, Pane::Magnitude) => "Magnitude [dB]".to_owned(),
            (Self::Response { .. }, Pane::Phase) => "Phase [deg]".to_owned(),
            (Self::Error { .. }, Pane::Magnitude) => "|ident.| / |model| [dB]".to_owned(),
            (Self::Error { phase: PhaseErrorUnit::Degree }, Pane::Phase) => "Δφ [deg]".to_owned(),
            (Self::Error { phase: PhaseErrorUnit::Millisecond }, Pane::Phase) => "Δφ/ω [ms]".to_owned(),
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
