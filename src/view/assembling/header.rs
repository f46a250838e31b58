//! The whole of the assembling view: sources above, table and problems at the left, one model and the channels at the right.

use egui::{
    Button, CentralPanel, CollapsingHeader, Frame, Key, Margin, Panel, RichText, Role, ScrollArea, TextEdit, Ui,
    WidgetInfo,
};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};

use super::channels::channels_ui;
use super::details::details_ui;
use super::entry::{entry_ui, typed_number};
use super::preview::preview_ui;
use super::problems::problems_ui;
use super::table::table_ui;
use super::workbench::{AssemblingCommand, Workbench};

/// Draws the view in the place of everything below the menu.
pub fn assembling_ui(ui: &mut Ui, bench: &mut Workbench, palette: &Palette, commands: &mut Vec<Command>) {
    let bar = Frame::new().fill(palette.panel).inner_margin(Margin::symmetric(10, 6));
    Panel::top("sources of models").frame(bar).show(ui, |ui| sources_ui(ui, bench, palette, commands));
    Panel::bottom("what is made of models").frame(bar).show(ui, |ui| making_ui(ui, bench, palette, commands));
    let side = Frame::new().fill(palette.panel).inner_margin(Margin::symmetric(10, 6));
    let width = ui.available_width();
    let panel = Panel::right("one model")
        .frame(side)
        .default_size((0.34 * width).clamp(300.0, 560.0))
        .size_range(280.0..=760.0);
    panel.show(ui, |ui| right_ui(ui, bench, palette, commands));
    let middle = Frame::new().fill(palette.background).inner_margin(Margin::symmetric(8, 6));
    CentralPanel::default().frame(middle).show(ui, |ui| {
        let height = ui.available_height();
        let panel = Panel::bottom("problems of models")
            .resizable(true)
            .default_size(0.24 * height)
            .size_range(60.0..=0.6 * height);
        panel.show(ui, |ui| problems_ui(ui, bench, palette, commands));
        table_ui(ui, bench, palette, commands);
    });
}

fn right_ui(ui: &mut Ui, bench: &mut Workbench, palette: &Palette, commands: &mut Vec<Command>) {
    let height = ui.available_height();
    let panel = Panel::bottom("response of one model")
        .resizable(true)
        .default_size(0.42 * height)
        .size_range(140.0..=0.7 * height);
    panel.show(ui, |ui| preview_ui(ui, bench, palette, commands));
    ScrollArea::vertical().id_salt("one model").auto_shrink(false).show(ui, |ui| {
        details_ui(ui, bench, palette, commands);
        ui.add_space(6.0);
        CollapsingHeader::new("Channels and units")
            .default_open(true)
            .show(ui, |ui| channels_ui(ui, bench, palette, commands));
    });
}

fn sources_ui(ui: &mut Ui, bench: &mut Workbench, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("Put models together").strong());
        let entered = path_ui(
            ui,
            "Folder or file of models",
            &mut bench.source_path,
            "path of a folder or a file; or drop them here",
        );
        let path = bench.source_path.trim();
        if (ui.add_enabled(!path.is_empty(), Button::new("Add")).clicked() || entered) && !path.is_empty() {
            commands.push(AssemblingCommand::Add(vec![path.into()]).into());
        }
        if ui.button("Choose folder…").clicked() {
            commands.push(AssemblingCommand::AskFolder.into());
        }
        let (undo, redo) = bench.steps();
        if ui.add_enabled(undo, Button::new("Undo change")).clicked() {
            commands.push(AssemblingCommand::Undo.into());
        }
        if ui.add_enabled(redo, Button::new("Redo change")).clicked() {
            commands.push(AssemblingCommand::Redo.into());
        }
        if ui.button("Leave").on_hover_text("Back to the dataset that is open; nothing of this is kept").clicked() {
            commands.push(AssemblingCommand::Close.into());
        }
        reading_ui(ui, bench, palette, commands);
    });
}

fn reading_ui(ui: &mut Ui, bench: &Workbench, palette: &Palette, commands: &mut Vec<Command>) {
    let small = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    match &bench.reading {
        Some(reading) => {
            ui.spinner();
            let taken = match reading.taken >> 20 {
                0 => String::new(),
                megabytes => format!(", {megabytes} MiB of values"),
            };
            ui.label(small(format!("reading {} of {}: {}{taken}", reading.number, reading.of, reading.name)));
            if ui.button("Stop reading").clicked() {
                commands.push(AssemblingCommand::StopReading.into());
            }
        }
        None => {
            let taken = bench.assembly().parts().iter().filter(|part| !part.row.left_out).count();
            ui.label(small(format!("{taken} of {} models taken", bench.assembly().parts().len())));
        }
    }
}

fn path_ui(ui: &mut Ui, name: &str, text: &mut String, hint: &str) -> bool {
    let width = (0.22 * ui.available_width()).clamp(120.0, 360.0);
    let response = ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(width));
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::TextInput, true, name);
        info.current_text_value = Some(text.clone());
        info
    });
    response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}

fn making_ui(ui: &mut Ui, bench: &mut Workbench, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        settings_ui(ui, bench, palette, commands);
        path_ui(ui, "Path of the rules", &mut bench.rules_path, "path of a .gdcm-rules.json file");
        let rules = bench.rules_path.trim();
        let is_path = !rules.is_empty();
        if ui.add_enabled(is_path, Button::new("Take rules")).on_hover_text("Rules that were written before").clicked()
        {
            commands.push(AssemblingCommand::LoadRules(rules.into()).into());
        }
        if ui
            .add_enabled(is_path, Button::new("Write rules"))
            .on_hover_text("For the next folder of this kind")
            .clicked()
        {
            commands.push(AssemblingCommand::SaveRules(rules.into()).into());
        }
        path_ui(ui, "Path of the dataset to make", &mut bench.dataset_path, "path of a .json.gz file");
        let path = bench.dataset_path.trim();
        let is_ready = !path.is_empty() && bench.assembly().problems().is_empty();
        let button = ui.add_enabled(is_ready, Button::new(RichText::new("Make dataset").strong()));
        let hint = "Writes the dataset and, beside it, its rules, and opens it";
        let why_not = "Say what is missing first, and where the dataset is to be written";
        if button.on_hover_text(hint).on_disabled_hover_text(why_not).clicked() {
            commands.push(AssemblingCommand::MakeDataset(path.into()).into());
        }
    });
}

/// Name and band of the dataset.
fn settings_ui(ui: &mut Ui, bench: &Workbench, palette: &Palette, commands: &mut Vec<Command>) {
    let rules = bench.assembly().rules();
    let dim = |text: &str| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    ui.label(dim("dataset"));
    if let Some(name) = entry_ui(ui, "Name of the dataset", &rules.name, "name", 140.0) {
        let mut rules = rules.clone();
        name.trim().clone_into(&mut rules.name);
        commands.push(AssemblingCommand::Change(Box::new(rules)).into());
    }
    ui.label(dim("band [rad/s]"));
    let ends = [("Lower end of the dataset's band", rules.band.0), ("Upper end of the dataset's band", rules.band.1)];
    for (index, (name, value)) in ends.into_iter().enumerate() {
        let Some(text) = entry_ui(ui, name, &gdcm_core::units::number(value), "rad/s", 50.0) else { continue };
        match typed_number(&text) {
            Ok(Some(value)) => {
                let mut rules = rules.clone();
                if index == 0 {
                    rules.band.0 = value
                } else {
                    rules.band.1 = value
                }
                commands.push(AssemblingCommand::Change(Box::new(rules)).into());
            }
            Ok(None) => {}
            Err(why) => commands.push(Command::Refuse(format!("{name}: {why}"))),
        }
    }
}
