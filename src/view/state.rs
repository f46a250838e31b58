//! Everything the window shows.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use crate::correction::Problem;
use crate::dataset::{Band, BundleKind, Condition, ConditionId, Dataset, ModelId, Pair};
use crate::study::{
    Analysis, ConditionAnalysis, ConditionCurves, ConditionFailure, CurvesJob, Difference, History, Study, Toggles,
    TogglesJob,
};

use super::bars::Bar;
use super::bode_scene::CachedShapes;
use super::command::FormKind;
use super::plot::{AssessmentView, BodeCurve, BodeView, ChannelsView, FrequencyUnit, GainView, OverviewView};

/// The large plots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tab {
    /// The focused response: magnitude and phase.
    #[default]
    Bode,
    /// Every response, small.
    Overview,
    /// Channel gains against airspeed.
    Channels,
    /// What the scheduled correction is worth.
    Assessment,
}

/// What is shown, none of which changes a result.
#[derive(Debug)]
pub struct Display {
    /// The condition shown.
    pub condition: ConditionId,
    /// The response in the large plot.
    pub pair: Pair,
    /// The model pointed at.
    pub hovered: Option<ModelId>,
    /// The only model shown beside the representatives.
    pub isolated: Option<ModelId>,
    /// The plot above.
    pub tab: Tab,
    /// Unit of frequencies.
    pub unit: FrequencyUnit,
    /// Ranges and transforms of the large plot.
    pub bode: BodeView,
    /// Transforms of the net-gain plots.
    pub net_gain: GainView,
    /// Transforms of the channel-gain plots.
    pub channels: ChannelsView,
    /// Cells of the overview.
    pub overview: OverviewView,
    /// Transforms of the assessment.
    pub assessment: AssessmentView,
    /// Band for which the large plot was fitted last.
    pub bode_band: Option<Band>,
    /// Shapes of the responses drawn, kept from frame to frame.
    pub shapes: BTreeMap<Pair, CachedShapes>,
    /// The curves that the large plot shows.
    pub drawn: Vec<BodeCurve>,
}

impl Display {
    /// A condition and a response, in plots that fit what they show.
    fn of(condition: ConditionId, pair: Pair) -> Self {
        Self {
            condition,
            pair,
            hovered: None,
            isolated: None,
            tab: Tab::default(),
            unit: FrequencyUnit::default(),
            bode: BodeView::default(),
            net_gain: GainView::default(),
            channels: ChannelsView::default(),
            overview: OverviewView::default(),
            assessment: AssessmentView::default(),
            bode_band: None,
            shapes: BTreeMap::new(),
            drawn: Vec::new(),
        }
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
    /// The problems whose gains are being proven, or are to be.
    pub proofs: Vec<Arc<Problem>>,
    /// Whether the costs of holding and freeing are being computed.
    pub toggles: bool,
    /// Whether curves are being computed: models done, of how many.
    pub curves: Option<(usize, usize)>,
    /// Whether something of it was stopped, by hand or by a fault.
    pub stopped: bool,
}

impl Background {
    /// Whether anything is under way.
    pub fn is_busy(&self) -> bool {
        !self.proofs.is_empty() || self.toggles || self.curves.is_some()
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
    /// How long the newest analysis took \[ms\].
    pub elapsed_ms: f64,
    /// Whether the newest request was given up, by hand or by a fault: what is shown stays older than the settings.
    pub stopped: bool,
    /// How far the analysis under way is: steps done, of how many.
    pub progress: Option<(usize, usize)>,
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

/// What the export form holds.
#[derive(Clone, Debug, Default)]
pub struct ExportForm {
    /// The folder, as typed.
    pub folder: String,
    /// The conditions that are exported.
    pub chosen: BTreeSet<ConditionId>,
}

/// What the forms hold while they are shown.
#[derive(Debug, Default)]
pub struct Forms {
    /// The form shown.
    pub shown: Option<FormKind>,
    /// The form drawn last, and whether it asked to overwrite files: another one opens.
    pub drawn: Option<(FormKind, bool)>,
    /// The path in the open form, as typed.
    pub open_path: String,
    /// The study whose dataset is not where it says, and what opening it said.
    pub lost_dataset: Option<(PathBuf, String)>,
    /// The path of that dataset, as typed.
    pub dataset_path: String,
    /// The path in the save form, as typed.
    pub save_path: String,
    /// The export form.
    pub export: ExportForm,
    /// Files that what the form asks for would overwrite: where there are any, it asks whether to.
    pub existing: Vec<String>,
}

/// Everything the window shows.
#[derive(Debug)]
pub struct State {
    /// The study: what is saved.
    pub study: Study,
    /// What undo goes back over.
    pub history: History,
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
}

impl State {
    /// The state of a window that shows `study` for the first time.
    pub fn new(study: Study, study_name: String, file_cautions: Vec<String>) -> Self {
        let pair = study.dataset.measuring_pairs().marked().next().unwrap_or_default();
        let display = Display::of(study.dataset.conditions()[0].id(), pair);
        Self {
            study,
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
        }
    }

    /// The dataset.
    pub fn dataset(&self) -> &Dataset {
        &self.study.dataset
    }

    /// The condition shown; the first one where the dataset does not have that any more.
    pub fn condition(&self) -> &Condition {
        let found = self.study.dataset.condition(self.display.condition);
        found.unwrap_or(&self.study.dataset.conditions()[0])
    }

    /// The result of the condition shown, where there is one of this dataset.
    pub fn shown(&self) -> Option<&ConditionAnalysis> {
        self.outcome()?.as_ref().ok()
    }

    /// What came of the condition shown: the newest there is of this dataset.
    pub fn outcome(&self) -> Option<&Result<ConditionAnalysis, ConditionFailure>> {
        let condition = self.condition().id();
        let first = self
            .results
            .first
            .as_ref()
            .filter(|first| first.condition == condition && Arc::ptr_eq(&first.dataset, &self.study.dataset));
        first.map(|first| &first.outcome).or_else(|| self.analysis()?.conditions.get(&condition))
    }

    /// Whether the results of the other conditions, and all that is made from them, are of older settings than what is shown of
    /// this one: it is said beside each of them.
    pub fn others_are_older(&self) -> bool {
        let of_this_dataset = |first: &FirstResult| Arc::ptr_eq(&first.dataset, &self.study.dataset);
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
        let fits = job.condition == self.condition().id() && Arc::ptr_eq(&job.dataset, &self.study.dataset);
        fits.then_some(curves)
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

    /// What giving up a computation leaves, in words.
    pub fn after_stop(&self) -> &'static str {
        match self.analysis() {
            Some(_) => "the results are older than the settings",
            None => "there are no results yet",
        }
    }

    /// Shows what there is of another dataset: the same response where it has that, the first otherwise.
    pub fn follow_dataset(&mut self) {
        let dataset = &self.study.dataset;
        let pair = self.display.pair;
        if pair.output >= dataset.outputs().len() || pair.input >= dataset.inputs().len() {
            self.display.pair = dataset.measuring_pairs().marked().next().unwrap_or_default();
        }
        self.display.hovered = None;
        self.display.isolated = None;
        self.display.shapes.clear();
        self.display.bode.request_fit();
    }

    /// A model of the condition shown.
    pub fn model_id(&self, bundle: BundleKind, name: &str) -> ModelId {
        ModelId::new(self.condition().id(), bundle, name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::embedded_example;
    use crate::study::{Engine, Unobserved};

    #[test]
    fn a_stop_before_the_first_result_leaves_none_and_one_after_it_leaves_that() {
        let study = Study::new(embedded_example().unwrap().dataset);
        let mut state = State::new(study.clone(), String::new(), Vec::new());
        assert_eq!(state.after_stop(), "there are no results yet");
        state.results.analysis = Some(Arc::new(Engine::default().analyze(&study, &Unobserved).unwrap()));
        assert_eq!(state.after_stop(), "the results are older than the settings");
        let other = Study::new(embedded_example().unwrap().dataset);
        state.study = other;
        assert_eq!(state.after_stop(), "there are no results yet", "of the dataset that is shown now");
    }
}
