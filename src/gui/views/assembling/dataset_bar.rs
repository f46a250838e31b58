//! Bar below the table: dataset name and band, rules file, dataset file.

use egui::{Button, RichText, Ui};

use gdcm_model::units::number;

use super::path_field::path_field_ui;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::controls::{Asks, button_ui};
use crate::gui::widgets::number_entry::number_entry_ui;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::text_fields::entry_ui;

pub(super) fn dataset_bar_ui(
    ui: &mut Ui,
    assembly: &mut AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_wrapped(|ui| {
        name_and_band_ui(ui, assembly, palette, commands);
        rules_file_ui(ui, assembly, commands);
        dataset_file_ui(ui, assembly, commands);
    });
}

fn name_and_band_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let rules = assembly.assembly().rules();
    ui.label(palette.small("dataset"));
    if let Some(name) = entry_ui(ui, "Name of the dataset", &rules.name, "name", 140.0) {
        commands.push(assembly.rules_change(|rules| name.trim().clone_into(&mut rules.name)));
    }
    ui.label(palette.small("band [rad/s]"));
    let name = "Lower end of the dataset's band";
    if let Some(low) = band_end_ui(ui, name, rules.band.0, commands) {
        commands.push(assembly.rules_change(|rules| rules.band.0 = low));
    }
    let name = "Upper end of the dataset's band";
    if let Some(high) = band_end_ui(ui, name, rules.band.1, commands) {
        commands.push(assembly.rules_change(|rules| rules.band.1 = high));
    }
}

/// Draws a field for a band limit \[rad/s\]; returns a newly typed value.
fn band_end_ui(ui: &mut Ui, name: &str, value: f64, commands: &mut Vec<Command>) -> Option<f64> {
    number_entry_ui(ui, name, &number(value), "rad/s", 50.0, commands).flatten()
}

fn rules_file_ui(ui: &mut Ui, assembly: &mut AssemblyState, commands: &mut Vec<Command>) {
    path_field_ui(
        ui,
        "Path of the rules",
        &mut assembly.rules_path,
        "path of a .gdcm-rules.json file",
    );
    let path = assembly.rules_path.trim();
    ui.add_enabled_ui(!path.is_empty(), |ui| {
        button_ui(
            ui,
            Button::new("Load rules"),
            "Applies rules that were saved in an earlier import",
            AssemblingCommand::LoadRules(path.into()),
            commands,
        );
        button_ui(
            ui,
            Button::new("Save rules"),
            "For later imports of similar folders",
            AssemblingCommand::SaveRules(path.into()),
            commands,
        );
    });
}

fn dataset_file_ui(ui: &mut Ui, assembly: &mut AssemblyState, commands: &mut Vec<Command>) {
    path_field_ui(
        ui,
        "Path of the dataset to make",
        &mut assembly.dataset_path,
        "path of a .json.gz file",
    );
    let path = assembly.dataset_path.trim();
    let is_ready = !path.is_empty() && assembly.assembly().problems().is_empty();
    let text = RichText::new("Make dataset").strong();
    ui.add_enabled(is_ready, Button::new(text))
        .on_hover_text("Writes the dataset with its rules beside it, and opens the dataset")
        .on_disabled_hover_text("First complete the listed items and enter the path of the dataset")
        .asks(AssemblingCommand::MakeDataset(path.into()), commands);
}
