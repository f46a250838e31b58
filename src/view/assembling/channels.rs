//! The channels of the dataset: names, units, and what files that do not say mean.

use egui::{Grid, RichText, Role, Ui, WidgetInfo};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use gdcm_core::assembly::{ChannelRule, ProblemKind, Rules, UnitRule};
use gdcm_core::units::number;

use super::entry::{entry_ui, typed_number};
use super::workbench::{AssemblingCommand, Workbench};

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
pub(super) fn channels_ui(ui: &mut Ui, bench: &Workbench, palette: &Palette, commands: &mut Vec<Command>) {
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
    bench: &Workbench,
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
fn conversions_ui(ui: &mut Ui, bench: &Workbench, palette: &Palette, commands: &mut Vec<Command>) {
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
