//! Settings that change a result: a control for each row of the settings table.

use egui::{Grid, Role, Ui, pos2};

use gdcm_study::decisions::setting;
use gdcm_study::decisions::setting::SETTINGS;
use gdcm_study::decisions::setting_row::{Place, Setting};

use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::window_state::State;
use crate::gui::views::setting_controls::SettingControls;
use crate::gui::widgets::controls::{Asks, named_switch};
use crate::gui::widgets::list_row::row_ui;
use crate::gui::widgets::painted_text::{chevron, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Draws every setting that is not part of a view: first the frequently changed settings, then the
/// others in a foldable part.
pub fn settings_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = 4.0;
    region_ui(ui, Region::Settings, |ui| {
        let (mut first, advanced): (Vec<_>, Vec<_>) =
            lines_of(state).into_iter().partition(is_frequent);
        first.sort_by_key(|line| line[0].control.place != Place::Slider);
        for line in first {
            if line[0].control.place == Place::Slider {
                controls(ui, state, palette, commands).slider_ui(line[0]);
            } else {
                ui.horizontal_wrapped(|ui| {
                    let mut line_controls = controls(ui, state, palette, commands);
                    line_controls.caption_ui(line[0]);
                    line_controls.controls_ui(&line);
                });
            }
        }
        ui.add_space(8.0);
        let is_open = state.display.layout.advanced_open;
        advanced_head_ui(ui, is_open, palette, commands);
        if is_open {
            advanced_ui(ui, state, &advanced, palette, commands);
        }
    });
}

/// Settings drawn on the same line.
type Line = Vec<&'static Setting>;

fn is_frequent(line: &Line) -> bool {
    let place = line[0].control.place;
    matches!(place, Place::Slider | Place::Top) || *line[0] == setting::BAND
}

fn advanced_ui(
    ui: &mut Ui,
    state: &State,
    lines: &[Line],
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    Grid::new("settings")
        .num_columns(2)
        .spacing([8.0, 5.0])
        .show(ui, |ui| {
            for line in lines {
                controls(ui, state, palette, commands).caption_ui(line[0]);
                ui.horizontal(|ui| controls(ui, state, palette, commands).controls_ui(line));
                ui.end_row();
                controls(ui, state, palette, commands).note_ui(line[0]);
            }
        });
}

fn controls<'a, 'c>(
    ui: &'a mut Ui,
    state: &'a State,
    palette: &'a Palette,
    commands: &'c mut Vec<Command>,
) -> SettingControls<'a, 'c> {
    SettingControls {
        ui,
        state,
        palette,
        commands,
    }
}

/// Draws the line that folds and unfolds the rarely changed settings.
fn advanced_head_ui(ui: &mut Ui, is_open: bool, palette: &Palette, commands: &mut Vec<Command>) {
    let (row, response) = row_ui(ui, palette, false, false, "Advanced settings");
    chevron(ui, pos2(row.left() + 6.0, row.center().y), is_open, palette);
    painted_text(ui, row, 16.0, "Advanced", medium(BODY_SIZE), palette.text);
    named_switch(response, Role::Button, is_open, "Advanced settings")
        .asks(LayoutCommand::ShowAdvanced(!is_open), commands);
}

/// Returns the settings that currently have an effect, line by line.
fn lines_of(state: &State) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for setting in SETTINGS {
        if !(setting.control.applies)(&state.study) {
            continue;
        }
        match (setting.control.place, lines.last_mut()) {
            (Place::Elsewhere, _) => {}
            (Place::Beside, Some(line)) => line.push(setting),
            _ => lines.push(vec![setting]),
        }
    }
    lines
}
