//! Menu with everything that determines the limits of the requirements: tolerance tables, axes with
//! attitude command, level boundaries (M17: docs/requirements.md).

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, PopupCloseBehavior, Role, Ui};

use gdcm_method::requirements::{ModeToleranceTable, ToleranceTable};
use gdcm_study::decisions::requirement_settings::OverviewLimits;

use super::bandwidth_settings::{bandwidth_inputs_ui, standard_levels_ui};
use super::requirement_limits::{set_limits, set_mode_tolerances, set_tolerances};
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::state::forms::RequirementTable;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{button_ui, named};
use crate::gui::widgets::palette::Palette;

/// Draws the menu; its button says whether any limit differs from the default.
pub(super) fn limits_menu_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let settings = &state.study.requirements;
    let is_default = settings.tolerances == ToleranceTable::default()
        && settings.mode_tolerances == ModeToleranceTable::default()
        && settings.overview == OverviewLimits::default();
    let text = if is_default {
        "limits: default \u{23f7}"
    } else {
        "limits: edited \u{23f7}"
    };
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) = MenuButton::from_button(Button::new(text))
        .config(config)
        .ui(ui, |ui| {
            ui.set_max_width(420.0);
            menu_content_ui(ui, state, palette, commands);
        });
    named(button, Role::Button, "Limits of the requirements");
}

fn menu_content_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let settings = &state.study.requirements;
    let source = settings.tolerances.source();
    ui.label(palette.small(format!("Tolerances in time: {source}")));
    ui.label(
        palette
            .small("Bandwidth, phase delay and summary: limits of this program, not of a standard"),
    );
    ui.label(palette.small("Double click on a limit of the grid to edit it"));
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        let is_default = settings.tolerances == ToleranceTable::default();
        let button = Button::new("Default tolerances").small();
        if ui.add_enabled(!is_default, button).clicked() {
            commands.push(set_tolerances(state, ToleranceTable::default()));
        }
        let is_default = settings.mode_tolerances == ModeToleranceTable::default();
        let button = Button::new("Default tolerances of modes").small();
        if ui.add_enabled(!is_default, button).clicked() {
            commands.push(set_mode_tolerances(state, ModeToleranceTable::default()));
        }
        let is_default = settings.overview == OverviewLimits::default();
        let button = Button::new("Default limits").small();
        if ui.add_enabled(!is_default, button).clicked() {
            commands.push(set_limits(state, OverviewLimits::default()));
        }
    });
    ui.horizontal_wrapped(|ui| {
        button_ui(
            ui,
            Button::new("Open tolerances…").small(),
            "Reads the tolerances in time from a file into the study",
            FileCommand::AskRequirementTable(RequirementTable::Tolerances),
            commands,
        );
        button_ui(
            ui,
            Button::new("Save tolerances…").small(),
            "Writes the tolerances in time to a file for other studies",
            FileCommand::AskWriteTolerances,
            commands,
        );
    });
    ui.separator();
    bandwidth_inputs_ui(ui, state, palette, commands);
    standard_levels_ui(ui, state, commands);
}
