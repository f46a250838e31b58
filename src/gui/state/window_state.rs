//! State of the window: the study, finished and running computations, messages and forms.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use gdcm_io::export::ExportFormat;
use gdcm_method::correction::Problem;
use gdcm_method::uncertainty::{Bar as ErrorBar, Scalar};
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dataset, ModelId};
use gdcm_model::simulation::Validation;
use gdcm_plot::figure::ColumnWidth;
use gdcm_study::decisions::differences::Difference;
use gdcm_study::decisions::history::History;
use gdcm_study::jobs::analysis_jobs::AssessmentJob;
use gdcm_study::jobs::analysis_jobs::CouplingsJob;
use gdcm_study::jobs::analysis_jobs::{Toggles, TogglesJob, UncertaintyJob, VariantJob};
use gdcm_study::jobs::curve_jobs::{AcrossCurves, AcrossJob, ConditionModes, CurvesJob, ModesJob};
use gdcm_study::jobs::identification_jobs::SimulationJob;
use gdcm_study::jobs::requirement_jobs::RequirementsJob;
use gdcm_study::jobs::requirement_jobs::TimeHistoriesJob;
use gdcm_study::jobs::requirement_jobs::{RecordHistoryJob, TestAnswersJob};
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::results::condition_answers::{RecordHistory, TestAnswers};
use gdcm_study::results::couplings_assessment::AssessedCouplings;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::{Analysis, AssessmentTable, ConditionAnalysis, Study};
use gdcm_words::Table;

use super::display::Display;
use crate::gui::commands::command::FormKind;
use crate::gui::commands::command_palette::PaletteForm;
use crate::gui::panels::bars::Bar;
use crate::gui::views::assembling::AssemblyState;
use crate::gui::views::records::{RecordsBefore, RecordsState};
use crate::gui::views::{View, all_records, assessed_correction, assessment_choice};

/// Kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeKind {
    /// Success.
    Done,
    /// Failure.
    Trouble,
}

/// Message to the engineer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    pub kind: NoticeKind,
    pub text: String,
}

/// Recently opened or saved file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecentFile {
    /// Last known path.
    pub path: PathBuf,
    /// Displayed name.
    pub name: String,
    /// Displayed folder.
    pub folder: String,
    /// Whether the file was missing when last checked.
    pub missing: bool,
}

/// Contents of the forms.
#[derive(Debug, Default)]
pub struct Forms {
    /// Form shown.
    pub shown: Option<FormKind>,
    /// Form drawn last, and whether it asked to overwrite files: a change of either counts as a
    /// newly opened form.
    pub drawn: Option<(FormKind, bool)>,
    /// Path or text in the field of each form, as typed.
    pub typed: BTreeMap<FormKind, String>,
    /// Study whose dataset was not found, and the message of the attempt to open it.
    pub lost_dataset: Option<(PathBuf, String)>,
    /// Model whose rejection is given a reason.
    pub rejected_model: Option<ModelId>,
    /// Table to be saved.
    pub table: Option<Arc<Table>>,
    /// View whose figure is to be saved.
    pub figure: Option<View>,
    /// Printed width of the figure.
    pub figure_width: ColumnWidth,
    /// Conditions whose corrections are exported.
    pub exported: BTreeSet<ConditionId>,
    /// Format of an export for other tools.
    pub export_format: ExportFormat,
    pub palette: PaletteForm,
    /// Files that the form's action would overwrite; if not empty, the form asks whether to.
    pub existing: Vec<String>,
}

impl Forms {
    /// Returns the editable text of a form's field.
    pub fn typed_in(&mut self, form: FormKind) -> &mut String {
        self.typed.entry(form).or_default()
    }
}

/// State of the window.
#[derive(Debug)]
pub struct State {
    /// The study, the only saved part.
    pub study: Study,
    /// Whether the dataset is the embedded example.
    pub is_example: bool,
    /// Whether the start page covers everything else.
    pub on_start_page: bool,
    /// Dataset of the displayed results.
    followed: Arc<Dataset>,
    /// Undo history.
    pub history: History<RecordsBefore>,
    /// Name of the study's file, or a substitute.
    pub study_name: String,
    /// Whether there are unsaved decisions.
    pub unsaved: bool,
    pub display: Display,
    pub results: Results,
    pub file_cautions: Vec<String>,
    /// Differences between the dataset and the dataset of the saved study.
    pub differences: Vec<Difference>,
    /// Message shown.
    pub notice: Option<Notice>,
    /// Persistent messages, in bars below the menu.
    pub bars: Vec<Bar>,
    /// Recently opened and saved files, newest first.
    pub recent: Vec<RecentFile>,
    /// Name of a file being read.
    pub opening: Option<String>,
    pub forms: Forms,
    /// Current step of the guided tour.
    pub tour: Option<usize>,
    /// Flight records, and models identified from them.
    pub records: RecordsState,
    /// Models being imported, shown instead of the study.
    pub assembling: Option<AssemblyState>,
}

impl State {
    /// Creates the state of a window that shows `study` for the first time.
    pub fn new(study: Study, study_name: String, file_cautions: Vec<String>) -> Self {
        let pair = study
            .dataset
            .measuring_pairs()
            .marked()
            .next()
            .unwrap_or_default();
        let condition = study.dataset.conditions()[0].id();
        let once_held = study.settings.constrained.marked().collect();
        let display = Display {
            condition,
            pair,
            once_held,
            ..Display::default()
        };
        Self {
            followed: Arc::clone(&study.dataset),
            study,
            is_example: false,
            on_start_page: false,
            history: History::default(),
            study_name,
            unsaved: false,
            display,
            results: Results::default(),
            file_cautions,
            differences: Vec::new(),
            notice: None,
            bars: Vec::new(),
            recent: Vec::new(),
            opening: None,
            forms: Forms::default(),
            tour: None,
            records: RecordsState::default(),
            assembling: None,
        }
    }

    /// Returns the window title: the study, marked if unsaved, and the dataset.
    pub fn window_title(&self) -> String {
        let mark = if self.unsaved { " •" } else { "" };
        format!(
            "{}{mark} – {} – gdcm",
            self.study_name,
            self.dataset().name()
        )
    }

    /// Returns the dataset.
    pub fn dataset(&self) -> &Dataset {
        &self.study.dataset
    }

    /// Returns the displayed condition; the first condition if the dataset no longer contains it.
    pub fn condition(&self) -> &Arc<Condition> {
        let found = self.study.dataset.condition(self.display.condition);
        found.unwrap_or(&self.study.dataset.conditions()[0])
    }

    /// Returns the result of the displayed condition, if there is a result of this dataset.
    pub fn shown(&self) -> Option<&ConditionAnalysis> {
        self.outcome()?.as_ref().ok()
    }

    /// Returns the models suggested as outliers by a result and not rejected.
    pub fn open_suggestions(&self, result: &ConditionAnalysis) -> Vec<String> {
        let rejected = &self.study.choice(result.condition.id()).physics.rejected;
        result
            .suggested()
            .into_iter()
            .filter(|model| !rejected.contains(model))
            .collect()
    }

    /// Returns the newest outcome of the displayed condition for this dataset.
    pub fn outcome(&self) -> Option<&Result<ConditionAnalysis, ConditionFailure>> {
        let condition = self.condition().id();
        let first = self.results.first.as_ref().filter(|first| {
            first.condition == condition && Arc::ptr_eq(&first.dataset, &self.study.dataset)
        });
        first
            .map(|first| &first.outcome)
            .or_else(|| self.analysis()?.conditions.get(&condition))
    }

    /// Returns whether the results of the other conditions, and everything derived from them,
    /// belong to older settings than the displayed condition's; this is reported beside each of
    /// them.
    pub fn others_are_older(&self) -> bool {
        let of_this_dataset =
            |first: &FirstResult| Arc::ptr_eq(&first.dataset, &self.study.dataset);
        self.results.first_is_ahead()
            && self.results.first.as_ref().is_some_and(of_this_dataset)
            && self.analysis().is_some()
    }

    /// Returns the costs of constraining or releasing each response, if they belong to the
    /// displayed result.
    pub fn toggles(&self) -> Option<&Toggles> {
        let (job, toggles) = self.results.toggles.as_ref()?;
        job.is_of(self.shown()?).then_some(toggles)
    }

    /// Returns the responses of the displayed condition, for drawing.
    pub fn curves(&self) -> Option<&Arc<ConditionCurves>> {
        let (job, curves) = self.results.curves.as_ref()?;
        let fits = job.condition == self.condition().id()
            && Arc::ptr_eq(&job.dataset, &self.study.dataset);
        fits.then_some(curves)
    }

    /// Returns the modes of every model of the displayed condition.
    pub fn modes(&self) -> Option<&Arc<ConditionModes>> {
        let (job, modes) = self.results.modes.as_ref()?;
        Arc::ptr_eq(&job.condition, self.condition()).then_some(modes)
    }

    /// Returns the requested assessment; until it is ready, an assessment of an older analysis of
    /// the same dataset.
    pub fn assessment(&self) -> Option<&Arc<AssessmentTable>> {
        let (job, table) = self.results.assessment.as_ref()?;
        let of_this = Arc::ptr_eq(&job.analysis.study.dataset, &self.study.dataset);
        (of_this && job.choice == assessment_choice(self)).then_some(table)
    }

    /// Returns the requirements; until they are ready, those of an older analysis of the same
    /// dataset.
    pub fn requirements(&self) -> Option<&Arc<Requirements>> {
        let (job, found) = self.results.requirements.as_ref()?;
        Arc::ptr_eq(&job.analysis.study.dataset, &self.study.dataset).then_some(found)
    }

    /// Returns the responses of the displayed condition's models to the test input, or the reason
    /// for their absence; until they are ready, those of an older analysis of the same condition.
    pub fn test_answers(&self) -> Option<&Result<Arc<TestAnswers>, String>> {
        let (job, found) = self.results.test_answers.as_ref()?;
        let of_this = Arc::ptr_eq(&job.analysis.study.dataset, &self.study.dataset);
        (of_this && (job.condition, job.input) == (self.condition().id(), self.display.pair.input))
            .then_some(found)
    }

    /// Returns the comparison of a job's record with the tolerances, or the reason for its absence;
    /// until it is ready, the comparison of an older analysis.
    pub fn record_history(
        &self,
        job: &RecordHistoryJob,
    ) -> Option<&Result<Arc<RecordHistory>, String>> {
        let (known, found) = self.results.record_history.as_ref()?;
        (known.condition == job.condition && known.record == job.record).then_some(found)
    }

    /// Returns the models' responses to all records; until they are ready, those of an older
    /// analysis of the same records.
    pub fn time_histories(&self) -> Option<&Arc<TimeHistories>> {
        let (job, found) = self.results.time_histories.as_ref()?;
        (job.records == all_records(self)).then_some(found)
    }

    /// Returns the actual or potential effect of couplings on the study; until it is ready, the
    /// effect under older settings.
    pub fn couplings(&self) -> Option<&AssessedCouplings> {
        let (known, assessed) = self.results.couplings.as_ref()?;
        let of_this = Arc::ptr_eq(&known.study.dataset, &self.study.dataset);
        (of_this && known.couplings == assessed_correction(self)).then_some(assessed)
    }

    /// Returns the responses of a model of each condition; until they are ready, those of older
    /// settings.
    pub fn across(&self) -> Option<&Arc<AcrossCurves>> {
        let (job, curves) = self.results.across.as_ref()?;
        Arc::ptr_eq(&job.dataset, &self.study.dataset).then_some(curves)
    }

    /// Returns the message shown instead of missing curves, or while curves are being renewed.
    pub fn curves_message(&self) -> Option<&'static str> {
        let results = &self.results;
        match self.curves() {
            _ if results.is_behind() => Some(results.absence()),
            Some(_) => None,
            None if results.background.stopped => Some("not computed"),
            None => Some("computing …"),
        }
    }

    /// Returns whether a result is still being proven.
    pub fn is_proving(&self, shown: &ConditionAnalysis) -> bool {
        self.results.background.proofs.contains(&shown.gain_problem)
    }

    /// Returns the newest analysis, if it belongs to the displayed dataset.
    pub fn analysis(&self) -> Option<&Analysis> {
        let analysis = self.results.analysis.as_deref()?;
        Arc::ptr_eq(&analysis.study.dataset, &self.study.dataset).then_some(analysis)
    }

    /// Returns the uncertainty of the newest analysis; `None` until it is computed, besides the
    /// live answer.
    pub fn uncertainty(&self) -> Option<&Arc<Uncertainty>> {
        let (job, uncertainty) = self.results.uncertainty.as_ref()?;
        self.analysis()?;
        Arc::ptr_eq(&job.analysis, self.results.analysis.as_ref()?).then_some(uncertainty)
    }

    /// Returns the uncertainty of the displayed condition's values; empty until it is computed, or
    /// if it belongs to older settings.
    pub fn sureness(&self) -> Sureness<'_> {
        let uncertainty = self.uncertainty().filter(|_| !self.others_are_older());
        Sureness {
            condition: self.condition().id(),
            uncertainty: uncertainty.map(AsRef::as_ref),
        }
    }

    /// Returns the newest analysis with its uncertainty, as far as computed: the basis of files and
    /// derivations.
    pub fn analysis_with_bars(&self) -> Option<Analysis> {
        let analysis = self.analysis()?.clone();
        Some(Analysis {
            uncertainty: self.uncertainty().cloned(),
            ..analysis
        })
    }

    /// Describes the state after a computation was stopped.
    pub fn after_stop(&self) -> &'static str {
        match self.analysis() {
            Some(_) => "the results are older than the settings",
            None => "there are no results yet",
        }
    }

    /// Adapts the state to a replaced dataset: keeps the response in focus if it exists, otherwise
    /// selects the first.
    pub fn follow_dataset(&mut self) {
        let dataset = &self.study.dataset;
        if Arc::ptr_eq(dataset, &self.followed) {
            return;
        }
        self.followed = Arc::clone(dataset);
        let pair = self.display.pair;
        if pair.output >= dataset.outputs().len() || pair.input >= dataset.inputs().len() {
            self.display.pair = dataset
                .measuring_pairs()
                .marked()
                .next()
                .unwrap_or_default();
        }
        self.display.hovered = None;
        self.display.isolated = None;
        self.display.curves.forget_models();
        self.display.shapes.clear();
        self.display.fit_frequency_plots();
    }

    /// Returns the number of kept models in a bundle of the displayed condition: "14 of 19".
    pub fn kept_words(&self, kind: BundleKind) -> String {
        let count = self.condition().bundle(kind).len();
        let rejected = self
            .study
            .choice(self.condition().id())
            .bundle(kind)
            .rejected
            .len();
        format!("{} of {count}", count - rejected)
    }

    /// Returns the id of a model of the displayed condition.
    pub fn model_id(&self, bundle: BundleKind, name: &str) -> ModelId {
        ModelId::new(self.condition().id(), bundle, name)
    }
}

/// Uncertainty of the displayed condition's values.
#[derive(Clone, Copy, Debug)]
pub struct Sureness<'a> {
    condition: ConditionId,
    uncertainty: Option<&'a Uncertainty>,
}

impl<'a> Sureness<'a> {
    /// Returns the error bar of a value, and its confidence level.
    pub fn bar(&self, scalar: Scalar) -> Option<(&'a ErrorBar, f64)> {
        let uncertainty = self.uncertainty?;
        Some((uncertainty.bar(self.condition, scalar)?, uncertainty.level))
    }

    /// Returns the half-width of the error bar: relative, for delays in \[s\].
    pub fn half(&self, scalar: Scalar) -> Option<f64> {
        self.bar(scalar)
            .and_then(|(bar, level)| bar.half_width(level))
    }

    /// Returns the confidence level of all error bars.
    pub fn level(&self) -> Option<f64> {
        self.uncertainty.map(|of| of.level)
    }
}

/// Result of the displayed condition, available before the others.
#[derive(Clone, Debug)]
pub struct FirstResult {
    /// Number of the answered request.
    pub generation: u64,
    /// Dataset of the result.
    pub dataset: Arc<Dataset>,
    pub condition: ConditionId,
    pub outcome: Result<ConditionAnalysis, ConditionFailure>,
}

/// Work in progress besides the live answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Background {
    /// Live answer in progress: steps done, total.
    pub analysis: Option<(usize, usize)>,
    /// Problems whose gains are being or will be proven.
    pub proofs: Vec<Arc<Problem>>,
    /// Whether the costs of constraining and releasing are being computed.
    pub toggles: bool,
    /// Curves in progress: models done, total.
    pub curves: Option<(usize, usize)>,
    /// Error bars in progress: steps done, total (for each model its response, and the analysis
    /// with this model as the representative).
    pub bars: Option<(usize, usize)>,
    /// Responses to all records in progress: steps done, total.
    pub time_histories: Option<(usize, usize)>,
    /// Assessment of couplings in progress: steps done, total.
    pub couplings: Option<(usize, usize)>,
    /// Number of jobs that the visible views wait for.
    pub views: usize,
    /// Report in progress: conditions done, total.
    pub report: Option<(usize, usize)>,
    /// Identification in progress: parts done, total.
    pub identification: Option<(usize, usize)>,
    /// Whether some of it was stopped, by hand or by a fault.
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
    /// Displayed condition, if it is ahead of that analysis.
    pub first: Option<FirstResult>,
    /// Costs of constraining or releasing each response of a condition, with their job; see
    /// [`State::toggles`].
    pub toggles: Option<(TogglesJob, Arc<Toggles>)>,
    /// Responses for drawing, with their job; see [`State::curves`].
    pub curves: Option<(CurvesJob, Arc<ConditionCurves>)>,
    /// Modes of the models of a condition, with their job; see [`State::modes`].
    pub modes: Option<(ModesJob, Arc<ConditionModes>)>,
    /// Requested assessment, with its job; see [`State::assessment`].
    pub assessment: Option<(AssessmentJob, Arc<AssessmentTable>)>,
    /// Responses of a model of each condition, with their job; see [`State::across`].
    pub across: Option<(AcrossJob, Arc<AcrossCurves>)>,
    /// Uncertainty of an analysis, with its job; see [`State::uncertainty`].
    pub uncertainty: Option<(UncertaintyJob, Arc<Uncertainty>)>,
    /// Actual or potential effect of couplings, with its job; see [`State::couplings`].
    pub couplings: Option<(CouplingsJob, AssessedCouplings)>,
    /// Requirements, with their job; see [`State::requirements`].
    pub requirements: Option<(RequirementsJob, Arc<Requirements>)>,
    /// Responses to the test input, with their job; see [`State::test_answers`].
    pub test_answers: Option<(TestAnswersJob, Result<Arc<TestAnswers>, String>)>,
    /// Comparison of a record with the tolerances; see [`State::record_history`].
    pub record_history: Option<(RecordHistoryJob, Result<Arc<RecordHistory>, String>)>,
    /// Models' responses to all records, with their job; see [`State::time_histories`].
    pub time_histories: Option<(TimeHistoriesJob, Arc<TimeHistories>)>,
    pub variants: Vec<(VariantJob, Arc<Analysis>)>,
    /// Models compared with a record in time, or the reason why not.
    pub simulations: Vec<(SimulationJob, Result<Arc<Validation>, String>)>,
    pub background: Background,
    /// Start of the background work \[s of the window's clock\].
    pub background_since: Option<f64>,
    /// Number of the newest request.
    pub requested: u64,
    /// Number of the request answered by the analysis.
    pub received: u64,
    /// Time of the oldest unanswered request \[s of the window's clock\].
    pub waiting_since: Option<f64>,
    /// Whether a frame with an analysis has been painted.
    pub is_painted: bool,
    /// Duration of the newest analysis \[ms\].
    pub elapsed_ms: f64,
    /// Whether the newest request was stopped, by hand or by a fault; the displayed results then
    /// stay older than the settings.
    pub stopped: bool,
}

/// Age \[s\] from which displayed results of older settings are marked as stale.
const STALE_AFTER_S: f64 = 0.15;
/// Duration \[s\] from which background work is reported: most of it ends before it could be read.
const BACKGROUND_AFTER_S: f64 = 0.5;

impl Results {
    /// Returns whether an answer is pending.
    pub fn is_waiting(&self) -> bool {
        self.is_behind() && !self.stopped
    }

    /// Returns the message shown instead of a missing result.
    pub fn absence(&self) -> &'static str {
        if self.stopped {
            "not computed"
        } else {
            "computing …"
        }
    }

    /// Returns the message shown instead of missing error bars.
    pub fn absence_of_bars(&self) -> String {
        match self.background.bars {
            Some(progress) if !self.is_behind() => bar_words(progress),
            None if self.background.stopped => {
                "Error bars: stopped; Compute, below, goes on with them".to_owned()
            }
            _ => self.absence().to_owned(),
        }
    }

    /// Returns whether the displayed results are older than the settings.
    pub fn is_behind(&self) -> bool {
        self.requested > self.received
    }

    /// Returns whether the displayed condition's result has newer settings than the analysis of all
    /// conditions.
    pub fn first_is_ahead(&self) -> bool {
        self.analysis.is_some()
            && self
                .first
                .as_ref()
                .is_some_and(|first| first.generation > self.received)
    }

    /// Returns whether background work has lasted long enough at `now` to be reported.
    pub fn is_background_told(&self, now: f64) -> bool {
        self.background_since
            .is_some_and(|since| now - since > BACKGROUND_AFTER_S)
    }

    /// Returns whether the displayed results should be marked as stale at `now` \[s of the window's
    /// clock\].
    pub fn is_stale(&self, now: f64) -> bool {
        self.stopped
            || self
                .waiting_since
                .is_some_and(|since| now - since > STALE_AFTER_S)
    }
}

/// Describes the progress of the error bars.
pub(crate) fn bar_words((done, total): (usize, usize)) -> String {
    if total == 0 {
        "error bars …".to_owned()
    } else {
        format!("error bars, {done} of {total} steps …")
    }
}

#[cfg(test)]
mod tests {
    use gdcm_io::embedded_example;
    use gdcm_model::progress::Unobserved;
    use gdcm_study::Engine;

    use super::*;

    #[test]
    fn a_stop_before_the_first_result_leaves_none_and_one_after_it_leaves_that() {
        let study = Study::new(embedded_example().unwrap().dataset);
        let mut state = State::new(study.clone(), String::new(), Vec::new());
        assert_eq!(state.after_stop(), "there are no results yet");
        state.results.analysis = Some(Arc::new(
            Engine::default().analyze(&study, &Unobserved).unwrap(),
        ));
        assert_eq!(
            state.after_stop(),
            "the results are older than the settings"
        );
        let other = Study::new(embedded_example().unwrap().dataset);
        state.study = other;
        assert_eq!(
            state.after_stop(),
            "there are no results yet",
            "of the dataset that is shown now"
        );
    }
}
