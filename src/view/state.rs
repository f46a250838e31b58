//! Everything the window shows: the study, what was computed and is being computed, messages and forms.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use gdcm_io::exports::ExportFormat;
use gdcm_method::correction::Problem;
use gdcm_method::uncertainty::{Bar as ErrorBar, Scalar};
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dataset, ModelId};
use gdcm_model::simulation::Validation;
use gdcm_plot::figure::ColumnWidth;
use gdcm_study::study::analysis::ConditionFailure;
use gdcm_study::study::assessment_table::AssessmentJob;
use gdcm_study::study::condition_answers::{
    RecordHistory, RecordHistoryJob, TestAnswers, TestAnswersJob,
};
use gdcm_study::study::condition_responses::ConditionCurves;
use gdcm_study::study::couplings_assessment::{AssessedCouplings, CouplingsJob};
use gdcm_study::study::differences::Difference;
use gdcm_study::study::job::{
    AcrossCurves, AcrossJob, ConditionModes, CurvesJob, ModesJob, SimulationJob, Toggles,
    TogglesJob, UncertaintyJob, VariantJob,
};
use gdcm_study::study::requirements::Requirements;
use gdcm_study::study::requirements_tables::RequirementsJob;
use gdcm_study::study::time_histories::{TimeHistories, TimeHistoriesJob};
use gdcm_study::study::uncertainty::Uncertainty;
use gdcm_study::study::{Analysis, AssessmentTable, ConditionAnalysis, History, Study, Table};

use super::assembling::AssemblyState;
use super::bars::Bar;
use super::command::FormKind;
use super::command_palette::PaletteForm;
use super::display::Display;
use super::records::{RecordsBefore, RecordsState};
use super::views::{View, all_records, assessed_correction, assessment_choice};

/// How a message is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeKind {
    /// Something was done.
    Done,
    /// Something could not be done.
    Trouble,
}

/// A message to the engineer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// How it is meant.
    pub kind: NoticeKind,
    /// The message.
    pub text: String,
}

/// A file opened or saved of late.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecentFile {
    /// Where it is, or was.
    pub path: PathBuf,
    /// Its name, to be shown.
    pub name: String,
    /// Its folder, to be shown.
    pub folder: String,
    /// Whether it was not there when it was looked for last.
    pub missing: bool,
}

/// What the forms hold while they are shown.
#[derive(Debug, Default)]
pub struct Forms {
    /// The form shown.
    pub shown: Option<FormKind>,
    /// The form drawn last, and whether it asked to overwrite files: another one opens.
    pub drawn: Option<(FormKind, bool)>,
    /// The path, or the text, in the field of each form, as typed.
    pub typed: BTreeMap<FormKind, String>,
    /// The study whose dataset is not where it says, and what opening it said.
    pub lost_dataset: Option<(PathBuf, String)>,
    /// The model whose rejection is given a reason.
    pub rejected_model: Option<ModelId>,
    /// The table that is to be saved.
    pub table: Option<Arc<Table>>,
    /// The view whose figure is to be saved.
    pub figure: Option<View>,
    /// How wide the figure is printed.
    pub figure_width: ColumnWidth,
    /// The conditions whose corrections are exported.
    pub exported: BTreeSet<ConditionId>,
    /// As what corrections are exported for other tools.
    pub export_format: ExportFormat,
    /// The palette of commands.
    pub palette: PaletteForm,
    /// Files that what the form asks for would overwrite: where there are any, it asks whether to.
    pub existing: Vec<String>,
}

impl Forms {
    /// What stands in the field of a form, to be typed into.
    pub fn typed_in(&mut self, form: FormKind) -> &mut String {
        self.typed.entry(form).or_default()
    }
}

/// Everything the window shows.
#[derive(Debug)]
pub struct State {
    /// The study: what is saved.
    pub study: Study,
    /// Whether the dataset is the embedded example.
    pub is_example: bool,
    /// Whether the start page stands in the place of everything else.
    pub on_start_page: bool,
    /// The dataset that what is shown is of.
    followed: Arc<Dataset>,
    /// What undo goes back over.
    pub history: History<RecordsBefore>,
    /// Name of the study's file, or what stands for it.
    pub study_name: String,
    /// Whether there are decisions that are not saved.
    pub unsaved: bool,
    /// What is shown.
    pub display: Display,
    /// What was computed.
    pub results: Results,
    /// Cautions of the file.
    pub file_cautions: Vec<String>,
    /// What the dataset was found to differ in from the one the study was made with.
    pub differences: Vec<Difference>,
    /// The message shown.
    pub notice: Option<Notice>,
    /// What is told until it is dealt with, in bars below the menu.
    pub bars: Vec<Bar>,
    /// Files opened and saved of late, the newest first.
    pub recent: Vec<RecentFile>,
    /// Name of a file being read.
    pub opening: Option<String>,
    /// What the forms hold.
    pub forms: Forms,
    /// The step of the guided tour that is shown.
    pub tour: Option<usize>,
    /// Flight records, and what was identified from them.
    pub records: RecordsState,
    /// Models that are being imported, in the place of the study.
    pub assembling: Option<AssemblyState>,
}

impl State {
    /// The state of a window that shows `study` for the first time.
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

    /// What the window's title says: the study, marked where it is not saved, and the dataset.
    pub fn window_title(&self) -> String {
        let mark = if self.unsaved { " •" } else { "" };
        format!(
            "{}{mark} – {} – gdcm",
            self.study_name,
            self.dataset().name()
        )
    }

    /// The dataset.
    pub fn dataset(&self) -> &Dataset {
        &self.study.dataset
    }

    /// The condition shown; the first one where the dataset does not have that any more.
    pub fn condition(&self) -> &Arc<Condition> {
        let found = self.study.dataset.condition(self.display.condition);
        found.unwrap_or(&self.study.dataset.conditions()[0])
    }

    /// The result of the condition shown, where there is one of this dataset.
    pub fn shown(&self) -> Option<&ConditionAnalysis> {
        self.outcome()?.as_ref().ok()
    }

    /// The models that a result suggests as outliers and that are not rejected.
    pub fn open_suggestions(&self, result: &ConditionAnalysis) -> Vec<String> {
        let rejected = &self.study.choice(result.condition.id()).physics.rejected;
        result
            .suggested()
            .into_iter()
            .filter(|model| !rejected.contains(model))
            .collect()
    }

    /// What came of the condition shown: the newest there is of this dataset.
    pub fn outcome(&self) -> Option<&Result<ConditionAnalysis, ConditionFailure>> {
        let condition = self.condition().id();
        let first = self.results.first.as_ref().filter(|first| {
            first.condition == condition && Arc::ptr_eq(&first.dataset, &self.study.dataset)
        });
        first
            .map(|first| &first.outcome)
            .or_else(|| self.analysis()?.conditions.get(&condition))
    }

    /// Whether the results of the other conditions, and all that is made from them, are of older settings than what is shown of
    /// this one: it is said beside each of them.
    pub fn others_are_older(&self) -> bool {
        let of_this_dataset =
            |first: &FirstResult| Arc::ptr_eq(&first.dataset, &self.study.dataset);
        self.results.first_is_ahead()
            && self.results.first.as_ref().is_some_and(of_this_dataset)
            && self.analysis().is_some()
    }

    /// What holding or freeing each response would cost, where it is of the result shown.
    pub fn toggles(&self) -> Option<&Toggles> {
        let (job, toggles) = self.results.toggles.as_ref()?;
        job.is_of(self.shown()?).then_some(toggles)
    }

    /// The responses of the condition shown, for drawing.
    pub fn curves(&self) -> Option<&Arc<ConditionCurves>> {
        let (job, curves) = self.results.curves.as_ref()?;
        let fits = job.condition == self.condition().id()
            && Arc::ptr_eq(&job.dataset, &self.study.dataset);
        fits.then_some(curves)
    }

    /// The modes of every model of the condition shown.
    pub fn modes(&self) -> Option<&Arc<ConditionModes>> {
        let (job, modes) = self.results.modes.as_ref()?;
        Arc::ptr_eq(&job.condition, self.condition()).then_some(modes)
    }

    /// The assessment that is asked for; one of an older analysis of the same dataset until it is there.
    pub fn assessment(&self) -> Option<&Arc<AssessmentTable>> {
        let (job, table) = self.results.assessment.as_ref()?;
        let of_this = Arc::ptr_eq(&job.analysis.study.dataset, &self.study.dataset);
        (of_this && job.choice == assessment_choice(self)).then_some(table)
    }

    /// What a qualification asks; of an older analysis of the same dataset until it is there.
    pub fn requirements(&self) -> Option<&Arc<Requirements>> {
        let (job, found) = self.results.requirements.as_ref()?;
        Arc::ptr_eq(&job.analysis.study.dataset, &self.study.dataset).then_some(found)
    }

    /// What the models of the condition shown answer to the test input, in words why there is nothing; of an older analysis of the same
    /// condition until it is there.
    pub fn test_answers(&self) -> Option<&Result<Arc<TestAnswers>, String>> {
        let (job, found) = self.results.test_answers.as_ref()?;
        let of_this = Arc::ptr_eq(&job.analysis.study.dataset, &self.study.dataset);
        (of_this && (job.condition, job.input) == (self.condition().id(), self.display.pair.input))
            .then_some(found)
    }

    /// The record of a job against the tolerances, in words why there is nothing; of an older analysis until it is there.
    pub fn record_history(
        &self,
        job: &RecordHistoryJob,
    ) -> Option<&Result<Arc<RecordHistory>, String>> {
        let (known, found) = self.results.record_history.as_ref()?;
        (known.condition == job.condition && known.record == job.record).then_some(found)
    }

    /// What the models answer to all records; of an older analysis of the same records until it is there.
    pub fn time_histories(&self) -> Option<&Arc<TimeHistories>> {
        let (job, found) = self.results.time_histories.as_ref()?;
        (job.records == all_records(self)).then_some(found)
    }

    /// What couplings do to the study, or would do; those of older settings until new ones are there.
    pub fn couplings(&self) -> Option<&AssessedCouplings> {
        let (known, assessed) = self.results.couplings.as_ref()?;
        let of_this = Arc::ptr_eq(&known.study.dataset, &self.study.dataset);
        (of_this && known.couplings == assessed_correction(self)).then_some(assessed)
    }

    /// The responses of one model of each condition; those of older settings until new ones are there.
    pub fn across(&self) -> Option<&Arc<AcrossCurves>> {
        let (job, curves) = self.results.across.as_ref()?;
        Arc::ptr_eq(&job.dataset, &self.study.dataset).then_some(curves)
    }

    /// What stands in the place of curves that are not there, or are to be renewed.
    pub fn curves_message(&self) -> Option<&'static str> {
        let results = &self.results;
        match self.curves() {
            _ if results.is_behind() => Some(results.absence()),
            Some(_) => None,
            None if results.background.stopped => Some("not computed"),
            None => Some("computing …"),
        }
    }

    /// Whether the proof of a result is still under way.
    pub fn is_proving(&self, shown: &ConditionAnalysis) -> bool {
        self.results.background.proofs.contains(&shown.gain_problem)
    }

    /// The newest analysis, where it is one of the dataset shown.
    pub fn analysis(&self) -> Option<&Analysis> {
        let analysis = self.results.analysis.as_deref()?;
        Arc::ptr_eq(&analysis.study.dataset, &self.study.dataset).then_some(analysis)
    }

    /// How sure the values of the newest analysis are; none until that is computed, beside the live answer.
    pub fn uncertainty(&self) -> Option<&Arc<Uncertainty>> {
        let (job, uncertainty) = self.results.uncertainty.as_ref()?;
        self.analysis()?;
        Arc::ptr_eq(&job.analysis, self.results.analysis.as_ref()?).then_some(uncertainty)
    }

    /// How sure the values of the condition shown are; none until that is computed, or where it is of older settings.
    pub fn sureness(&self) -> Sureness<'_> {
        let uncertainty = self.uncertainty().filter(|_| !self.others_are_older());
        Sureness {
            condition: self.condition().id(),
            uncertainty: uncertainty.map(AsRef::as_ref),
        }
    }

    /// The newest analysis with how sure its values are, as far as that is computed: what files and derivations are made of.
    pub fn analysis_with_bars(&self) -> Option<Analysis> {
        let analysis = self.analysis()?.clone();
        Some(Analysis {
            uncertainty: self.uncertainty().cloned(),
            ..analysis
        })
    }

    /// What giving up a computation leaves, in words.
    pub fn after_stop(&self) -> &'static str {
        match self.analysis() {
            Some(_) => "the results are older than the settings",
            None => "there are no results yet",
        }
    }

    /// Shows what there is of the study's dataset, where it is another one now: the same response where it has that, the first
    /// otherwise.
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

    /// How many models of a bundle of the condition shown are kept: "14 of 19".
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

    /// A model of the condition shown.
    pub fn model_id(&self, bundle: BundleKind, name: &str) -> ModelId {
        ModelId::new(self.condition().id(), bundle, name)
    }
}

/// How sure the values of the condition shown are.
#[derive(Clone, Copy, Debug)]
pub struct Sureness<'a> {
    condition: ConditionId,
    uncertainty: Option<&'a Uncertainty>,
}

impl<'a> Sureness<'a> {
    /// The bar of a value, and its level.
    pub fn bar(&self, scalar: Scalar) -> Option<(&'a ErrorBar, f64)> {
        let uncertainty = self.uncertainty?;
        Some((uncertainty.bar(self.condition, scalar)?, uncertainty.level))
    }

    /// Half-width of its bar: relative, of delays \[s\].
    pub fn half(&self, scalar: Scalar) -> Option<f64> {
        self.bar(scalar)
            .and_then(|(bar, level)| bar.half_width(level))
    }

    /// The level of all bars.
    pub fn level(&self) -> Option<f64> {
        self.uncertainty.map(|of| of.level)
    }
}

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
    /// Whether couplings are being assessed: steps done, of how many.
    pub couplings: Option<(usize, usize)>,
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
            || self.couplings.is_some()
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
    /// What holding or freeing each response of a condition would cost, and of which; see [`State::toggles`].
    pub toggles: Option<(TogglesJob, Arc<Toggles>)>,
    /// Responses for drawing, and of what; see [`State::curves`].
    pub curves: Option<(CurvesJob, Arc<ConditionCurves>)>,
    /// Modes of the models of one condition, and of which; see [`State::modes`].
    pub modes: Option<(ModesJob, Arc<ConditionModes>)>,
    /// The assessment that is asked for, and of what; see [`State::assessment`].
    pub assessment: Option<(AssessmentJob, Arc<AssessmentTable>)>,
    /// Responses of one model of each condition, and of which; see [`State::across`].
    pub across: Option<(AcrossJob, Arc<AcrossCurves>)>,
    /// How sure the values of an analysis are, and of which; see [`State::uncertainty`].
    pub uncertainty: Option<(UncertaintyJob, Arc<Uncertainty>)>,
    /// What couplings do, or would do, and to what; see [`State::couplings`].
    pub couplings: Option<(CouplingsJob, AssessedCouplings)>,
    /// What a qualification asks, and of what; see [`State::requirements`].
    pub requirements: Option<(RequirementsJob, Arc<Requirements>)>,
    /// What models answer to the test input, and of which condition; see [`State::test_answers`].
    pub test_answers: Option<(TestAnswersJob, Result<Arc<TestAnswers>, String>)>,
    /// One record against the tolerances; see [`State::record_history`].
    pub record_history: Option<(RecordHistoryJob, Result<Arc<RecordHistory>, String>)>,
    /// What the models answer to all records, and of what; see [`State::time_histories`].
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
        if self.stopped {
            "not computed"
        } else {
            "computing …"
        }
    }

    /// What stands in the place of error bars that are not there.
    pub fn absence_of_bars(&self) -> String {
        match self.background.bars {
            Some(progress) if !self.is_behind() => bar_words(progress),
            None if self.background.stopped => {
                "Error bars: stopped; Compute, below, goes on with them".to_owned()
            }
            _ => self.absence().to_owned(),
        }
    }

    /// Whether what is shown is older than the settings.
    pub fn is_behind(&self) -> bool {
        self.requested > self.received
    }

    /// Whether the condition shown is of newer settings than the analysis of all of them.
    pub fn first_is_ahead(&self) -> bool {
        self.analysis.is_some()
            && self
                .first
                .as_ref()
                .is_some_and(|first| first.generation > self.received)
    }

    /// Whether something has been under way beside the live answer for so long that it should be told at `now`.
    pub fn is_background_told(&self, now: f64) -> bool {
        self.background_since
            .is_some_and(|since| now - since > BACKGROUND_AFTER_S)
    }

    /// Whether what is shown should be marked as stale at `now` \[s of the window's clock\].
    pub fn is_stale(&self, now: f64) -> bool {
        self.stopped
            || self
                .waiting_since
                .is_some_and(|since| now - since > STALE_AFTER_S)
    }
}

/// How far error bars are, in words.
pub(super) fn bar_words((done, total): (usize, usize)) -> String {
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
    use gdcm_study::study::Engine;

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
