//! Commands that add record files, and cautions and questions about the added records.
//!
//! The *assumed* units are those of the dataset, for columns whose unit is neither in the file nor
//! clear from the values.

use egui::containers::menu::MenuButton;
use egui::{Button, Label, Ui};

use gdcm_model::number_format::counted;
use gdcm_sysid::records::{LaidOutRecord, LayoutProblem};

use super::page::Page;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::widgets::controls::{button_ui, entries_ui};

/// Shows the menu that adds records, the reading progress, cautions about assumed units, and files
/// that could not be read.
pub(super) fn source_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page { state, palette, .. } = page;
    ui.horizontal(|ui| {
        add_menu_ui(ui, commands);
        if let Some(reading) = &state.records.reading {
            ui.spinner();
            ui.add(Label::new(palette.small(format!("reading {reading}"))).truncate());
        } else {
            ui.label(palette.small("or drop files here"));
        }
    });
    assumed_units_ui(ui, page, commands);
    for fault in &state.records.faults {
        ui.add(Label::new(palette.small_warning(fault)).wrap());
    }
}

/// Shows the menu that adds files, archives and folders.
fn add_menu_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    let button = Button::new("Add records…");
    let (response, _) = MenuButton::from_button(button).ui(ui, |ui| {
        let entries = [
            ("Files and archives…", RecordsCommand::AskFiles),
            ("Folder…", RecordsCommand::AskFolder),
            ("Path…", RecordsCommand::AskPath),
        ];
        entries_ui(
            ui,
            entries.map(|(text, command)| (text, command.into())),
            commands,
        );
    });
    response.on_hover_text(
        "CSV, text, .mat, .npz, .zip and logs; each record goes to the condition in the name of \
        its file or folder",
    );
}

/// Shows a caution about assumed units, for the records in all conditions.
fn assumed_units_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Some(units) = page.state.records.assumed_units() else {
        return;
    };
    let text = format!(
        "⚠ {} missing: dataset units used",
        counted(units.channels.len(), "unit")
    );
    let hint = format!(
        "Units of {} in {} of {}",
        units.channels.join(", "),
        counted(units.records, "record"),
        counted(units.conditions, "condition")
    );
    ui.horizontal(|ui| {
        ui.label(page.palette.small_warning(text))
            .on_hover_text(hint);
        button_ui(
            ui,
            Button::new("Check").small(),
            "Opens the columns of the first such record; a unit set there applies to all records \
             with the same columns",
            RecordsCommand::CheckUnits,
            commands,
        );
    });
}

/// Offers to make a dataset from records that lack the open dataset's channels, or that belong to
/// none of its conditions.
pub(super) fn other_channels_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let unassigned = &page.state.records.unassigned;
    let has_missing =
        page.records.rows.iter().any(lacks_channels) || unassigned.iter().any(lacks_channels);
    let text = if has_missing {
        "Records without the dataset's channels?"
    } else if unassigned.is_empty() {
        return;
    } else {
        "Records of another aircraft?"
    };
    ui.add(Label::new(page.palette.small(text)).wrap());
    button_ui(
        ui,
        Button::new("Make a dataset from these records…"),
        "Models can be identified from the records before a physics model exists",
        RecordsCommand::AskDataset,
        commands,
    );
}

fn lacks_channels(row: &LaidOutRecord) -> bool {
    row.problems.iter().any(LayoutProblem::is_missing)
}
