//! Importing models from several files: sources above, a table with one line per model and the list
//! of problems on the left, the selected model and the channels on the right.

mod details;
mod rule_changes;
mod table;

use egui::{
    Button, CentralPanel, CollapsingHeader, Frame, Grid, Margin, Panel, RichText, Role, ScrollArea,
    Ui,
};

use gdcm_model::assembly::declarations::Signs;
use gdcm_model::assembly::problem::ProblemKind;
use gdcm_model::assembly::{FileScope, Rules, UnitRule};
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::ChannelRule;
use gdcm_model::units::number;

use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::controls::{
    Asks, button_ui, entry_ui, is_entered, named, number_entry_ui, text_field_ui,
};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};
use details::{details_ui, factors_of, preview_ui, signs_of, trim_words, unit_words, units_of};
use table::{problems_ui, table_ui};

/// Draws the view, which covers everything below the menu.
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
        .show(ui, |ui| sources_ui(ui, assembly, palette, commands));
    Panel::bottom("what is made of models")
        .frame(bar)
        .show(ui, |ui| making_ui(ui, assembly, palette, commands));
    let width = (0.34 * ui.available_width()).clamp(300.0, 560.0);
    let side = Panel::right("one model")
        .frame(bar)
        .default_size(width)
        .size_range(280.0..=760.0);
    side.show(ui, |ui| right_ui(ui, assembly, palette, commands));
    let middle = Frame::new()
        .fill(palette.background)
        .inner_margin(Margin::symmetric(8, 6));
    CentralPanel::default().frame(middle).show(ui, |ui| {
        let height = ui.available_height();
        let problems = Panel::bottom("problems of models").resizable(true);
        let problems = problems
            .default_size(0.24 * height)
            .size_range(60.0..=0.6 * height);
        problems.show(ui, |ui| problems_ui(ui, assembly, palette, commands));
        table_ui(ui, assembly, palette, commands);
    });
}

fn right_ui(
    ui: &mut Ui,
    assembly: &mut AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let height = ui.available_height();
    let response = Panel::bottom("response of one model").resizable(true);
    let response = response
        .default_size(0.42 * height)
        .size_range(140.0..=0.7 * height);
    response.show(ui, |ui| preview_ui(ui, assembly, palette, commands));
    ScrollArea::vertical()
        .id_salt("one model")
        .auto_shrink(false)
        .show(ui, |ui| {
            details_ui(ui, assembly, palette, commands);
            ui.add_space(6.0);
            let channels = CollapsingHeader::new("Channels and units").default_open(true);
            channels.show(ui, |ui| channels_ui(ui, assembly, palette, commands));
        });
}

fn sources_ui(
    ui: &mut Ui,
    assembly: &mut AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("Import models").strong());
        let hint = "path of a folder or a file; or drop them here";
        let entered = path_ui(
            ui,
            "Folder or file of models",
            &mut assembly.source_path,
            hint,
        );
        let path = assembly.source_path.trim();
        if (ui
            .add_enabled(!path.is_empty(), Button::new("Add"))
            .clicked()
            || entered)
            && !path.is_empty()
        {
            commands.push(AssemblingCommand::Add(vec![path.into()]).into());
        }
        let (undo, redo) = assembly.steps();
        let hint = "Back to the dataset that is open; nothing of this is kept";
        for (text, enabled, hint, command) in [
            ("Choose folder…", true, "", AssemblingCommand::AskFolder),
            ("Undo change", undo, "", AssemblingCommand::Undo),
            ("Redo change", redo, "", AssemblingCommand::Redo),
            ("Cancel import", true, hint, AssemblingCommand::Close),
        ] {
            ui.add_enabled_ui(enabled, |ui| {
                button_ui(ui, Button::new(text), hint, command, commands)
            });
        }
        reading_ui(ui, assembly, palette, commands);
    });
}

fn reading_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(reading) = &assembly.reading else {
        let parts = assembly.assembly().parts();
        let included = parts.iter().filter(|part| !part.row.left_out).count();
        ui.label(palette.small(format!("{included} of {} models included", parts.len())));
        return;
    };
    ui.spinner();
    let taken = match reading.taken >> 20 {
        0 => String::new(),
        megabytes => format!(", {megabytes} MiB of values"),
    };
    ui.label(palette.small(format!(
        "reading {} of {}: {}{taken}",
        reading.number, reading.of, reading.name
    )));
    button_ui(
        ui,
        Button::new("Stop reading"),
        "",
        AssemblingCommand::StopReading,
        commands,
    );
}

fn path_ui(ui: &mut Ui, name: &str, text: &mut String, hint: &str) -> bool {
    let width = (0.22 * ui.available_width()).clamp(120.0, 360.0);
    let response = text_field_ui(ui, name, text, hint, width);
    is_entered(ui, &response)
}

fn making_ui(
    ui: &mut Ui,
    assembly: &mut AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_wrapped(|ui| {
        dataset_ui(ui, assembly, palette, commands);
        path_ui(
            ui,
            "Path of the rules",
            &mut assembly.rules_path,
            "path of a .gdcm-rules.json file",
        );
        let path = assembly.rules_path.trim();
        ui.add_enabled_ui(!path.is_empty(), |ui| {
            let load = AssemblingCommand::LoadRules(path.into());
            button_ui(
                ui,
                Button::new("Load rules"),
                "Rules that were saved before",
                load,
                commands,
            );
            let save = AssemblingCommand::SaveRules(path.into());
            button_ui(
                ui,
                Button::new("Save rules"),
                "For the next folder of this kind",
                save,
                commands,
            );
        });
        path_ui(
            ui,
            "Path of the dataset to make",
            &mut assembly.dataset_path,
            "path of a .json.gz file",
        );
        let path = assembly.dataset_path.trim();
        let is_ready = !path.is_empty() && assembly.assembly().problems().is_empty();
        let button = ui.add_enabled(
            is_ready,
            Button::new(RichText::new("Make dataset").strong()),
        );
        let hint = "Writes the dataset and, beside it, its rules, and opens it";
        let why_not = "Complete the items first, and say where the dataset is to be written";
        button
            .on_hover_text(hint)
            .on_disabled_hover_text(why_not)
            .asks(AssemblingCommand::MakeDataset(path.into()), commands);
    });
}

/// Shows name and band of the dataset.
fn dataset_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let rules = assembly.assembly().rules();
    ui.label(palette.small("dataset"));
    if let Some(name) = entry_ui(ui, "Name of the dataset", &rules.name, "name", 140.0) {
        commands.push(assembly.changed(|rules| name.trim().clone_into(&mut rules.name)));
    }
    ui.label(palette.small("band [rad/s]"));
    let name = "Lower end of the dataset's band";
    if let Some(low) =
        number_entry_ui(ui, name, &number(rules.band.0), "rad/s", 50.0, commands).flatten()
    {
        commands.push(assembly.changed(|rules| rules.band.0 = low));
    }
    let name = "Upper end of the dataset's band";
    if let Some(high) =
        number_entry_ui(ui, name, &number(rules.band.1), "rad/s", 50.0, commands).flatten()
    {
        commands.push(assembly.changed(|rules| rules.band.1 = high));
    }
}

/// A text field of a channel rule: label for accessible names, hint, width, current text.
type ChannelField = (&'static str, &'static str, f32, fn(&ChannelRule) -> String);
/// Applies typed text: the rules, the channel's side and index, the text.
type TypedField = fn(&mut Rules, (ChannelSide, usize), String);

const SIDES: [(&str, ChannelSide); 2] = [
    ("input", ChannelSide::Input),
    ("output", ChannelSide::Output),
];
const FIELDS: [(ChannelField, TypedField); 3] = [
    (
        ("Name", "name", 90.0, |channel| channel.name.clone()),
        |rules, (side, index), text| rules.rename(side, index, text),
    ),
    (
        ("Unit", "?", 80.0, |channel| channel.unit.clone()),
        |rules, (side, index), text| rules.channels_mut(side)[index].unit = text,
    ),
    (
        ("Unit in files", "as files say", 110.0, |channel| {
            channel.unit_in_files.clone().unwrap_or_default()
        }),
        |rules, (side, index), text| {
            rules.channels_mut(side)[index].unit_in_files =
                Some(text).filter(|text| !text.is_empty());
        },
    ),
];

/// Shows names and units of every channel, and conversions that units alone do not determine.
fn channels_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut rules = assembly.assembly().rules().clone();
    Grid::new("channels of the dataset")
        .num_columns(4)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            for heading in ["channel", "unit", "where files do not say", ""] {
                ui.label(palette.small(heading));
            }
            ui.end_row();
            for (word, side) in SIDES {
                for (index, channel) in rules.channels_mut(side).iter().enumerate() {
                    for ((what, hint, width, shown), typed) in FIELDS {
                        let name = format!("{what} of {word} {}", index + 1);
                        if let Some(text) = entry_ui(ui, &name, &shown(channel), hint, width) {
                            let text = text.trim().to_owned();
                            commands
                                .push(assembly.changed(|rules| typed(rules, (side, index), text)));
                        }
                    }
                    let name = format!("Remove {word} {}", channel.name);
                    if named(ui.small_button("×"), Role::Button, &name)
                        .on_hover_text(&name)
                        .clicked()
                    {
                        commands.push(
                            assembly.changed(|rules| drop(rules.channels_mut(side).remove(index))),
                        );
                    }
                    ui.end_row();
                }
            }
        });
    ui.horizontal(|ui| {
        for (word, side) in SIDES {
            let name = format!("{word} {}", rules.channels_mut(side).len() + 1);
            let add =
                assembly.changed(|rules| rules.channels_mut(side).push(ChannelRule::named(name)));
            button_ui(
                ui,
                Button::new(format!("Add {word}")).small(),
                "",
                add,
                commands,
            );
        }
    });
    signs_ui(ui, assembly, palette, commands);
    declarations_ui(ui, assembly, palette, commands);
    conversions_ui(ui, assembly, palette, commands);
}

/// Shows the signs declared for a role or for all files; those of a single model are shown with the
/// model.
fn signs_ui(ui: &mut Ui, assembly: &AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
    type Place = fn(&mut Rules) -> &mut Signs;
    let places: [(&str, Place); 3] = [
        ("Signs in all files", |rules| &mut rules.signs),
        ("Signs of physics models", |rules| {
            rules.role_signs.entry("physics".to_owned()).or_default()
        }),
        ("Signs of identified models", |rules| {
            rules.role_signs.entry("identified".to_owned()).or_default()
        }),
    ];
    let mut rules = assembly.assembly().rules().clone();
    Grid::new("signs of channels")
        .num_columns(2)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            for (name, place) in places {
                ui.label(palette.small(name.to_lowercase()));
                if let Some(text) =
                    entry_ui(ui, name, &trim_words(place(&mut rules)), "NZ -1", 160.0)
                {
                    commands.push(match signs_of(&text) {
                        Ok(signs) => assembly.changed(|rules| *place(rules) = signs),
                        Err(why) => Command::Form(FormCommand::Refuse(format!("{name}: {why}"))),
                    });
                }
                ui.end_row();
            }
        });
}

/// Shows the units and factors declared for a role; those of a single model are shown with the
/// model, those of a folder pattern only in the rules file.
fn declarations_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let rules = assembly.assembly().rules();
    Grid::new("units and factors of channels")
        .num_columns(2)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            for (of, models) in [
                (FileScope::Physics, "physics models"),
                (FileScope::Identified, "identified models"),
            ] {
                let declared = rules.declarations.iter().find(|declared| declared.of == of);
                let declared = declared
                    .map(|declared| declared.channels.clone())
                    .unwrap_or_default();
                let name = format!("Units of {models}");
                ui.label(palette.small(name.to_lowercase()));
                if let Some(text) =
                    entry_ui(ui, &name, &unit_words(&declared.units), "LON in", 160.0)
                {
                    commands.push(match units_of(&text) {
                        Ok(units) => assembly.changed(|rules| {
                            let declared = rules.declarations_mut(of.clone());
                            declared
                                .factors
                                .retain(|channel, _| !units.contains_key(channel));
                            declared.units = units;
                        }),
                        Err(why) => Command::Form(FormCommand::Refuse(format!("{name}: {why}"))),
                    });
                }
                ui.end_row();
                let name = format!("Factors of {models}");
                ui.label(palette.small(name.to_lowercase()));
                if let Some(text) =
                    entry_ui(ui, &name, &trim_words(&declared.factors), "LON 8", 160.0)
                {
                    commands.push(match factors_of(&text) {
                        Ok(factors) => assembly.changed(|rules| {
                            let declared = rules.declarations_mut(of.clone());
                            declared
                                .units
                                .retain(|channel, _| !factors.contains_key(channel));
                            declared.factors = factors;
                        }),
                        Err(why) => Command::Form(FormCommand::Refuse(format!("{name}: {why}"))),
                    });
                }
                ui.end_row();
            }
        });
}

/// Shows a factor for each required or declared conversion.
fn conversions_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let rules = assembly.assembly().rules();
    let mut asked: Vec<(String, String, String)> = Vec::new();
    for problem in assembly.assembly().problems() {
        if let ProblemKind::Conversion { channel, from, to } = &problem.kind {
            let conversion = (channel.clone(), from.clone(), to.clone());
            if !asked.contains(&conversion) {
                asked.push(conversion);
            }
        }
    }
    let said = rules
        .units
        .iter()
        .map(|unit| (unit.channel.clone(), unit.from.clone(), String::new()));
    for (channel, from, to) in said.chain(asked) {
        let is_it = |unit: &UnitRule| unit.channel == channel && unit.from == from;
        let known = rules
            .units
            .iter()
            .find(|unit| is_it(unit))
            .map_or(String::new(), |unit| number(unit.factor));
        ui.horizontal(|ui| {
            ui.label(
                RichText::new(format!("{channel}: 1 {from} ="))
                    .size(SMALL_SIZE)
                    .color(palette.text),
            );
            let name = format!("Factor of {channel} from {from}");
            if let Some(factor) = number_entry_ui(ui, &name, &known, "factor", 60.0, commands) {
                commands.push(assembly.changed(|rules| {
                    rules.units.retain(|unit| !is_it(unit));
                    let channel = channel.clone();
                    let from = from.clone();
                    rules.units.extend(factor.map(|factor| UnitRule {
                        channel,
                        from,
                        factor,
                    }));
                }));
            }
            ui.label(palette.small(to.as_str()));
        });
    }
}
