//! Background results that a view needs besides the live answer.

use gdcm_study::jobs::job::{AcrossJob, ModesJob, SimulationJob, VariantJob};
use gdcm_study::results::assessment_table::AssessmentJob;
use gdcm_study::results::condition_answers::{RecordHistoryJob, TestAnswersJob};
use gdcm_study::results::couplings_assessment::CouplingsJob;
use gdcm_study::results::requirements_tables::RequirementsJob;
use gdcm_study::results::time_histories::TimeHistoriesJob;

/// Computation needed by a view besides the live answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// Modes for all models in the condition.
    Modes(ModesJob),
    Assessment(AssessmentJob),
    /// Responses from a model in each condition.
    Across(AcrossJob),
    Variant(VariantJob),
    /// Simulated response to a record.
    Simulation(SimulationJob),
    Couplings(CouplingsJob),
    Requirements(RequirementsJob),
    /// Models' responses to the test input.
    TestAnswers(TestAnswersJob),
    /// Models' responses to a flight record.
    RecordHistory(RecordHistoryJob),
    /// Models' responses to all flight records.
    TimeHistories(TimeHistoriesJob),
}
