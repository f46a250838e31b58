//! Details about the displayed model: role, settings, file columns, and notes.
//!
//! A *part* is a model that was found in the files, with the settings that the rules give it.

use egui::{Grid, RichText, Ui};

use gdcm_model::assembly::part::Part;
use gdcm_model::names::RowRole;

use super::column_headings::column_headings_ui;
use super::model_fields::{fill_down_ui, model_fields_ui};
use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::choices::{check_ui, choice_ui};
use crate::gui::widgets::palette::Palette;

/// Draws the displayed model's settings and notes.
pub(super) fn details_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let selected = assembly.selected;
    let Some(part) = assembly.assembly().parts().get(selected) else {
        ui.label(palette.dim("No model yet: add a folder or files above"));
        return;
    };
    ui.label(RichText::new(part.found.key()).strong());
    ui.label(palette.small(part.found.words()));
    let hint = "Only included models are written to the dataset";
    if let Some(is_included) = check_ui(ui, !part.row.left_out, "Include this model", hint) {
        let change = assembly.rule_change(selected, |rule| rule.left_out = Some(!is_included));
        commands.push(change);
    }
    Grid::new("details of a model")
        .num_columns(3)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            role_ui(ui, assembly, part, commands);
            model_fields_ui(ui, assembly, part, commands);
        });
    let file = part.found.file();
    if assembly.tables.contains_key(file) {
        column_headings_ui(ui, assembly, file, palette, commands);
    }
    for side in part.sides_by_position() {
        ui.label(palette.small_warning(format!(
            "caution: the file does not name its {side}s, so they are taken in the order of the \
            dataset; if the order differs, give it in the field {side}s"
        )));
    }
    notes_ui(ui, part, palette);
}

/// Draws the selector for the model's role in its condition.
fn role_ui(ui: &mut Ui, assembly: &AssemblyState, part: &Part, commands: &mut Vec<Command>) {
    ui.label("role");
    let mut role = part.row.role;
    let roles = RowRole::ALL.map(|role| (Some(role), role.word(), "Role in its condition"));
    choice_ui(ui, "Role of the model", &mut role, &roles);
    if role != part.row.role {
        commands.push(assembly.rule_change(assembly.selected, |rule| rule.role = role));
    }
    if fill_down_ui(ui, "role") {
        let role = part.row.role;
        commands.push(assembly.fill_down_change(assembly.selected, |rule| rule.role = role));
    }
    ui.end_row();
}

/// Lists notes about the file, the channels and their conversions.
fn notes_ui(ui: &mut Ui, part: &Part, palette: &Palette) {
    for note in &part.found.notes {
        ui.label(palette.small(note));
    }
    for note in part.inputs.notes.iter().chain(&part.outputs.notes) {
        ui.label(palette.small(note.to_string()));
    }
    for channels in [&part.inputs, &part.outputs] {
        for channel_use in channels.uses.iter().flatten() {
            if let Some(words) = &channel_use.words {
                ui.label(palette.small(words));
            }
        }
    }
}
