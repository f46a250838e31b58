//! Computed results, and the work in progress on them.

use std::sync::Arc;

use gdcm_method::correction::Problem;
use gdcm_method::uncertainty::{Bar as ErrorBar, Scalar};
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::simulation::Validation;
use gdcm_study::jobs::analysis_jobs::{
    AssessmentJob, CouplingsJob, Toggles, TogglesJob, UncertaintyJob, VariantJob,
};
use gdcm_study::jobs::curve_jobs::{AcrossCurves, AcrossJob, ConditionModes, CurvesJob, ModesJob};
use gdcm_study::jobs::identification_jobs::{SimulationFailure, SimulationJob};
use gdcm_study::jobs::requirement_jobs::{
    RecordHistoryJob, RequirementsJob, TestAnswersJob, TimeHistoriesJob,
};
use gdcm_study::results::analysis::{ConditionFailure, NoResult};
use gdcm_study::results::condition_answers::{NoRecordHistory, RecordHistory, TestAnswers};
use gdcm_study::results::couplings_assessment::AssessedCouplings;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::{Analysis, AssessmentTable, ConditionAnalysis};

/// Uncertainty of the values in the displayed condition.
#[derive(Clone, Copy, Debug)]
pub struct Sureness<'a> {
    pub condition: ConditionId,
    pub uncertainty: Option<&'a Uncertainty>,
}

impl<'a> Sureness<'a> {
    /// Returns the error bar of a value with its confidence level; `None` if it is not available.
    pub fn bar(&self, scalar: Scalar) -> Option<(&'a ErrorBar, f64)> {
        let uncertainty = self.uncertainty?;
        Some((uncertainty.bar(self.condition, scalar)?, uncertainty.level))
    }

    /// Returns the half-width of a value's error bar: a ratio, or \[s\] for delays.
    pub fn half(&self, scalar: Scalar) -> Option<f64> {
        let (bar, level) = self.bar(scalar)?;
        bar.half_width(level)
    }

    /// Returns the confidence level, common to all error bars.
    pub fn level(&self) -> Option<f64> {
        self.uncertainty.map(|uncertainty| uncertainty.level)
    }
}

/// Result of the displayed condition, available before the results of the other conditions.
#[derive(Clone, Debug)]
pub struct FirstResult {
    /// Number of the request that produced the result.
    pub generation: u64,
    /// Dataset to which the result belongs.
    pub dataset: Arc<Dataset>,
    pub condition: ConditionId,
    pub outcome: Result<ConditionAnalysis, ConditionFailure>,
}

/// Background work in progress, including the analysis of the current settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Background {
    /// Progress of the analysis of the current settings: steps done, total.
    pub analysis: Option<(usize, usize)>,
    /// Problems whose optimality proof is running or waiting.
    pub proofs: Vec<Arc<Problem>>,
    /// Whether the costs of constraining and releasing responses are being computed.
    pub toggles: bool,
    /// Progress of the response curves: models done, total.
    pub curves: Option<(usize, usize)>,
    /// Progress of the error bars: steps done, total. Each model contributes its response, and the
    /// analysis with this model as the representative.
    pub bars: Option<(usize, usize)>,
    /// Progress of the responses to all records: steps done, total.
    pub time_histories: Option<(usize, usize)>,
    /// Progress of the couplings: steps done, total.
    pub couplings: Option<(usize, usize)>,
    /// Number of jobs that the visible views wait for.
    pub views: usize,
    /// Progress of the report: conditions done, total.
    pub report: Option<(usize, usize)>,
    /// Progress of the identification: parts done, total.
    pub identification: Option<(usize, usize)>,
    /// Whether some work was stopped, by the engineer or by a fault.
    pub stopped: bool,
}

impl Background {
    /// Returns whether anything is in progress.
    pub fn is_busy(&self) -> bool {
        !self.proofs.is_empty()
            || self.toggles
            || self.curves.is_some()
            || self.bars.is_some()
            || self.time_histories.is_some()
            || self.couplings.is_some()
            || self.views > 0
            || self.report.is_some()
            || self.identification.is_some()
    }
}

/// Computed results; never saved.
#[derive(Debug, Default)]
pub struct Results {
    pub analysis: Option<Arc<Analysis>>,
    /// Newer result of the displayed condition, while `analysis` is older.
    pub first: Option<FirstResult>,
    /// Costs of constraining or releasing each response, with their job; see
    /// `State::toggles`.
    pub toggles: Option<(TogglesJob, Arc<Toggles>)>,
    /// Frequency responses of the displayed condition, with their job; see `State::curves`.
    pub curves: Option<(CurvesJob, Arc<ConditionCurves>)>,
    /// Modes by model, with their job; see `State::modes`.
    pub modes: Option<(ModesJob, Arc<ConditionModes>)>,
    /// Requested assessment, with its job; see `State::assessment`.
    pub assessment: Option<(AssessmentJob, Arc<AssessmentTable>)>,
    /// Responses across conditions, with their job; see `State::across`.
    pub across: Option<(AcrossJob, Arc<AcrossCurves>)>,
    /// Uncertainty, with its job; see `State::uncertainty`.
    pub uncertainty: Option<(UncertaintyJob, Arc<Uncertainty>)>,
    /// Assessed benefit of the couplings, whether or not they are in use, with the job; see
    /// `State::couplings`.
    pub couplings: Option<(CouplingsJob, AssessedCouplings)>,
    /// Requirements, with their job; see `State::requirements`.
    pub requirements: Option<(RequirementsJob, Arc<Requirements>)>,
    /// Responses to the test input, with their job; see `State::test_answers`.
    pub test_answers: Option<(TestAnswersJob, Result<Arc<TestAnswers>, NoResult>)>,
    /// Comparison of a record with the tolerances, with its job; see `State::record_history`.
    pub record_history: Option<(
        RecordHistoryJob,
        Result<Arc<RecordHistory>, NoRecordHistory>,
    )>,
    /// Models' responses to all records, with their job; see `State::time_histories`.
    pub time_histories: Option<(TimeHistoriesJob, Arc<TimeHistories>)>,
    pub variants: Vec<(VariantJob, Arc<Analysis>)>,
    /// Comparisons of models with a record in the time domain, or the reasons for their absence.
    pub simulations: Vec<(SimulationJob, Result<Arc<Validation>, SimulationFailure>)>,
    pub background: Background,
    /// Start time of the background work \[s, window clock\].
    pub background_since: Option<f64>,
    /// Number of the newest request.
    pub requested: u64,
    /// Number of the request that produced the analysis.
    pub received: u64,
    /// Time of the oldest request without a result \[s, window clock\].
    pub waiting_since: Option<f64>,
    /// Whether a frame with an analysis has been painted.
    pub is_painted: bool,
    /// Computing time of the newest analysis \[ms\].
    pub elapsed_ms: f64,
    /// Whether the newest request was stopped, by the engineer or by a fault. The displayed results
    /// then remain older than the settings.
    pub stopped: bool,
}

/// Age \[s\] from which results for older settings are marked as stale.
const STALE_AFTER_S: f64 = 0.15;
/// Duration \[s\] after which background work is displayed: most jobs end before a display could be
/// read.
const BACKGROUND_AFTER_S: f64 = 0.5;

impl Results {
    /// Returns whether results for the newest request are pending.
    pub fn is_waiting(&self) -> bool {
        self.is_behind() && !self.stopped
    }

    /// Returns the message that explains a missing result.
    pub fn absence(&self) -> &'static str {
        if self.stopped {
            "not computed"
        } else {
            "computing …"
        }
    }

    /// Returns the message that explains missing error bars.
    pub fn absence_of_bars(&self) -> String {
        match self.background.bars {
            Some(progress) if !self.is_behind() => bar_words(progress),
            None if self.background.stopped => {
                "Error bars: stopped. Choose Compute, below, to continue".to_owned()
            }
            _ => self.absence().to_owned(),
        }
    }

    /// Returns whether the displayed results are older than the settings.
    pub fn is_behind(&self) -> bool {
        self.requested > self.received
    }

    /// Returns whether the result of the displayed condition has newer settings than the analysis
    /// of all conditions.
    pub fn first_is_ahead(&self) -> bool {
        match &self.first {
            Some(first) => self.analysis.is_some() && first.generation > self.received,
            None => false,
        }
    }

    /// Returns whether background work has lasted long enough at `now` \[s, window clock\] to be
    /// displayed.
    pub fn is_background_told(&self, now: f64) -> bool {
        match self.background_since {
            Some(since) => now - since > BACKGROUND_AFTER_S,
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

/// Describes the progress of the error bars: completed steps, total.
pub fn bar_words(progress: (usize, usize)) -> String {
    let (done, total) = progress;
    if total == 0 {
        "error bars …".to_owned()
    } else {
        format!("error bars, {done} of {total} steps …")
    }
}
