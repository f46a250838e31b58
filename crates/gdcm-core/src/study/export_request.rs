//! What is to be exported.

use crate::correction::Pade;
use crate::dataset::ConditionId;

use super::assessment_table::AssessedCorrection;
use super::export_format::ExportFormat;

/// Which physics model of a condition is exported.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ExportedRole {
    /// The one at the condition's own trim.
    #[default]
    Nominal,
    /// The one that represents its bundle.
    Representative,
    /// The one of this name.
    Named(String),
}

/// What is to be exported, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportRequest {
    /// As what.
    pub format: ExportFormat,
    /// Airspeeds of a lookup table \[kt\]; none for the distinct airspeeds of the scheduled conditions.
    pub breakpoints_kt: Option<Vec<f64>>,
    /// The condition whose corrected model is exported; none for every one.
    pub condition: Option<ConditionId>,
    /// Which of its models.
    pub role: ExportedRole,
    /// Under which correction.
    pub correction: AssessedCorrection,
    /// What its delays are approximated by.
    pub pade: Pade,
}

impl ExportRequest {
    /// A format, with what is usual of everything else: nominal models under the schedule, delays in second order.
    pub fn new(format: ExportFormat) -> Self {
        Self {
            format,
            breakpoints_kt: None,
            condition: None,
            role: ExportedRole::Nominal,
            correction: AssessedCorrection::Scheduled,
            pade: Pade::default(),
        }
    }
}
