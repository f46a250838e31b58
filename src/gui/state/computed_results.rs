//! Computed results with their jobs, and how far the requests for them have come.
//!
//! A job holds the inputs of a computation; a result is kept with its job, which says to what the
//! result belongs.
//!
//! Each change to the study or to the displayed condition makes a request with a new, greater
//! number. Its analysis arrives later: until `received` equals `requested`, the displayed results
//! are older than the settings. If the request has been stopped, `stopped` is set, and no analysis
//! will arrive. `Background::stopped` says whether other jobs were stopped.
//!
//! Most results may be older than the displayed study: read them through the methods of `State` in
//! `shown_results.rs`, which return a result only where it is still valid.

use std::sync::Arc;

use gdcm_method::correction::problem::ProblemError;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::simulation::Validation;
use gdcm_study::jobs::across_job::{AcrossCurves, AcrossJob};
use gdcm_study::jobs::analysis_jobs::{
    AssessmentJob, CouplingsJob, PhysicsJob, Toggles, TogglesJob, UncertaintyJob, VariantJob,
};
use gdcm_study::jobs::curve_jobs::{ConditionModes, CurvesJob, ModesJob};
use gdcm_study::jobs::identification_jobs::{SimulationFailure, SimulationJob};
use gdcm_study::jobs::requirement_jobs::{
    RecordHistoryJob, RequirementsJob, TestAnswersJob, TimeHistoriesJob,
};
use gdcm_study::jobs::trade_off_job::{TradeOff, TradeOffJob};
use gdcm_study::results::analysis::{ConditionFailure, NoResult};
use gdcm_study::results::couplings_assessment::AssessedCouplings;
use gdcm_study::results::physics_assessment::AssessedPhysics;
use gdcm_study::results::record_history::{NoRecordHistory, RecordHistory};
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::test_input_responses::TestAnswers;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::{Analysis, AssessmentTable, ConditionAnalysis};

use super::background::{Background, error_bar_progress};

/// Age \[s\] from which results for older settings are marked as stale: the marks do not flicker
/// while an analysis takes less.
const STALE_AFTER_S: f64 = 0.15;
/// Waiting time \[s\] after which a spinner is displayed, somewhat after the marks for stale
/// results.
const SPINS_AFTER_S: f64 = 0.3;
/// Duration \[s\] after which background work is displayed: most jobs end before a display could be
/// read.
const BACKGROUND_AFTER_S: f64 = 0.5;

/// The displayed condition's result, available before those in the other conditions.
#[derive(Clone, Debug)]
pub struct FirstResult {
    /// Number of the request that produced the result.
    pub request: u64,
    /// Dataset to which the result belongs.
    pub dataset: Arc<Dataset>,
    pub condition: ConditionId,
    pub outcome: Result<ConditionAnalysis, ConditionFailure>,
}

/// Computed results; never saved.
#[derive(Debug, Default)]
pub struct Results {
    pub analysis: Option<Arc<Analysis>>,
    /// The displayed condition's newer result, computed before the other conditions, while
    /// `analysis` is older.
    pub first: Option<FirstResult>,
    /// Costs of constraining or releasing each response, with their job; see `State::toggles`.
    pub toggles: Option<(TogglesJob, Arc<Toggles>)>,
    /// The displayed condition's frequency responses, with their job; see `State::responses`.
    pub curves: Option<(CurvesJob, Arc<ConditionCurves>)>,
    /// Modes by model, with their job; see `State::modes`.
    pub modes: Option<(ModesJob, Arc<ConditionModes>)>,
    /// Requested assessment, with its job; see `State::assessment`.
    pub assessment: Option<(AssessmentJob, Arc<AssessmentTable>)>,
    /// Responses across conditions, with their job; see `State::across`.
    pub across: Option<(AcrossJob, Arc<AcrossCurves>)>,
    /// Trade-off over α in the displayed condition, with its job; see `State::trade_off`.
    pub trade_off: Option<(TradeOffJob, Result<Arc<TradeOff>, ProblemError>)>,
    /// Uncertainty, with its job; see `State::uncertainty`.
    pub uncertainty: Option<(UncertaintyJob, Arc<Uncertainty>)>,
    /// Benefit of the couplings, whether or not they are in use, with the job; see
    /// `State::couplings`.
    pub couplings: Option<(CouplingsJob, AssessedCouplings)>,
    /// Diagnosis with the physics parameters and their benefit, with the job; see `State::physics`.
    pub physics: Option<(PhysicsJob, Option<AssessedPhysics>)>,
    /// Requirements, with their job; see `State::requirements`.
    pub requirements: Option<(RequirementsJob, Arc<Requirements>)>,
    /// Responses to the test input, with their job; see `State::test_answers`.
    pub test_answers: Option<(TestAnswersJob, Result<Arc<TestAnswers>, NoResult>)>,
    /// A record compared with the tolerances, with its job; see `State::record_history`.
    pub record_history: Option<(
        RecordHistoryJob,
        Result<Arc<RecordHistory>, NoRecordHistory>,
    )>,
    /// Models' responses to the held-out records, with their job; see `State::time_histories`.
    pub time_histories: Option<(TimeHistoriesJob, Arc<TimeHistories>)>,
    pub variants: Vec<(VariantJob, Arc<Analysis>)>,
    /// Models compared with a record in the time domain, or the reasons why this failed.
    pub simulations: Vec<(SimulationJob, Result<Arc<Validation>, SimulationFailure>)>,
    pub background: Background,
    /// When the background work started \[s, window clock\].
    pub background_since: Option<f64>,
    /// Number of the newest request.
    pub requested: u64,
    /// Number of the request that produced the analysis.
    pub received: u64,
    /// When the oldest request without a result was made \[s, window clock\].
    pub waiting_since: Option<f64>,
    /// Whether a frame with an analysis has been painted.
    pub is_painted: bool,
    /// Computing time for the newest analysis \[ms\].
    pub elapsed_ms: f64,
    /// Whether the newest request was stopped, by the engineer or by a fault. The displayed results
    /// then remain older than the settings.
    pub stopped: bool,
}

impl Results {
    /// Returns whether results for the newest request are pending.
    pub fn is_waiting(&self) -> bool {
        self.is_behind() && !self.stopped
    }

    /// Returns the message that explains a missing result.
    pub fn absence(&self) -> &'static str {
        if self.stopped || (self.background.stopped && !self.is_behind()) {
            "stopped; choose Compute"
        } else {
            "computing …"
        }
    }

    /// Returns the message that explains missing error bars: their progress, once the analysis is
    /// up to date; else that they were stopped; else that the analysis is missing.
    pub fn absence_of_error_bars(&self) -> String {
        match self.background.error_bars {
            Some(steps) if !self.is_behind() => error_bar_progress(steps),
            None if self.background.stopped => {
                "Error bars stopped; choose Compute below to continue".to_owned()
            }
            _ => self.absence().to_owned(),
        }
    }

    /// Returns whether the displayed results are older than the settings.
    pub fn is_behind(&self) -> bool {
        self.requested > self.received
    }

    /// Returns whether the displayed condition's result belongs to newer settings than the analysis
    /// of all conditions.
    pub fn first_is_ahead(&self) -> bool {
        match &self.first {
            Some(first) => self.analysis.is_some() && first.request > self.received,
            None => false,
        }
    }

    /// Returns whether background work has lasted long enough at `now` \[s, window clock\] to be
    /// displayed.
    pub fn shows_background(&self, now: f64) -> bool {
        match self.background_since {
            Some(since) => now - since > BACKGROUND_AFTER_S,
            None => false,
        }
    }

    /// Returns whether a spinner is displayed at `now` \[s, window clock\].
    pub fn spins(&self, now: f64) -> bool {
        match self.waiting_since {
            Some(since) => self.is_waiting() && now - since > SPINS_AFTER_S,
            None => false,
        }
    }

    /// Returns whether the displayed results should be marked as stale at `now` \[s, window
    /// clock\].
    pub fn is_stale(&self, now: f64) -> bool {
        let is_late = match self.waiting_since {
            Some(since) => now - since > STALE_AFTER_S,
            None => false,
        };
        self.stopped || is_late
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spinner_appears_only_after_a_while_and_not_after_a_stop() {
        let mut results = Results {
            requested: 1,
            waiting_since: Some(10.0),
            ..Results::default()
        };
        assert!(!results.spins(10.29) && results.spins(10.31));
        results.stopped = true;
        assert!(!results.spins(11.0));
        results = Results::default();
        assert!(!results.spins(11.0), "nothing is awaited");
    }
}
