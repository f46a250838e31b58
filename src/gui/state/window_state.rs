//! Window state: the study, how it is displayed, results, messages and forms.
//!
//! `shown_results.rs` extends [`State`] by the methods that select the results to show.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_io::Example;
use gdcm_io::file_caution::FileCaution;
use gdcm_model::dataset::{BundleKind, Condition, Dataset, ModelId};
use gdcm_study::Study;
use gdcm_study::decisions::dataset_differences::Difference;
use gdcm_study::decisions::history::{History, Step};

use super::assembling::AssemblyState;
use super::computed_results::Results;
use super::display::Display;
use super::forms::Forms;
use super::notices::Notices;
use super::record_change::RecordChange;
use super::records::{RecordsSnapshot, RecordsState};
use super::settings_session::SettingsSession;
use super::view::View;

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

/// Undo history for the study and the flight records.
pub type UndoHistory = History<RecordsSnapshot, RecordChange>;

pub type UndoStep = Step<RecordsSnapshot, RecordChange>;

/// Everything that the window keeps.
#[derive(Debug)]
pub struct State {
    /// The study, the only part that a study file holds; preferences are stored separately.
    pub study: Study,
    /// Embedded example, if the dataset is one.
    pub example: Option<Example>,
    /// Whether the start page covers everything else.
    pub on_start_page: bool,
    /// Dataset to which [`Self::follow_dataset`] last adapted the displayed selection.
    followed: Arc<Dataset>,
    pub history: UndoHistory,
    /// Settings session, while the panel is open.
    pub settings_session: Option<SettingsSession>,
    /// The study's file name, or a substitute if it has not been saved.
    pub study_name: String,
    /// Whether there are unsaved decisions.
    pub unsaved: bool,
    pub display: Display,
    pub results: Results,
    /// Cautions from reading the dataset file.
    pub file_cautions: Vec<FileCaution>,
    /// Differences between the dataset and the saved study's dataset.
    pub differences: Vec<Difference>,
    /// Messages of the session, and those in the top bar.
    pub notices: Notices,
    /// Recently opened and saved files, newest first.
    pub recent: Vec<RecentFile>,
    /// Name of the file being read.
    pub opening: Option<String>,
    pub forms: Forms,
    /// Current step in the guided tour, from 0; `None` while no tour is shown.
    pub tour: Option<usize>,
    /// Flight records, and models identified from them.
    pub records: RecordsState,
    /// Models being imported, shown instead of the study.
    pub assembling: Option<AssemblyState>,
}

impl State {
    /// Creates the state for a window that shows `study` for the first time.
    pub fn new(study: Study, study_name: String, file_cautions: Vec<FileCaution>) -> Self {
        let pair = study
            .dataset
            .measuring_pairs()
            .marked()
            .next()
            .unwrap_or_default();
        let condition = study.dataset.conditions()[0].id();
        // Responses that are or have been constrained in this session.
        let once_held = study.settings.constrained.marked().collect();
        let mut display = Display::default();
        display.selection.condition = condition;
        display.selection.pair = pair;
        display.gains.once_held = once_held;
        Self {
            followed: Arc::clone(&study.dataset),
            study,
            example: None,
            on_start_page: false,
            history: History::default(),
            settings_session: None,
            study_name,
            unsaved: false,
            display,
            results: Results::default(),
            file_cautions,
            differences: Vec::new(),
            notices: Notices::default(),
            recent: Vec::new(),
            opening: None,
            forms: Forms::default(),
            tour: None,
            records: RecordsState::default(),
            assembling: None,
        }
    }

    /// Returns whether a view is in front, beside it or in the dock; false on the start page.
    pub fn shows_view(&self, view: View) -> bool {
        !self.on_start_page && self.display.layout.arrangement.is_shown(view)
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

    /// Adapts the displayed selection to a replaced dataset, and drops the display options that
    /// concern single models and the results that do not name their dataset; does nothing if the
    /// dataset is the same. Keeps the response in focus if the dataset contains it; otherwise
    /// selects the first on-axis response, or the first response if none is on-axis.
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
        // These results do not name their dataset; their condition may exist in the new one too.
        self.results.trade_off = None;
        self.results.record_history = None;
        self.results.time_histories = None;
        self.display.selection.hovered = None;
        self.display.selection.isolated = None;
        self.display.curves.forget_models();
        self.display.frequency.shapes.clear();
        self.display.frequency.fit();
    }

    /// Says how many models in a bundle are kept, such as "14 of 19".
    pub fn kept_words(&self, kind: BundleKind) -> String {
        let count = self.condition().bundle(kind).len();
        let choice = self.study.choice(self.condition().id());
        let rejected = choice.bundle(kind).rejected.len();
        format!("{} of {count}", count - rejected)
    }

    /// Returns a model's id in the displayed condition.
    pub fn model_id(&self, bundle: BundleKind, name: &str) -> ModelId {
        ModelId::new(self.condition().id(), bundle, name)
    }
}
