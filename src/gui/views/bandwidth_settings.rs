//! Settings for the bandwidth requirements: attitude commands and level boundaries.
//!
//! Level boundaries divide the plane of bandwidth and phase delay into the levels of handling
//! qualities (M17: docs/requirements.md).

use std::collections::BTreeSet;

use egui::{Button, Ui};

use gdcm_io::files::standard_levels::STANDARD_LEVELS;
use gdcm_method::requirements::{AttitudeOutput, LevelBoundaries};
use gdcm_study::decisions::requirement_settings::RequirementPart;

use super::requirement_edits::requirement_edit;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::state::forms::RequirementTable;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::check_ui;
use crate::gui::widgets::controls::button_ui;
use crate::gui::widgets::palette::Palette;

/// Draws the settings: which attitudes a stick commands, and the engineer's level boundaries.
pub(super) fn bandwidth_inputs_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_wrapped(|ui| {
        ui.label(palette.small("attitude command:"));
        attitude_commands_ui(ui, state, commands);
        ui.separator();
        levels_ui(ui, state, palette, commands);
    });
}

/// Draws a check box for each attitude that a stick may command.
fn attitude_commands_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut outputs = BTreeSet::new();
    for pair in state.dataset().measuring_pairs().marked() {
        outputs.insert(pair.output);
    }
    for output in outputs {
        let channel = &state.dataset().outputs()[output];
        if AttitudeOutput::classify(channel).is_err() {
            continue;
        }
        let name = &channel.name;
        let is_on = state.study.requirements.attitude_command.contains(name);
        let hint = "The stick commands the attitude instead of its rate; the phase margin alone \
            then determines the bandwidth";
        if let Some(is_on) = check_ui(ui, is_on, format!("attitude of {name}"), hint) {
            commands.push(requirement_edit(
                state,
                RequirementPart::AttitudeCommand,
                |settings| {
                    if is_on {
                        settings.attitude_command.insert(name.clone());
                    } else {
                        settings.attitude_command.remove(name);
                    }
                },
            ));
        }
    }
}

/// Draws the count of level boundaries, and the buttons that remove them or read them from a file.
fn levels_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let levels = state.study.requirements.levels.as_slice().len();
    let text = if levels == 0 {
        "level boundaries: none".to_owned()
    } else {
        format!("level boundaries: {levels}")
    };
    ui.label(palette.small(text));
    if levels > 0 && ui.small_button("Remove levels").clicked() {
        commands.push(requirement_edit(
            state,
            RequirementPart::Levels,
            |settings| {
                settings.levels = LevelBoundaries::default();
            },
        ));
    }
    let hint =
        "Reads levels from a file; they replace those of the same axis (docs/requirements.md)";
    let ask = FileCommand::AskRequirementTable(RequirementTable::Levels);
    button_ui(ui, Button::new("Levels…").small(), hint, ask, commands);
}

/// Draws a check box for each boundary set from ADS-33E-PRF whose axis the dataset has.
pub(super) fn standard_levels_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let outputs = state.dataset().outputs();
    for standard in &STANDARD_LEVELS {
        if standard.output(outputs).is_none() {
            continue;
        }
        let Ok(boundaries) = standard.boundaries(outputs) else {
            continue;
        };
        let is_on = state.study.requirements.levels.contains(&boundaries);
        let hint = match boundaries.as_slice().first() {
            Some(boundary) => boundary.source.as_str(),
            None => "",
        };
        if let Some(is_on) = check_ui(ui, is_on, standard.title, hint) {
            commands.push(requirement_edit(
                state,
                RequirementPart::Levels,
                |settings| {
                    settings.levels = if is_on {
                        settings.levels.replaced_by(&boundaries)
                    } else {
                        settings.levels.without(&boundaries)
                    };
                },
            ));
        }
    }
}
