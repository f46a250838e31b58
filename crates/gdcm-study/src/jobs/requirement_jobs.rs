//! Jobs for requirements: findings without records, time histories, test input responses.
//!
//! A [`Job`] is a long computation in parallel to the interactive analysis. Jobs are equal if they
//! have the same output, so that a comparison leaves out what does not affect it; `Tools` are kept
//! from one job to the next.

use std::sync::Arc;

use gdcm_method::requirements::{TestInput, ToleranceTable};
use gdcm_model::dataset::ConditionId;
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_sysid::identification::Preparation;

use super::job::Job;
use crate::decisions::requirement_settings::RequirementSettings;
use crate::execution::Execution;
use crate::results::analysis::{Analysis, NoResult};
use crate::results::record_history::{ComparedRecord, NoRecordHistory, RecordHistory};
use crate::results::record_simulations::time_histories_of;
use crate::results::required_modes::IdentifiedPoles;
use crate::results::requirements::{Requirements, requirements_of};
use crate::results::test_input_responses::TestAnswers;
use crate::results::time_histories::{HistoryRecord, HistoryRecords, TimeHistories};
use crate::results::uncertainty::Uncertainty;
use crate::shared::Shared;

/// Job that checks the requirements on an analysis's models, with error bars if they were computed.
#[derive(Clone, Debug, PartialEq)]
pub struct RequirementsJob {
    pub analysis: Shared<Analysis>,
    /// Error bars for the analysis's values.
    pub uncertainty: Option<Shared<Uncertainty>>,
    /// Requirement settings, on which the analysis does not depend.
    pub settings: Arc<RequirementSettings>,
    pub identified_poles: IdentifiedPoles,
}

impl Job for RequirementsJob {
    type Tools = Box<dyn Executor>;
    type Output = Arc<Requirements>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let analysis = Analysis {
            uncertainty: self.uncertainty.as_deref().cloned(),
            ..self.analysis.with_requirements(&self.settings)
        };
        let execution = Execution::new(executor.as_ref(), progress, analysis.conditions.len());
        let requirements = requirements_of(&analysis, &self.identified_poles, &execution)?;
        Ok(Arc::new(requirements))
    }
}

/// Job that compares flight records with an analysis's models.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeHistoriesJob {
    pub analysis: Shared<Analysis>,
    /// Flight records, condition by condition.
    pub records: Vec<HistoryRecords>,
    pub tolerances: ToleranceTable,
}

impl Job for TimeHistoriesJob {
    type Tools = Box<dyn Executor>;
    type Output = Arc<TimeHistories>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let steps = HistoryRecords::steps(&self.records);
        let execution = Execution::new(executor.as_ref(), progress, steps);
        let histories =
            time_histories_of(&self.analysis, &self.records, &self.tolerances, &execution)?;
        Ok(Arc::new(histories))
    }
}

/// Job that compares a flight record with its condition's models, and the differences with the
/// tolerances.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordHistoryJob {
    pub analysis: Shared<Analysis>,
    pub condition: ConditionId,
    pub record: HistoryRecord,
    pub preparation: Preparation,
    pub tolerances: ToleranceTable,
}

impl Job for RecordHistoryJob {
    type Tools = Box<dyn Executor>;
    type Output = Result<Arc<RecordHistory>, NoRecordHistory>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let compared = ComparedRecord {
            condition: self.condition,
            record: &self.record,
            preparation: &self.preparation,
            tolerances: &self.tolerances,
        };
        let history = RecordHistory::new(&self.analysis, &compared, executor.as_ref());
        if progress.cancelled() {
            return Err(Cancelled);
        }
        Ok(history.map(Arc::new))
    }
}

/// Job that simulates a condition's models with the study's test input.
#[derive(Clone, Debug, PartialEq)]
pub struct TestAnswersJob {
    pub analysis: Shared<Analysis>,
    pub condition: ConditionId,
    pub input: usize,
    /// Test input: shape, amplitude and duration.
    pub test: TestInput,
}

impl Job for TestAnswersJob {
    type Tools = Box<dyn Executor>;
    type Output = Result<Arc<TestAnswers>, NoResult>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let answers = TestAnswers::new(
            &self.analysis,
            self.condition,
            self.input,
            self.test,
            executor.as_ref(),
        );
        if progress.cancelled() {
            return Err(Cancelled);
        }
        Ok(answers.map(Arc::new))
    }
}
