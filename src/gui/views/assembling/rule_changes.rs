//! Commands that change an import's rules: each holds a changed copy of all rules. A *part* is a
//! model that was found in the files; its *row rule* has the settings for this model alone.

use gdcm_model::assembly::part::Part;
use gdcm_model::assembly::{RowRule, Rules};

use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;

impl AssemblyState {
    /// Returns the command that changes the rules with `change`.
    pub(super) fn rules_change(&self, change: impl FnOnce(&mut Rules)) -> Command {
        let mut rules = self.assembly().rules().clone();
        change(&mut rules);
        AssemblingCommand::Change(Box::new(rules)).into()
    }

    /// Returns the command that changes a model's rule.
    pub(super) fn rule_change(&self, part: usize, change: impl FnOnce(&mut RowRule)) -> Command {
        self.rules_change(|rules| {
            if let Some(part) = self.assembly().parts().get(part) {
                change(rules.rows.entry(part.found.key()).or_default());
            }
        })
    }

    /// Returns the command that changes a column heading and keeps the other headings.
    pub(super) fn heading_change(&self, file: &str, column: usize, heading: &str) -> Command {
        self.rules_change(|rules| {
            let Some(present) = self.tables.get(file) else {
                return;
            };
            let headings = rules
                .headings
                .entry(file.to_owned())
                .or_insert_with(|| present.clone());
            if let Some(place) = headings.get_mut(column) {
                heading.trim().clone_into(place);
            }
        })
    }

    /// Returns the command that adds a unit to a column heading, in this table and in all tables
    /// with the same headings.
    pub(super) fn unit_change(&self, file: &str, column: usize, unit: &str) -> Command {
        self.rules_change(|rules| {
            for file in self.tables_alike(file) {
                let headings = rules
                    .headings
                    .entry(file.clone())
                    .or_insert_with(|| self.tables[file].clone());
                if let Some(heading) = headings.get_mut(column) {
                    *heading = format!("{heading} [{unit}]");
                }
            }
        })
    }

    /// Returns the command that applies `change` to a model and to every model below it (in table
    /// order) in the same folder.
    pub(super) fn fill_down_change(&self, part: usize, change: impl Fn(&mut RowRule)) -> Command {
        let parts = self.assembly().parts();
        let order = self.order();
        self.rules_change(|rules| {
            let Some(first) = order.iter().position(|index| *index == part) else {
                return;
            };
            for &index in &order[first..] {
                if folder(&parts[index]) == folder(&parts[part]) {
                    change(rules.rows.entry(parts[index].found.key()).or_default());
                }
            }
        })
    }
}

/// Returns a model's folder; empty at the top level.
fn folder(part: &Part) -> &str {
    match part.found.file().rsplit_once('/') {
        Some((folder, _)) => folder,
        None => "",
    }
}
