//! Options for displaying the assessment: model, correction, responses, bars or table.

use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::CostChange;
use gdcm_study::AssessedCorrection;
use gdcm_study::results::assessment_table::AssessedModel;

/// Responses shown by an assessment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AssessedPairs {
    /// On-axis responses (Figures 8 to 12 in the paper).
    #[default]
    OnAxis,
    /// Off-axis responses (Figures 13 to 19 in the paper).
    OffAxis,
    /// Response in focus.
    Focused,
    All,
}

/// Part of J whose change the assessment table shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CostPart {
    #[default]
    Total,
    Magnitude,
    Phase,
}

impl CostPart {
    /// Returns the symbol: "ΔJ", "ΔJ mag" or "ΔJ phase".
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Total => "ΔJ",
            Self::Magnitude => "ΔJ mag",
            Self::Phase => "ΔJ phase",
        }
    }

    /// Returns the function that extracts this part from a change in J.
    pub fn extractor(self) -> fn(CostChange) -> f64 {
        match self {
            Self::Total => CostChange::total,
            Self::Magnitude => CostChange::magnitude,
            Self::Phase => CostChange::phase,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AssessmentDisplay {
    pub model: AssessedModel,
    /// Correction applied to the model.
    pub correction: AssessedCorrection,
    /// Averaging of the squared errors over frequency; `None` follows the settings.
    pub average: Option<CostAverage>,
    pub pairs: AssessedPairs,
    /// Whether a table is shown; otherwise bars.
    pub as_table: bool,
    /// Part of J whose change the table shows.
    pub part: CostPart,
}
