//! What is being imported: the models found, the rules about them, and what is shown of both.

use std::collections::BTreeMap;
use std::path::PathBuf;

use gdcm_io::formats::text::UnsaidUnit;
use gdcm_model::assembly::{Assembly, FoundModel, Headings, RowRule, Rules, proposed_rules};

use super::COLUMNS;
use super::details::Preview;
use crate::view::command::Command;
use crate::view::tables::Sorting;

/// Most steps that can be undone.
const MOST_STEPS: usize = 200;

/// What the engineer asks for while models are imported.
#[derive(Clone, Debug, PartialEq)]
pub enum AssemblingCommand {
    /// Begin, or go on.
    Open,
    /// Choose a folder with the desktop's dialog.
    AskFolder,
    /// Read files, and folders with all that is in them.
    Add(Vec<PathBuf>),
    /// Read no further.
    StopReading,
    /// Say something else about the files.
    Change(Box<Rules>),
    /// Take the last change back.
    Undo,
    /// Bring it back again.
    Redo,
    /// Show a model.
    Select(usize),
    /// Sort the table by the column of this index; by the same one the other way round.
    Sort(usize),
    /// Show the response of this place in the preview.
    ShowResponse(usize),
    /// Load rules from a file.
    LoadRules(PathBuf),
    /// Write the rules to a file.
    SaveRules(PathBuf),
    /// Write the dataset and its rules, and open it.
    MakeDataset(PathBuf),
    /// Leave it; nothing of it is kept.
    Close,
}

/// How far the reading of files is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// Number of the file that is being read, from 1.
    pub number: usize,
    /// How many there are.
    pub of: usize,
    /// Its name.
    pub name: String,
    /// Bytes of its values that are read.
    pub taken: u64,
}

/// Models that are being imported.
#[derive(Debug, Default)]
pub struct AssemblyState {
    assembly: Assembly,
    earlier: Vec<Rules>,
    later: Vec<Rules>,
    /// Whether the rules are the engineer's, and not proposed.
    are_said: bool,
    /// What was read: the files and folders asked for.
    pub sources: Vec<PathBuf>,
    /// What could not be taken, in words.
    pub faults: Vec<String>,
    /// What is no model, in words.
    pub ignored: Vec<String>,
    /// What of files with models was not used, a line for each.
    pub unused: Vec<String>,
    /// The tables of columns among the files, with the headings that they were read by.
    pub tables: Headings,
    /// The units that have to be said before these tables are frequency responses.
    pub unsaid: BTreeMap<String, Vec<UnsaidUnit>>,
    /// The reading under way.
    pub reading: Option<Reading>,
    /// Index of the model shown.
    pub selected: usize,
    /// How the table is sorted.
    pub sorting: Sorting,
    /// The response of the model shown.
    pub preview: Preview,
    /// Path of a folder or a file, as typed.
    pub source_path: String,
    /// Path of the rules, as typed.
    pub rules_path: String,
    /// Path of the dataset, as typed.
    pub dataset_path: String,
}

impl AssemblyState {
    /// The models and what the rules make of them.
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }

    /// Takes more models; rules that nothing was said in yet are proposed anew. A model that was found before takes its place again.
    pub fn add(&mut self, name: &str, found: Vec<FoundModel>) {
        let mut models: Vec<FoundModel> = self
            .assembly
            .parts()
            .iter()
            .map(|part| part.found.clone())
            .collect();
        models.retain(|model| !found.iter().any(|new| new.key() == model.key()));
        models.extend(found);
        let rules = match self.are_said {
            true => self.assembly.rules().clone(),
            false => proposed_rules(name, &models),
        };
        self.assembly = Assembly::new(models, rules);
        self.selected = self
            .selected
            .min(self.assembly.parts().len().saturating_sub(1));
    }

    /// Forgets all models and what was told of their files; what was said of them stays.
    pub fn forget_models(&mut self) {
        self.assembly = Assembly::new(Vec::new(), self.assembly.rules().clone());
        self.faults.clear();
        self.ignored.clear();
        self.unused.clear();
        self.tables.clear();
        self.unsaid.clear();
    }

    /// Takes other rules, which can be undone.
    pub fn change(&mut self, rules: Rules) {
        if rules == *self.assembly.rules() {
            return;
        }
        self.earlier.push(self.assembly.rules().clone());
        if self.earlier.len() > MOST_STEPS {
            self.earlier.remove(0);
        }
        self.later.clear();
        self.put(rules);
    }

    /// Takes the last change back.
    pub fn undo(&mut self) {
        if let Some(rules) = self.earlier.pop() {
            self.later.push(self.assembly.rules().clone());
            self.put(rules);
        }
    }

    /// Brings the change taken back last again.
    pub fn redo(&mut self) {
        if let Some(rules) = self.later.pop() {
            self.earlier.push(self.assembly.rules().clone());
            self.put(rules);
        }
    }

    /// Whether there is something to undo, and to redo.
    pub fn steps(&self) -> (bool, bool) {
        (!self.earlier.is_empty(), !self.later.is_empty())
    }

    fn put(&mut self, rules: Rules) {
        self.are_said = true;
        self.assembly = self.assembly.with_rules(rules);
    }

    /// The command that changes the rules in this way.
    pub fn changed(&self, change: impl FnOnce(&mut Rules)) -> Command {
        let mut rules = self.assembly.rules().clone();
        change(&mut rules);
        AssemblingCommand::Change(Box::new(rules)).into()
    }

    /// The command that says something else about one model.
    pub fn said_of(&self, part: usize, say: impl FnOnce(&mut RowRule)) -> Command {
        self.changed(|rules| {
            if let Some(part) = self.assembly.parts().get(part) {
                say(rules.rows.entry(part.found.key()).or_default());
            }
        })
    }

    /// The command that gives a column of a table another heading; the file's own headings stand where nothing else is said.
    pub fn with_heading(&self, file: &str, column: usize, heading: &str) -> Command {
        self.changed(|rules| {
            let Some(headings) = self.tables.get(file) else {
                return;
            };
            let said = rules
                .headings
                .entry(file.to_owned())
                .or_insert_with(|| headings.clone());
            if let Some(place) = said.get_mut(column) {
                heading.trim().clone_into(place);
            }
        })
    }

    /// The command that says the unit of a column in a table, and in every other that has the same headings.
    pub fn with_unit(&self, file: &str, column: usize, unit: &str) -> Command {
        self.changed(|rules| {
            for file in self.tables_alike(file) {
                let said = rules
                    .headings
                    .entry(file.clone())
                    .or_insert_with(|| self.tables[file].clone());
                if let Some(heading) = said.get_mut(column) {
                    *heading = format!("{heading} [{unit}]");
                }
            }
        })
    }

    /// The tables that ask for the same units under the same headings, this one among them.
    pub fn tables_alike(&self, file: &str) -> Vec<&String> {
        let of = |file: &str| (self.tables.get(file), self.unsaid.get(file));
        self.tables
            .keys()
            .filter(|other| of(other.as_str()) == of(file))
            .collect()
    }

    /// The command that says the same about every model below `part`, in the order of the table, of its folder.
    pub fn filled_down(&self, part: usize, say: impl Fn(&mut RowRule)) -> Command {
        let parts = self.assembly.parts();
        let folder = |part: usize| {
            parts.get(part).map(|part| {
                part.found
                    .file()
                    .rsplit_once('/')
                    .map_or("", |(folder, _)| folder)
            })
        };
        let order = self.order();
        let below = order.iter().skip_while(|index| **index != part);
        self.changed(|rules| {
            for index in below.filter(|index| folder(**index) == folder(part)) {
                say(rules.rows.entry(parts[*index].found.key()).or_default());
            }
        })
    }

    /// Indices of the models in the order of the table.
    pub fn order(&self) -> Vec<usize> {
        let parts = self.assembly.parts();
        self.sorting
            .order_of(parts.len(), |row, column| COLUMNS[column].text(&parts[row]))
    }
}
