//! Section *Columns and units*: a row for each group of records that have the same columns, over
//! all conditions. Most records share a group, so that columns and units are set once; exceptions
//! are further rows.

use egui::{Label, Ui};

use gdcm_model::number_format::counted;

use super::fold_summary::FoldSummary;
use super::page::Page;
use super::record_problems::problem_texts;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::column_groups::ColumnGroup;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, named};

/// Summarises the groups: the count of records to assign; else the count of assumed units; else
/// "same for all 99 ✓" ("1 record ✓" for a single one), or the count of groups.
pub(super) fn columns_summary(state: &State) -> FoldSummary {
    let groups = state.records.column_groups();
    let mut records = 0;
    let mut unusable = 0;
    let mut assumed = 0;
    for group in &groups {
        records += group.records;
        if !group.problems.is_empty() {
            unusable += group.records;
        }
        assumed += group.assumed.len();
    }
    if unusable > 0 {
        return FoldSummary {
            text: format!("⚠ {} to assign", counted(unusable, "record")),
            is_doubtful: true,
        };
    }
    if assumed > 0 {
        return FoldSummary {
            text: format!("⚠ {} assumed", counted(assumed, "unit")),
            is_doubtful: true,
        };
    }
    FoldSummary {
        text: match groups.len() {
            0 => "no records".to_owned(),
            1 if records == 1 => "1 record ✓".to_owned(),
            1 => format!("same for all {records} ✓"),
            count => format!("{count} groups ✓"),
        },
        is_doubtful: false,
    }
}

/// Shows the groups, the largest first.
pub(super) fn columns_fold_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = 3.0;
    for (number, group) in page.state.records.column_groups().iter().enumerate() {
        group_ui(ui, page, number, group, commands);
    }
}

fn group_ui(
    ui: &mut Ui,
    page: Page<'_>,
    number: usize,
    group: &ColumnGroup,
    commands: &mut Vec<Command>,
) {
    let palette = page.palette;
    ui.horizontal(|ui| {
        let mut words = counted(group.records, "record");
        match group.conditions.len() {
            0 => words.push_str(" without a condition"),
            1 => {}
            count => words.push_str(&format!(" of {count} conditions")),
        }
        ui.label(words);
        let Some(place) = group.first else {
            return;
        };
        let is_doubtful = !group.problems.is_empty() || !group.assumed.is_empty();
        let text = if !group.problems.is_empty() {
            "Assign…"
        } else if is_doubtful {
            "Check"
        } else {
            "Change…"
        };
        let button = ui.small_button(text);
        // The first group is named by its text, further groups also by their numbers.
        let name = if number == 0 {
            format!("{text} columns and units")
        } else {
            format!("{text} columns and units of group {}", number + 1)
        };
        named(button, egui::Role::Button, name)
            .on_hover_text("Opens the page Columns; changes apply to all these records")
            .asks(RecordsCommand::ShowColumns(place), commands);
    });
    for problem in problem_texts(&group.problems) {
        ui.add(Label::new(palette.small_warning(problem)).wrap());
    }
    if !group.assumed.is_empty() {
        let words = format!(
            "units of {} missing: dataset units used",
            group.assumed.join(", ")
        );
        ui.add(Label::new(palette.small_warning(words)).wrap());
    }
    ui.add(Label::new(palette.small(group.columns.join(", "))).wrap());
    ui.add_space(4.0);
}
