//! Dataset channels: names and units.

use egui::{Button, Grid, Role, Ui};

use gdcm_model::assembly::Rules;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::ChannelRule;

use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::controls::{button_ui, named};
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::text_fields::entry_ui;

const SIDES: [ChannelSide; 2] = [ChannelSide::Input, ChannelSide::Output];

#[derive(Clone, Copy)]
enum ChannelField {
    Name,
    Unit,
    /// Unit for files that do not name one.
    UnitInFiles,
}

impl ChannelField {
    const ALL: [Self; 3] = [Self::Name, Self::Unit, Self::UnitInFiles];

    fn name(self) -> &'static str {
        match self {
            Self::Name => "Name",
            Self::Unit => "Unit",
            Self::UnitInFiles => "Unit in files",
        }
    }

    fn hint(self) -> &'static str {
        match self {
            Self::Name => "name",
            Self::Unit => "?",
            Self::UnitInFiles => "as in the files",
        }
    }

    /// Returns the width of the text field \[pt\].
    fn width(self) -> f32 {
        match self {
            Self::Name => 90.0,
            Self::Unit => 80.0,
            Self::UnitInFiles => 110.0,
        }
    }

    fn value(self, channel: &ChannelRule) -> &str {
        match self {
            Self::Name => &channel.name,
            Self::Unit => &channel.unit,
            Self::UnitInFiles => channel.unit_in_files.as_deref().unwrap_or_default(),
        }
    }

    fn set(self, rules: &mut Rules, side: ChannelSide, index: usize, text: String) {
        match self {
            Self::Name => rules.rename(side, index, text),
            Self::Unit => rules.channels_mut(side)[index].unit = text,
            Self::UnitInFiles => {
                let unit = if text.is_empty() { None } else { Some(text) };
                rules.channels_mut(side)[index].unit_in_files = unit;
            }
        }
    }
}

/// Shows a row with names and units for every channel, and buttons that add and remove channels.
pub(super) fn channel_table_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    Grid::new("channels of the dataset")
        .num_columns(4)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            for heading in ["channel", "unit", "unit if a file gives none", ""] {
                ui.label(palette.small(heading));
            }
            ui.end_row();
            for side in SIDES {
                for (index, channel) in channels(assembly, side).iter().enumerate() {
                    channel_fields_ui(ui, assembly, side, index, commands);
                    let name = format!("Remove {side} {}", channel.name);
                    let remove = named(ui.small_button("×"), Role::Button, &name);
                    if remove.on_hover_text(&name).clicked() {
                        commands.push(assembly.rules_change(|rules| {
                            rules.channels_mut(side).remove(index);
                        }));
                    }
                    ui.end_row();
                }
            }
        });
    ui.horizontal(|ui| {
        for side in SIDES {
            let name = format!("{side} {}", channels(assembly, side).len() + 1);
            let add = assembly.rules_change(|rules| {
                rules.channels_mut(side).push(ChannelRule::named(name));
            });
            let button = Button::new(format!("Add {side}")).small();
            button_ui(ui, button, "", add, commands);
        }
    });
}

fn channels(assembly: &AssemblyState, side: ChannelSide) -> &[ChannelRule] {
    let rules = assembly.assembly().rules();
    match side {
        ChannelSide::Input => &rules.inputs,
        ChannelSide::Output => &rules.outputs,
    }
}

fn channel_fields_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    side: ChannelSide,
    index: usize,
    commands: &mut Vec<Command>,
) {
    let channel = &channels(assembly, side)[index];
    for field in ChannelField::ALL {
        let name = format!("{} of {side} {}", field.name(), index + 1);
        let value = field.value(channel);
        if let Some(text) = entry_ui(ui, &name, value, field.hint(), field.width()) {
            let text = text.trim().to_owned();
            commands.push(assembly.rules_change(|rules| field.set(rules, side, index, text)));
        }
    }
}
