//! Window state: the study, finished and running computations, messages and forms.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_model::dataset::{BundleKind, Condition, Dataset, ModelId};
use gdcm_study::decisions::dataset_differences::Difference;
use gdcm_study::decisions::history::History;
use gdcm_study::jobs::analysis_jobs::Toggles;
use gdcm_study::jobs::curve_jobs::{AcrossCurves, ConditionModes};
use gdcm_study::jobs::requirement_jobs::RecordHistoryJob;
use gdcm_study::results::analysis::{ConditionFailure, NoResult};
use gdcm_study::results::assessment_table::AssessmentChoice;
use gdcm_study::results::condition_answers::{NoRecordHistory, RecordHistory, TestAnswers};
use gdcm_study::results::couplings_assessment::AssessedCouplings;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::{Analysis, AssessmentTable, ConditionAnalysis, CouplingCorrection, Study};

use super::assembling::AssemblyState;
use super::display::Display;
use super::forms::Forms;
use super::notices::{Bar, Notice};
use super::records::{RecordsBefore, RecordsState};
use super::results::{Results, Sureness};

/// Recently opened or saved file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecentFile {
    /// Last known path.
    pub path: PathBuf,
    pub name: String,
    pub folder: String,
    /// Whether the file was missing when last checked.
    pub missing: bool,
}

/// Complete state of the window.
#[derive(Debug)]
pub struct State {
    /// The study, the only saved part.
    pub study: Study,
    /// Whether the dataset is the embedded example.
    pub is_example: bool,
    /// Whether the start page covers everything else.
    pub on_start_page: bool,
    /// Dataset to which `follow_dataset` last adapted the state.
    followed: Arc<Dataset>,
    /// Undo history.
    pub history: History<RecordsBefore>,
    /// File name of the study, or a substitute if it has not been saved.
    pub study_name: String,
    /// Whether there are unsaved decisions.
    pub unsaved: bool,
    pub display: Display,
    pub results: Results,
    pub file_cautions: Vec<String>,
    /// Differences between the dataset and the saved study's dataset.
    pub differences: Vec<Difference>,
    pub notice: Option<Notice>,
    /// Persistent messages, in bars below the menu.
    pub bars: Vec<Bar>,
    /// Recently opened and saved files, newest first.
    pub recent: Vec<RecentFile>,
    /// Name of the file being read.
    pub opening: Option<String>,
    pub forms: Forms,
    /// Current step in the guided tour.
    pub tour: Option<usize>,
    /// Flight records, and models identified from them.
    pub records: RecordsState,
    /// Models being imported, shown instead of the study.
    pub assembling: Option<AssemblyState>,
}

impl State {
    /// Creates the state for a window that shows `study` for the first time.
    pub fn new(study: Study, study_name: String, file_cautions: Vec<String>) -> Self {
        let pair = study
            .dataset
            .measuring_pairs()
            .marked()
            .next()
            .unwrap_or_default();
        let condition = study.dataset.conditions()[0].id();
        let once_held = study.settings.constrained.marked().collect();
        let mut display = Display::default();
        display.selection.condition = condition;
        display.selection.pair = pair;
        display.gains.once_held = once_held;
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

    pub fn dataset(&self) -> &Dataset {
        &self.study.dataset
    }

    /// Returns the displayed condition, or the first condition if the dataset no longer contains
    /// it.
    pub fn condition(&self) -> &Arc<Condition> {
        let found = self
            .study
            .dataset
            .condition(self.display.selection.condition);
        found.unwrap_or(&self.study.dataset.conditions()[0])
    }

    /// Returns the result of the displayed condition, if it belongs to the displayed dataset.
    pub fn shown(&self) -> Option<&ConditionAnalysis> {
        self.outcome()?.as_ref().ok()
    }

    /// Returns the names of the models that a result suggests as outliers and that are not
    /// rejected.
    pub fn open_suggestions(&self, result: &ConditionAnalysis) -> Vec<String> {
        let rejected = &self.study.choice(result.condition.id()).physics.rejected;
        result
            .suggested()
            .into_iter()
            .filter(|model| !rejected.contains(model))
            .collect()
    }

    /// Returns the newest outcome of the displayed condition for the displayed dataset.
    pub fn outcome(&self) -> Option<&Result<ConditionAnalysis, ConditionFailure>> {
        let condition = self.condition().id();
        if let Some(first) = &self.results.first
            && first.condition == condition
            && self.is_shown_dataset(&first.dataset)
        {
            return Some(&first.outcome);
        }
        self.analysis()?.conditions.get(&condition)
    }

    /// Returns whether the results of the other conditions, and everything derived from them,
    /// belong to older settings than the result of the displayed condition. Views display a notice
    /// beside such results.
    pub fn others_are_older(&self) -> bool {
        match &self.results.first {
            Some(first) => {
                self.results.first_is_ahead()
                    && self.is_shown_dataset(&first.dataset)
                    && self.analysis().is_some()
            }
            None => false,
        }
    }

    /// Returns whether a result belongs to the displayed dataset. Datasets are compared by pointer:
    /// results belong to a single dataset even if another is equal.
    fn is_shown_dataset(&self, dataset: &Arc<Dataset>) -> bool {
        Arc::ptr_eq(dataset, &self.study.dataset)
    }

    /// Returns the cost of constraining or releasing each response, if it belongs to the displayed
    /// result.
    pub fn toggles(&self) -> Option<&Toggles> {
        let (job, toggles) = self.results.toggles.as_ref()?;
        if !job.is_of(self.shown()?) {
            return None;
        }
        Some(toggles)
    }

    /// Returns the frequency responses of the displayed condition; `None` until they are computed.
    pub fn curves(&self) -> Option<&Arc<ConditionCurves>> {
        let (job, curves) = self.results.curves.as_ref()?;
        if job.condition != self.condition().id() || !self.is_shown_dataset(&job.dataset) {
            return None;
        }
        Some(curves)
    }

    /// Returns the modes of every model in the displayed condition; `None` until they are computed.
    pub fn modes(&self) -> Option<&Arc<ConditionModes>> {
        let (job, modes) = self.results.modes.as_ref()?;
        if !Arc::ptr_eq(&job.condition, self.condition()) {
            return None;
        }
        Some(modes)
    }

    /// Returns the requested assessment; until it is ready, the assessment from an older analysis
    /// of the same dataset.
    pub fn assessment(&self) -> Option<&Arc<AssessmentTable>> {
        let (job, table) = self.results.assessment.as_ref()?;
        if !self.is_shown_dataset(&job.analysis.study.dataset)
            || job.choice != self.assessment_choice()
        {
            return None;
        }
        Some(table)
    }

    /// Returns the model, the correction and the average for which the assessment is computed.
    pub fn assessment_choice(&self) -> AssessmentChoice {
        let assessed = &self.display.judging.assessed;
        AssessmentChoice {
            model: assessed.model,
            correction: assessed.correction,
            average: assessed.average.unwrap_or(self.study.settings.cost_average),
        }
    }

    /// Returns the requirements; until they are ready, the requirements from an older analysis of
    /// the same dataset.
    pub fn requirements(&self) -> Option<&Arc<Requirements>> {
        let (job, requirements) = self.results.requirements.as_ref()?;
        if !self.is_shown_dataset(&job.analysis.study.dataset) {
            return None;
        }
        Some(requirements)
    }

    /// Returns the responses of the models to the test input in the displayed condition, or the
    /// reason for their absence. Until they are ready, returns the responses from an older analysis
    /// in the same condition.
    pub fn test_answers(&self) -> Option<&Result<Arc<TestAnswers>, NoResult>> {
        let (job, answers) = self.results.test_answers.as_ref()?;
        if !self.is_shown_dataset(&job.analysis.study.dataset)
            || job.condition != self.condition().id()
            || job.input != self.display.selection.pair.input
        {
            return None;
        }
        Some(answers)
    }

    /// Returns the comparison of a job's record with the tolerances, or the reason for its absence;
    /// until it is ready, the comparison from an older analysis.
    pub fn record_history(
        &self,
        job: &RecordHistoryJob,
    ) -> Option<&Result<Arc<RecordHistory>, NoRecordHistory>> {
        let (known, history) = self.results.record_history.as_ref()?;
        if known.condition != job.condition || known.record != job.record {
            return None;
        }
        Some(history)
    }

    /// Returns the responses of the models to all records; until they are ready, the responses from
    /// an older analysis with the same records.
    pub fn time_histories(&self) -> Option<&Arc<TimeHistories>> {
        let (job, histories) = self.results.time_histories.as_ref()?;
        if job.records != self.records.history_records() {
            return None;
        }
        Some(histories)
    }

    /// Returns the couplings that the study requests. If it requests none, returns mixing and
    /// feedback, whose possible benefit is then assessed.
    pub fn assessed_couplings(&self) -> CouplingCorrection {
        match self.study.settings.couplings {
            CouplingCorrection::None => CouplingCorrection::MixingAndFeedback,
            requested => requested,
        }
    }

    /// Returns the assessed benefit of the couplings, whether or not they are in use; until it is
    /// ready, the benefit under older settings.
    pub fn couplings(&self) -> Option<&AssessedCouplings> {
        let (known, assessed) = self.results.couplings.as_ref()?;
        if !self.is_shown_dataset(&known.study.dataset)
            || known.couplings != self.assessed_couplings()
        {
            return None;
        }
        Some(assessed)
    }

    /// Returns the responses of a model in each condition; until they are ready, the responses for
    /// older settings.
    pub fn across(&self) -> Option<&Arc<AcrossCurves>> {
        let (job, curves) = self.results.across.as_ref()?;
        if !self.is_shown_dataset(&job.dataset) {
            return None;
        }
        Some(curves)
    }

    /// Returns the message shown when curves are missing or being recomputed.
    pub fn curves_message(&self) -> Option<&'static str> {
        let results = &self.results;
        if results.is_behind() {
            Some(results.absence())
        } else if self.curves().is_some() {
            None
        } else if results.background.stopped {
            Some("not computed")
        } else {
            Some("computing …")
        }
    }

    /// Returns whether the optimality proof of a result is still running.
    pub fn is_proving(&self, shown: &ConditionAnalysis) -> bool {
        self.results.background.proofs.contains(&shown.gain_problem)
    }

    /// Returns the newest analysis, if it belongs to the displayed dataset.
    pub fn analysis(&self) -> Option<&Analysis> {
        let analysis = self.results.analysis.as_deref()?;
        if !self.is_shown_dataset(&analysis.study.dataset) {
            return None;
        }
        Some(analysis)
    }

    /// Returns the uncertainty of the newest analysis; `None` until its job is complete.
    pub fn uncertainty(&self) -> Option<&Arc<Uncertainty>> {
        let (job, uncertainty) = self.results.uncertainty.as_ref()?;
        self.analysis()?;
        if !Arc::ptr_eq(&job.analysis, self.results.analysis.as_ref()?) {
            return None;
        }
        Some(uncertainty)
    }

    /// Returns the uncertainty of the values in the displayed condition; empty until it is
    /// computed, or if it belongs to older settings.
    pub fn sureness(&self) -> Sureness<'_> {
        let uncertainty = if self.others_are_older() {
            None
        } else {
            self.uncertainty()
        };
        Sureness {
            condition: self.condition().id(),
            uncertainty: uncertainty.map(AsRef::as_ref),
        }
    }

    /// Returns the newest analysis with the uncertainty computed so far; used by exported files and
    /// derivations.
    pub fn analysis_with_bars(&self) -> Option<Analysis> {
        let analysis = self.analysis()?.clone();
        Some(Analysis {
            uncertainty: self.uncertainty().cloned(),
            ..analysis
        })
    }

    /// Returns the message shown after a computation was stopped: results are outdated, or there
    /// are none.
    pub fn after_stop(&self) -> &'static str {
        match self.analysis() {
            Some(_) => "the results are older than the settings",
            None => "there are no results yet",
        }
    }

    /// Adapts the state to a replaced dataset. Keeps the response in focus if the dataset contains
    /// it; otherwise selects the first on-axis response, or the first response if none is on-axis.
    pub fn follow_dataset(&mut self) {
        let dataset = &self.study.dataset;
        if Arc::ptr_eq(dataset, &self.followed) {
            return;
        }
        self.followed = Arc::clone(dataset);
        let pair = self.display.selection.pair;
        if pair.output >= dataset.outputs().len() || pair.input >= dataset.inputs().len() {
            self.display.selection.pair = dataset
                .measuring_pairs()
                .marked()
                .next()
                .unwrap_or_default();
        }
        self.display.selection.hovered = None;
        self.display.selection.isolated = None;
        self.display.curves.forget_models();
        self.display.frequency.shapes.clear();
        self.display.frequency.fit();
    }

    /// Formats the number of kept models in a bundle: "14 of 19".
    pub fn kept_words(&self, kind: BundleKind) -> String {
        let count = self.condition().bundle(kind).len();
        let choice = self.study.choice(self.condition().id());
        let rejected = choice.bundle(kind).rejected.len();
        format!("{} of {count}", count - rejected)
    }

    /// Returns the id of a model in the displayed condition.
    pub fn model_id(&self, bundle: BundleKind, name: &str) -> ModelId {
        ModelId::new(self.condition().id(), bundle, name)
    }
}

#[cfg(test)]
mod tests {
    use gdcm_io::embedded_example;
    use gdcm_model::progress::Unobserved;
    use gdcm_study::Engine;

    use super::*;

    #[test]
    fn after_a_stop_the_results_of_this_dataset_stay() {
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
            "no results of the displayed dataset"
        );
    }
}
