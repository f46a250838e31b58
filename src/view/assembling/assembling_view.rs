//! The whole of the assembling view: sources above, table and problems at the left, one model and the channels at the right.

use egui::{
    Button, CentralPanel, CollapsingHeader, Frame, Grid, Key, Margin, Panel, RichText, Role, ScrollArea, TextEdit, Ui,
    WidgetInfo,
};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use gdcm_core::assembly::{ChannelRule, ProblemKind, Rules, UnitRule};
use gdcm_core::units::number;

use super::assembly_state::{AssemblingCommand, AssemblyState};
use super::details::{details_ui, entry_ui, typed_number};
use super::preview::preview_ui;
use super::table::{problems_ui, table_ui};

/// Draws the view in the place of everything below the menu.
pub fn assembling_ui(ui: &mut Ui, bench: &mut AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
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

fn right_ui(ui: &mut Ui, bench: &mut AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
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

fn sources_ui(ui: &mut Ui, bench: &mut AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
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

fn reading_ui(ui: &mut Ui, bench: &AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
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

fn making_ui(ui: &mut Ui, bench: &mut AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
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
fn settings_ui(ui: &mut Ui, bench: &AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
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

/// One side of the model.
#[derive(Clone, Copy)]
enum Side {
    Inputs,
    Outputs,
}

impl Side {
    fn word(self) -> &'static str {
        match self {
            Self::Inputs => "input",
            Self::Outputs => "output",
        }
    }

    fn channels(self, rules: &mut Rules) -> &mut Vec<ChannelRule> {
        match self {
            Self::Inputs => &mut rules.inputs,
            Self::Outputs => &mut rules.outputs,
        }
    }
}

/// Names and units of every channel, and conversions that units alone do not give.
pub(super) fn channels_ui(ui: &mut Ui, bench: &AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
    let rules = bench.assembly().rules();
    Grid::new("channels of the dataset").num_columns(4).spacing([6.0, 3.0]).show(ui, |ui| {
        for heading in ["channel", "unit", "where files do not say", ""] {
            ui.label(RichText::new(heading).size(SMALL_SIZE).color(palette.dim_text));
        }
        ui.end_row();
        for (side, channels) in [(Side::Inputs, &rules.inputs), (Side::Outputs, &rules.outputs)] {
            for (index, channel) in channels.iter().enumerate() {
                channel_ui(ui, bench, (side, index), channel, commands);
            }
        }
    });
    ui.horizontal(|ui| {
        for side in [Side::Inputs, Side::Outputs] {
            if ui.small_button(format!("Add {}", side.word())).clicked() {
                let mut rules = rules.clone();
                let channels = side.channels(&mut rules);
                channels.push(ChannelRule::named(format!("{} {}", side.word(), channels.len() + 1)));
                push(rules, commands);
            }
        }
    });
    conversions_ui(ui, bench, palette, commands);
}

fn push(rules: Rules, commands: &mut Vec<Command>) {
    commands.push(AssemblingCommand::Change(Box::new(rules)).into());
}

fn channel_ui(
    ui: &mut Ui,
    bench: &AssemblyState,
    (side, index): (Side, usize),
    channel: &ChannelRule,
    commands: &mut Vec<Command>,
) {
    let changed = |change: &dyn Fn(&mut ChannelRule)| {
        let mut rules = bench.assembly().rules().clone();
        if let Some(channel) = side.channels(&mut rules).get_mut(index) {
            change(channel);
        }
        rules
    };
    let name = |what: &str| format!("{what} of {} {}", side.word(), index + 1);
    if let Some(text) = entry_ui(ui, &name("Name"), &channel.name, "name", 90.0) {
        push(changed(&|channel| text.trim().clone_into(&mut channel.name)), commands);
    }
    if let Some(text) = entry_ui(ui, &name("Unit"), &channel.unit, "?", 80.0) {
        push(changed(&|channel| text.trim().clone_into(&mut channel.unit)), commands);
    }
    let in_files = channel.unit_in_files.clone().unwrap_or_default();
    if let Some(text) = entry_ui(ui, &name("Unit in files"), &in_files, "as files say", 110.0) {
        let said = Some(text.trim().to_owned()).filter(|text| !text.is_empty());
        push(changed(&|channel| channel.unit_in_files.clone_from(&said)), commands);
    }
    let remove = ui.small_button("×");
    let label = format!("Remove {} {}", side.word(), channel.name);
    remove.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    if remove.on_hover_text(&label).clicked() {
        let mut rules = bench.assembly().rules().clone();
        side.channels(&mut rules).remove(index);
        push(rules, commands);
    }
    ui.end_row();
}

/// A factor for each conversion that is asked for, and for those that were said.
fn conversions_ui(ui: &mut Ui, bench: &AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
    let rules = bench.assembly().rules();
    let mut asked: Vec<(String, String, String)> = Vec::new();
    for problem in bench.assembly().problems() {
        if let ProblemKind::Conversion { channel, from, to } = &problem.kind {
            let conversion = (channel.clone(), from.clone(), to.clone());
            if !asked.contains(&conversion) {
                asked.push(conversion);
            }
        }
    }
    let said = rules.units.iter().map(|unit| (unit.channel.clone(), unit.from.clone(), String::new()));
    for (channel, from, to) in said.chain(asked) {
        let known = rules.units.iter().find(|unit| unit.channel == channel && unit.from == from);
        ui.horizontal(|ui| {
            ui.label(RichText::new(format!("{channel}: 1 {from} =")).size(SMALL_SIZE).color(palette.text));
            let value = known.map_or(String::new(), |unit| number(unit.factor));
            let name = format!("Factor of {channel} from {from}");
            if let Some(text) = entry_ui(ui, &name, &value, "factor", 60.0) {
                match typed_number(&text) {
                    Ok(factor) => push(with_factor(rules, (&channel, &from), factor), commands),
                    Err(why) => commands.push(Command::Refuse(format!("{name}: {why}"))),
                }
            }
            ui.label(RichText::new(to).size(SMALL_SIZE).color(palette.dim_text));
        });
    }
}

fn with_factor(rules: &Rules, (channel, from): (&str, &str), factor: Option<f64>) -> Rules {
    let mut rules = rules.clone();
    rules.units.retain(|unit| !(unit.channel == channel && unit.from == from));
    rules.units.extend(factor.map(|factor| UnitRule { channel: channel.to_owned(), from: from.to_owned(), factor }));
    rules
}
