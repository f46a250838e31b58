//! State of the window: the study, finished and running computations, messages and forms.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_model::dataset::{BundleKind, Condition, Dataset, ModelId};
use gdcm_study::decisions::differences::Difference;
use gdcm_study::decisions::history::History;
use gdcm_study::jobs::analysis_jobs::Toggles;
use gdcm_study::jobs::curve_jobs::{AcrossCurves, ConditionModes};
use gdcm_study::jobs::requirement_jobs::RecordHistoryJob;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::results::assessment_table::AssessmentChoice;
use gdcm_study::results::condition_answers::{RecordHistory, TestAnswers};
use gdcm_study::results::couplings_assessment::AssessedCouplings;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::{Analysis, AssessmentTable, ConditionAnalysis, CouplingCorrection, Study};

use super::assembling::AssemblyState;
use super::assessed_figures::AssessedFigures;
use super::display::Display;
use super::forms::Forms;
use super::notices::{Bar, Notice};
use super::records::{RecordsBefore, RecordsState};
use super::results::{FirstResult, Results, Sureness};

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

    /// Returns the dataset.
    pub fn dataset(&self) -> &Dataset {
        &self.study.dataset
    }

    /// Returns the displayed condition; the first condition if the dataset no longer contains it.
    pub fn condition(&self) -> &Arc<Condition> {
        let found = self
            .study
            .dataset
            .condition(self.display.selection.condition);
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
        (of_this && job.choice == self.assessment_choice()).then_some(table)
    }

    /// Returns the assessment to compute.
    pub fn assessment_choice(&self) -> AssessmentChoice {
        let AssessedFigures {
            model,
            correction,
            average,
            ..
        } = self.display.judging.assessed;
        AssessmentChoice {
            model,
            correction,
            average: average.unwrap_or(self.study.settings.cost_average),
        }
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
        (of_this
            && (job.condition, job.input)
                == (self.condition().id(), self.display.selection.pair.input))
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
        (job.records == self.records.history_records()).then_some(found)
    }

    /// Returns the couplings requested by the study; if there are none, mixing and feedback, which
    /// are then assessed.
    pub fn assessed_couplings(&self) -> CouplingCorrection {
        match self.study.settings.couplings {
            CouplingCorrection::None => CouplingCorrection::MixingAndFeedback,
            asked => asked,
        }
    }

    /// Returns the actual or potential effect of couplings on the study; until it is ready, the
    /// effect under older settings.
    pub fn couplings(&self) -> Option<&AssessedCouplings> {
        let (known, assessed) = self.results.couplings.as_ref()?;
        let of_this = Arc::ptr_eq(&known.study.dataset, &self.study.dataset);
        (of_this && known.couplings == self.assessed_couplings()).then_some(assessed)
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
