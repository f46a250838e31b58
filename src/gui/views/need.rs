//! Background results that a view needs in addition to the current analysis.

use std::sync::Arc;

use gdcm_study::Analysis;
use gdcm_study::jobs::across_job::AcrossJob;
use gdcm_study::jobs::analysis_jobs::{AssessmentJob, CouplingsJob, PhysicsJob, VariantJob};
use gdcm_study::jobs::curve_jobs::ModesJob;
use gdcm_study::jobs::identification_jobs::SimulationJob;
use gdcm_study::jobs::requirement_jobs::{
    RecordHistoryJob, RequirementsJob, TestAnswersJob, TimeHistoriesJob,
};

use crate::gui::state::window_state::State;

#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// All models' modes in the displayed condition.
    Modes(ModesJob),
    Assessment(AssessmentJob),
    /// Models' responses in each condition.
    Across(AcrossJob),
    Variant(VariantJob),
    /// Simulated response to a record.
    Simulation(SimulationJob),
    Couplings(CouplingsJob),
    Physics(PhysicsJob),
    Requirements(RequirementsJob),
    /// Models' responses to the test input.
    TestAnswers(TestAnswersJob),
    /// Models' responses to a flight record.
    RecordHistory(RecordHistoryJob),
    /// Models' responses to the held-out flight records.
    TimeHistories(TimeHistoriesJob),
}

/// Returns the newest analysis, which may be older than the settings; `None` before the first, or
/// if it belongs to another dataset.
pub fn current_analysis(state: &State) -> Option<Arc<Analysis>> {
    state.analysis()?;
    state.results.analysis.clone()
}
