//! Importing models from several files: sources above, the dataset to be made below; on the left a
//! table with a row per model, and the problem list; on the right the displayed model, the channels
//! and a preview of the model's response.

mod channels;
mod column_headings;
mod conversions;
mod dataset_bar;
mod declarations;
mod details;
mod model_fields;
mod model_table;
mod path_field;
mod preview;
mod preview_curve;
mod problems;
mod rule_changes;
mod rule_setters;
mod source_bar;
mod typed_rules;

use egui::{CentralPanel, CollapsingHeader, Frame, Margin, Panel, ScrollArea, Ui};

use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::palette::Palette;
use channels::channel_table_ui;
use conversions::conversions_ui;
use dataset_bar::dataset_bar_ui;
use declarations::{signs_ui, units_and_factors_ui};
use details::details_ui;
use model_table::table_ui;
use preview::preview_ui;
use problems::problems_ui;
use source_bar::source_bar_ui;

/// Draws the view, which covers everything between the menu bar and the status bar.
pub fn assembling_ui(
    ui: &mut Ui,
    assembly: &mut AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let bar = Frame::new()
        .fill(palette.panel)
        .inner_margin(Margin::symmetric(10, 6));
    Panel::top("sources of models")
        .frame(bar)
        .show(ui, |ui| source_bar_ui(ui, assembly, palette, commands));
    Panel::bottom("what is made of models")
        .frame(bar)
        .show(ui, |ui| dataset_bar_ui(ui, assembly, palette, commands));
    let width = (0.34 * ui.available_width()).clamp(300.0, 560.0);
    Panel::right("one model")
        .frame(bar)
        .default_size(width)
        .size_range(280.0..=760.0)
        .show(ui, |ui| right_ui(ui, assembly, palette, commands));
    let middle = Frame::new()
        .fill(palette.background)
        .inner_margin(Margin::symmetric(8, 6));
    CentralPanel::default().frame(middle).show(ui, |ui| {
        let height = ui.available_height();
        Panel::bottom("problems of models")
            .resizable(true)
            .default_size(0.24 * height)
            .size_range(60.0..=0.6 * height)
            .show(ui, |ui| problems_ui(ui, assembly, palette, commands));
        table_ui(ui, assembly, palette, commands);
    });
}

/// Draws the displayed model and the channels above the model's response.
fn right_ui(
    ui: &mut Ui,
    assembly: &mut AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let height = ui.available_height();
    Panel::bottom("response of one model")
        .resizable(true)
        .default_size(0.42 * height)
        .size_range(140.0..=0.7 * height)
        .show(ui, |ui| preview_ui(ui, assembly, palette, commands));
    ScrollArea::vertical()
        .id_salt("one model")
        .auto_shrink(false)
        .show(ui, |ui| {
            details_ui(ui, assembly, palette, commands);
            ui.add_space(6.0);
            CollapsingHeader::new("Channels and units")
                .default_open(true)
                .show(ui, |ui| channels_ui(ui, assembly, palette, commands));
        });
}

/// Draws the channels with their units, signs and conversions.
fn channels_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    channel_table_ui(ui, assembly, palette, commands);
    signs_ui(ui, assembly, palette, commands);
    units_and_factors_ui(ui, assembly, palette, commands);
    conversions_ui(ui, assembly, palette, commands);
}
