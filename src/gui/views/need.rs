//! Background results that a view needs besides the live answer.

use gdcm_study::jobs::analysis_jobs::{AssessmentJob, CouplingsJob, VariantJob};
use gdcm_study::jobs::curve_jobs::{AcrossJob, ModesJob};
use gdcm_study::jobs::identification_jobs::SimulationJob;
use gdcm_study::jobs::requirement_jobs::{
    RecordHistoryJob, RequirementsJob, TestAnswersJob, TimeHistoriesJob,
};

/// Computation needed by a view besides the live answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// Modes of the condition's models.
    Modes(ModesJob),
    Assessment(AssessmentJob),
    /// A model of each condition.
    Across(AcrossJob),
    /// Analysis of a variant.
    Variant(VariantJob),
    /// Comparison of a model with a record in time.
    Simulation(SimulationJob),
    /// Effect of couplings.
    Couplings(CouplingsJob),
    Requirements(RequirementsJob),
    /// Models' responses to the test input.
    TestAnswers(TestAnswersJob),
    /// Models' responses to a flight record.
    RecordHistory(RecordHistoryJob),
    /// Models' responses to all flight records.
    TimeHistories(TimeHistoriesJob),
}
