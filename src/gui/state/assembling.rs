//! State while models are imported: the models found, the rules that turn them into a dataset, and
//! how both are displayed.
//!
//! A found model ([`FoundModel`]) is a model as read from a file, with the channels in the file's
//! order and units. The rules ([`Rules`]) say where the found models belong in the dataset. An
//! assembly ([`Assembly`]) applies rules to found models; each of its parts is a found model with
//! its place in the dataset and its channels matched.

use std::collections::BTreeMap;
use std::path::PathBuf;

use gdcm_io::formats::text::UnitNotGiven;
use gdcm_model::assembly::{Assembly, FoundModel, Headings, Rules, proposed_rules};

use super::assembly_columns::COLUMNS;
use crate::gui::plot::{BodeCurve, BodeView};
use crate::gui::widgets::tables::Sorting;

/// Maximum number of undo steps.
const MOST_STEPS: usize = 200;

/// Progress while files are read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadingProgress {
    /// Current file, counted from 1.
    pub number: usize,
    /// Total file count.
    pub total: usize,
    /// Name of the current file.
    pub name: String,
    /// Bytes of values read so far from the current file.
    pub read_bytes: u64,
}

/// Models being imported.
#[derive(Debug, Default)]
pub struct AssemblyState {
    /// The models with the rules applied.
    assembly: Assembly,
    /// Rules before each undoable change, oldest first.
    undo_rules: Vec<Rules>,
    /// Rules before each undo, oldest first.
    redo_rules: Vec<Rules>,
    /// Whether the engineer changed the rules; otherwise they are proposed.
    are_rules_changed: bool,
    /// The requested files and folders.
    pub sources: Vec<PathBuf>,
    /// Messages about unreadable content.
    pub faults: Vec<String>,
    /// Messages about content that is not a model.
    pub ignored: Vec<String>,
    /// Unused content in model files, a line each.
    pub unused: Vec<String>,
    /// The tables among the files, with the headings used to read them.
    pub tables: Headings,
    /// Units still needed to read these tables as frequency responses, by table.
    pub missing_units: BTreeMap<String, Vec<UnitNotGiven>>,
    /// Progress of a running read.
    pub reading: Option<ReadingProgress>,
    /// Index of the displayed model.
    pub selected: usize,
    pub sorting: Sorting,
    /// Displayed response of the selected model.
    pub preview: Preview,
    /// Whether the path field has received the focus, as it does when the import opens.
    pub had_focus: bool,
    /// Path to a folder or a file, as typed.
    pub source_path: String,
    /// Path to the rules, as typed.
    pub rules_path: String,
    /// Path to the dataset, as typed.
    pub dataset_path: String,
}

impl AssemblyState {
    /// Returns the models with the rules applied.
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }

    /// Adds models; rules that the engineer has not changed are proposed again, with `name` as the
    /// dataset's name. A model that is read again replaces its earlier version.
    pub fn add(&mut self, name: &str, found: Vec<FoundModel>) {
        let known = self.assembly.parts().iter();
        let mut models: Vec<FoundModel> = known.map(|part| part.found.clone()).collect();
        models.retain(|model| !found.iter().any(|new| new.key() == model.key()));
        models.extend(found);
        let rules = if self.are_rules_changed {
            self.assembly.rules().clone()
        } else {
            proposed_rules(name, &models)
        };
        self.assembly = Assembly::new(models, rules);
        self.selected = self
            .selected
            .min(self.assembly.parts().len().saturating_sub(1));
    }

    /// Removes all models, and the messages and tables of their files; the rules remain.
    pub fn forget_models(&mut self) {
        self.assembly = Assembly::new(Vec::new(), self.assembly.rules().clone());
        self.faults.clear();
        self.ignored.clear();
        self.unused.clear();
        self.tables.clear();
        self.missing_units.clear();
    }

    /// Replaces the rules as an undoable step.
    pub fn change(&mut self, rules: Rules) {
        if rules == *self.assembly.rules() {
            return;
        }
        self.undo_rules.push(self.assembly.rules().clone());
        if self.undo_rules.len() > MOST_STEPS {
            self.undo_rules.remove(0);
        }
        self.redo_rules.clear();
        self.apply(rules);
    }

    /// Undoes the last change to the rules.
    pub fn undo(&mut self) {
        if let Some(rules) = self.undo_rules.pop() {
            self.redo_rules.push(self.assembly.rules().clone());
            self.apply(rules);
        }
    }

    /// Redoes the last undone change to the rules.
    pub fn redo(&mut self) {
        if let Some(rules) = self.redo_rules.pop() {
            self.undo_rules.push(self.assembly.rules().clone());
            self.apply(rules);
        }
    }

    pub fn can_undo(&self) -> bool {
        !self.undo_rules.is_empty()
    }

    pub fn can_redo(&self) -> bool {
        !self.redo_rules.is_empty()
    }

    /// Applies rules that the engineer has changed, without recording a step.
    fn apply(&mut self, rules: Rules) {
        self.are_rules_changed = true;
        self.assembly = self.assembly.with_rules(rules);
    }

    /// Returns the tables, including `file`, that need the same units under the same headings.
    pub fn tables_alike(&self, file: &str) -> Vec<&String> {
        let mut alike = Vec::new();
        for (other, headings) in &self.tables {
            if Some(headings) == self.tables.get(file)
                && self.missing_units.get(other) == self.missing_units.get(file)
            {
                alike.push(other);
            }
        }
        alike
    }

    /// Returns the model indices in table order.
    pub fn order(&self) -> Vec<usize> {
        let parts = self.assembly.parts();
        self.sorting
            .order_of(parts.len(), |row, column| COLUMNS[column].text(&parts[row]))
    }
}

/// Preview that shows one response of the selected model.
#[derive(Debug, Default)]
pub struct Preview {
    /// Response index `output * inputs + input`, in file order.
    pub response: usize,
    /// Axis ranges.
    pub view: BodeView,
    /// Curves drawn last, kept while model and response stay the same.
    pub drawn: Option<DrawnPreview>,
}

/// Curves in a preview, and the data from which they were computed.
#[derive(Debug)]
pub struct DrawnPreview {
    pub model: FoundModel,
    /// Response index, as in [`Preview`].
    pub response: usize,
    /// Band \[rad/s\].
    pub band: (f64, f64),
    pub curves: Vec<BodeCurve>,
}
