//! Commands that change the rules of an import.

use gdcm_model::assembly::{RowRule, Rules};

use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;

impl AssemblyState {
    /// Returns the command that changes the rules with `change`.
    pub fn changed(&self, change: impl FnOnce(&mut Rules)) -> Command {
        let mut rules = self.assembly().rules().clone();
        change(&mut rules);
        AssemblingCommand::Change(Box::new(rules)).into()
    }

    /// Returns the command that changes the rule of one model.
    pub fn said_of(&self, part: usize, say: impl FnOnce(&mut RowRule)) -> Command {
        self.changed(|rules| {
            if let Some(part) = self.assembly().parts().get(part) {
                say(rules.rows.entry(part.found.key()).or_default());
            }
        })
    }

    /// Returns the command that changes the heading of a table's column; the file's own headings
    /// apply where none are given.
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

    /// Returns the command that sets the unit of a column in a table, and in all tables with the
    /// same headings.
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

    /// Returns the command that copies a setting to every model below `part`, in table order, in
    /// the same folder.
    pub fn filled_down(&self, part: usize, say: impl Fn(&mut RowRule)) -> Command {
        let parts = self.assembly().parts();
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
}
