//! Commands that add record files, questions about the added records, and the commands that
//! identify or use the models of all conditions.

use egui::{Button, Label, Ui};

use gdcm_sysid::records::LayoutProblem;

use super::condition_table::conditions_with_records;
use super::offered_models::offered_models_ui;
use super::page::Page;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, button_ui};
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::text_fields::{is_entered, text_field_ui};

/// Shows the commands that add records, and questions about the added records.
pub(super) fn source_ui(
    ui: &mut Ui,
    page: Page<'_>,
    path: &mut String,
    commands: &mut Vec<Command>,
) {
    let Page { state, palette, .. } = page;
    add_ui(ui, path, commands);
    if let Some(reading) = &state.records.reading {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(palette.small(format!("reading {reading}")));
        });
    }
    open_units_ui(ui, state, palette, commands);
    all_conditions_ui(ui, state, commands);
    other_channels_ui(ui, page, commands);
    for fault in &state.records.faults {
        ui.add(Label::new(palette.small_warning(fault)).wrap());
    }
}

/// Shows the button and the path field that add record files.
fn add_ui(ui: &mut Ui, path: &mut String, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let hint = "CSV, text, .mat, .npz, .zip: files of flight records";
        let add = Button::new("Add records…");
        button_ui(ui, add, hint, RecordsCommand::AskFiles, commands);
        let width = (ui.available_width() - 8.0).max(40.0);
        let field = text_field_ui(ui, "Path of records", path, "or a path", width);
        if is_entered(ui, &field) && !path.trim().is_empty() {
            commands.push(RecordsCommand::Add(vec![path.trim().into()]).into());
        }
    });
}

/// Shows a question about the missing units of all conditions, with buttons that set them.
fn open_units_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(open) = state.records.open_units() else {
        return;
    };
    let channels: Vec<String> = open
        .channels
        .iter()
        .map(|(name, unit)| format!("{name} [{unit}]"))
        .collect();
    let records = if open.records == 1 {
        "1 record".to_owned()
    } else {
        format!("{} records", open.records)
    };
    let conditions = if open.conditions == 1 {
        String::new()
    } else {
        format!(" of {} conditions", open.conditions)
    };
    let question = format!(
        "{records}{conditions} without units: do the units of the dataset apply, {}?",
        channels.join(", ")
    );
    ui.add(Label::new(palette.small_warning(question)).wrap());
    ui.horizontal_wrapped(|ui| {
        button_ui(
            ui,
            Button::new("Take the dataset's units"),
            "Applies to every file without units, in all conditions; one step to undo",
            RecordsCommand::TakeDatasetUnits,
            commands,
        );
        button_ui(
            ui,
            Button::new("Choose others…"),
            "Opens the columns of the first such record; a unit set there applies to all records \
             with the same columns",
            RecordsCommand::ShowUnclear,
            commands,
        );
    });
}

/// Shows the commands for all conditions, if several have records.
fn all_conditions_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let count = conditions_with_records(state).count();
    if count < 2 || !state.records.running.is_empty() {
        return;
    }
    ui.button(format!("Identify all {count} conditions"))
        .on_hover_text("One after another, in the background")
        .asks(RecordsCommand::IdentifyAll, commands);
    let found = state
        .records
        .conditions
        .values()
        .filter(|records| records.identification().is_some())
        .count();
    if found > 1 {
        let text = format!("Use the models of {found} conditions");
        let hint = "Replaces the identified models of these conditions; one step to undo";
        if let Some(offered) = offered_models_ui(ui, &text, hint) {
            commands.push(RecordsCommand::TakeAll(offered).into());
        }
    }
}

/// Offers to make a dataset from records that lack the open dataset's channels.
fn other_channels_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let has_missing = page
        .records
        .rows
        .iter()
        .any(|row| row.problems.iter().any(LayoutProblem::is_missing));
    if !has_missing {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.label(
            page.palette
                .small("Records without the dataset's channels?"),
        );
        button_ui(
            ui,
            Button::new("Make a dataset from them…"),
            "Models can be identified from them before a physics model exists",
            RecordsCommand::AskDataset,
            commands,
        );
    });
}
