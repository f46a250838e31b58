//! What was computed, and what is being computed.

use std::sync::Arc;

use gdcm_core::correction::Problem;
use gdcm_core::dataset::{ConditionId, Dataset};
use gdcm_core::identification::Validation;
use gdcm_core::study::{
    AcrossCurves, AcrossJob, Analysis, AssessedCouplings, AssessmentJob, AssessmentTable, ConditionAnalysis,
    ConditionCurves, ConditionFailure, ConditionModes, CouplingsJob, CurvesJob, ModesJob, RecordHistory,
    RecordHistoryJob, Requirements, RequirementsJob, SimulationJob, TestAnswers, TestAnswersJob, TimeHistories,
    TimeHistoriesJob, Toggles, TogglesJob, Uncertainty, UncertaintyJob, VariantJob,
};

/// The result of the condition shown, ahead of the others'.
#[derive(Clone, Debug)]
pub struct FirstResult {
    /// Number of the request it answers.
    pub generation: u64,
    /// The dataset it belongs to.
    pub dataset: Arc<Dataset>,
    /// The condition.
    pub condition: ConditionId,
    /// The result.
    pub outcome: Result<ConditionAnalysis, ConditionFailure>,
}

/// What is under way beside the live answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Background {
    /// Whether the live answer is being computed: steps done, of how many.
    pub analysis: Option<(usize, usize)>,
    /// The problems whose gains are being proven, or are to be.
    pub proofs: Vec<Arc<Problem>>,
    /// Whether the costs of holding and freeing are being computed.
    pub toggles: bool,
    /// Whether curves are being computed: models done, of how many.
    pub curves: Option<(usize, usize)>,
    /// Whether error bars are being computed: steps done, of how many (for each model its response, and the analysis with it in place
    /// of the representative).
    pub bars: Option<(usize, usize)>,
    /// Whether models answer to all records: steps done, of how many.
    pub time_histories: Option<(usize, usize)>,
    /// Jobs that the views shown wait for.
    pub views: usize,
    /// Whether a report is being written: conditions done, of how many.
    pub report: Option<(usize, usize)>,
    /// Whether models are being identified: parts done, of how many.
    pub identification: Option<(usize, usize)>,
    /// Whether something of it was stopped, by hand or by a fault.
    pub stopped: bool,
}

impl Background {
    /// Whether anything is under way.
    pub fn is_busy(&self) -> bool {
        !self.proofs.is_empty()
            || self.toggles
            || self.curves.is_some()
            || self.bars.is_some()
            || self.time_histories.is_some()
            || self.views > 0
            || self.report.is_some()
            || self.identification.is_some()
    }
}

/// What was computed; never saved.
#[derive(Debug, Default)]
pub struct Results {
    /// The newest analysis.
    pub analysis: Option<Arc<Analysis>>,
    /// The condition shown, where it is ahead of that analysis.
    pub first: Option<FirstResult>,
    /// What holding or freeing each response of a condition would cost, and of which; see [`super::state::State::toggles`].
    pub toggles: Option<(TogglesJob, Arc<Toggles>)>,
    /// Responses for drawing, and of what; see [`super::state::State::curves`].
    pub curves: Option<(CurvesJob, Arc<ConditionCurves>)>,
    /// Modes of the models of one condition, and of which; see [`super::state::State::modes`].
    pub modes: Option<(ModesJob, Arc<ConditionModes>)>,
    /// The assessment that is asked for, and of what; see [`super::state::State::assessment`].
    pub assessment: Option<(AssessmentJob, Arc<AssessmentTable>)>,
    /// Responses of one model of each condition, and of which; see [`super::state::State::across`].
    pub across: Option<(AcrossJob, Arc<AcrossCurves>)>,
    /// How sure the values of an analysis are, and of which; see [`super::state::State::uncertainty`].
    pub uncertainty: Option<(UncertaintyJob, Arc<Uncertainty>)>,
    /// What couplings do, or would do, and to what; see [`super::state::State::couplings`].
    pub couplings: Option<(CouplingsJob, AssessedCouplings)>,
    /// What a qualification asks, and of what; see [`super::state::State::requirements`].
    pub requirements: Option<(RequirementsJob, Arc<Requirements>)>,
    /// What models answer to the test input, and of which condition; see [`super::state::State::test_answers`].
    pub test_answers: Option<(TestAnswersJob, Result<Arc<TestAnswers>, String>)>,
    /// One record against the tolerances; see [`super::state::State::record_history`].
    pub record_history: Option<(RecordHistoryJob, Result<Arc<RecordHistory>, String>)>,
    /// What the models answer to all records, and of what; see [`super::state::State::time_histories`].
    pub time_histories: Option<(TimeHistoriesJob, Arc<TimeHistories>)>,
    /// Analyses of the variants.
    pub variants: Vec<(VariantJob, Arc<Analysis>)>,
    /// Models against a record in time, or in words why not.
    pub simulations: Vec<(SimulationJob, Result<Arc<Validation>, String>)>,
    /// What is under way beside the live answer.
    pub background: Background,
    /// Since when something has been \[s of the window's clock\].
    pub background_since: Option<f64>,
    /// Number of the newest request.
    pub requested: u64,
    /// Number of the request the analysis answers.
    pub received: u64,
    /// When the oldest request without an answer was made \[s of the window's clock\].
    pub waiting_since: Option<f64>,
    /// Whether a frame with an analysis has been on the screen.
    pub is_painted: bool,
    /// How long the newest analysis took \[ms\].
    pub elapsed_ms: f64,
    /// Whether the newest request was given up, by hand or by a fault: what is shown stays older than the settings.
    pub stopped: bool,
}

/// Age \[s\] from which shown results that no longer fit the settings are marked as stale.
const STALE_AFTER_S: f64 = 0.15;
/// Time \[s\] from which work beside the live answer is told: most of it is over before it could be read.
const BACKGROUND_AFTER_S: f64 = 0.5;

impl Results {
    /// Whether an answer is still to come.
    pub fn is_waiting(&self) -> bool {
        self.is_behind() && !self.stopped
    }

    /// What stands in the place of a result that is not there.
    pub fn absence(&self) -> &'static str {
        if self.stopped { "not computed" } else { "computing …" }
    }

    /// What stands in the place of error bars that are not there.
    pub fn absence_of_bars(&self) -> String {
        match self.background.bars {
            Some(progress) if !self.is_behind() => bar_words(progress),
            None if self.background.stopped => "Error bars: stopped; Compute, below, goes on with them".to_owned(),
            _ => self.absence().to_owned(),
        }
    }

    /// Whether what is shown is older than the settings.
    pub fn is_behind(&self) -> bool {
        self.requested > self.received
    }

    /// Whether the condition shown is of newer settings than the analysis of all of them.
    pub fn first_is_ahead(&self) -> bool {
        self.analysis.is_some() && self.first.as_ref().is_some_and(|first| first.generation > self.received)
    }

    /// Whether something has been under way beside the live answer for so long that it should be told at `now`.
    pub fn is_background_told(&self, now: f64) -> bool {
        self.background_since.is_some_and(|since| now - since > BACKGROUND_AFTER_S)
    }

    /// Whether what is shown should be marked as stale at `now` \[s of the window's clock\].
    pub fn is_stale(&self, now: f64) -> bool {
        self.stopped || self.waiting_since.is_some_and(|since| now - since > STALE_AFTER_S)
    }
}

/// How far error bars are, in words.
pub(super) fn bar_words((done, total): (usize, usize)) -> String {
    if total == 0 { "error bars …".to_owned() } else { format!("error bars, {done} of {total} steps …") }
}
