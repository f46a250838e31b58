//! Bar above the table: model folders and files, undo and cancel, reading progress. A *part* is a
//! model found in the files.

use egui::{Button, RichText, Ui};

use gdcm_model::number_format::counted;

use super::path_field::path_field_ui;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::controls::button_ui;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::text_fields::is_entered;

/// Bytes in a mebibyte, the unit of the reading progress.
const BYTES_PER_MIB: u64 = 1 << 20;

pub(super) fn source_bar_ui(
    ui: &mut Ui,
    assembly: &mut AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("Import models").strong());
        add_ui(ui, assembly, commands);
        let can_undo = assembly.can_undo();
        let can_redo = assembly.can_redo();
        let cancel = "Discards this import and returns to the open dataset";
        for (text, is_enabled, hint, command) in [
            ("Choose folder…", true, "", AssemblingCommand::AskFolder),
            ("Undo change", can_undo, "", AssemblingCommand::Undo),
            ("Redo change", can_redo, "", AssemblingCommand::Redo),
            ("Cancel import", true, cancel, AssemblingCommand::Close),
        ] {
            ui.add_enabled_ui(is_enabled, |ui| {
                button_ui(ui, Button::new(text), hint, command, commands)
            });
        }
        reading_ui(ui, assembly, palette, commands);
    });
}

/// Shows the path field and the button that adds its folder or file.
fn add_ui(ui: &mut Ui, assembly: &mut AssemblyState, commands: &mut Vec<Command>) {
    let field = path_field_ui(
        ui,
        "Folder or file of models",
        &mut assembly.source_path,
        "path of a folder or file, or drop it here",
    );
    // The field has the focus when the import opens, and only then.
    if !assembly.had_focus {
        assembly.had_focus = true;
        field.request_focus();
    }
    let is_entered = is_entered(ui, &field);
    let path = assembly.source_path.trim();
    let add = ui.add_enabled(!path.is_empty(), Button::new("Add"));
    if (add.clicked() || is_entered) && !path.is_empty() {
        commands.push(AssemblingCommand::Add(vec![path.into()]).into());
    }
}

/// Shows the reading progress, or the count of included models.
fn reading_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(reading) = &assembly.reading else {
        let parts = assembly.assembly().parts();
        let included = parts.iter().filter(|part| !part.row.left_out).count();
        if !parts.is_empty() {
            let models = counted(parts.len(), "model");
            ui.label(palette.small(format!("{included} of {models} included")));
        }
        return;
    };
    ui.spinner();
    let mebibytes = reading.read_bytes / BYTES_PER_MIB;
    let values = if mebibytes == 0 {
        String::new()
    } else {
        format!(", {mebibytes} MiB of values")
    };
    ui.label(palette.small(format!(
        "reading {} of {}: {}{values}",
        reading.number, reading.total, reading.name
    )));
    let stop = Button::new("Stop reading");
    button_ui(ui, stop, "", AssemblingCommand::StopReading, commands);
}
