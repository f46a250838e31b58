//! Settings that change a result: a control for each row of the settings table.

use egui::{Grid, Role, Ui, pos2};

use gdcm_study::decisions::setting;
use gdcm_study::decisions::setting::SETTINGS;
use gdcm_study::decisions::setting_row::{Place, Setting};

use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::window_state::State;
use crate::gui::views::setting_controls::SettingControls;
use crate::gui::widgets::controls::{Asks, chevron, named_switch, painted_text, row_ui};
use crate::gui::widgets::focus::{Region, region_ui};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};

/// Draws every setting that is not part of a view: first the frequently changed settings, then the
/// others, folded.
pub fn settings_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = 4.0;
    region_ui(ui, Region::Settings, |ui| {
        let is_first = |line: &Vec<&'static Setting>| {
            let place = line[0].control.place;
            matches!(place, Place::Slider | Place::Top) || *line[0] == setting::BAND
        };
        let (mut first, advanced): (Vec<_>, Vec<_>) =
            lines_of(state).into_iter().partition(is_first);
        first.sort_by_key(|line| line[0].control.place != Place::Slider);
        for line in first {
            match line[0].control.place {
                Place::Slider => SettingControls {
                    ui,
                    state,
                    palette,
                    commands,
                }
                .slider_ui(line[0]),
                _ => drop(ui.horizontal_wrapped(|ui| {
                    let mut panel = SettingControls {
                        ui,
                        state,
                        palette,
                        commands,
                    };
                    panel.caption_ui(line[0]);
                    panel.controls_ui(&line);
                })),
            }
        }
        ui.add_space(8.0);
        advanced_head_ui(ui, state.display.layout.advanced_open, palette, commands);
        if !state.display.layout.advanced_open {
            return;
        }
        Grid::new("settings")
            .num_columns(2)
            .spacing([8.0, 5.0])
            .show(ui, |ui| {
                for line in advanced {
                    SettingControls {
                        ui,
                        state,
                        palette,
                        commands,
                    }
                    .caption_ui(line[0]);
                    ui.horizontal(|ui| {
                        SettingControls {
                            ui,
                            state,
                            palette,
                            commands,
                        }
                        .controls_ui(&line)
                    });
                    ui.end_row();
                    SettingControls {
                        ui,
                        state,
                        palette,
                        commands,
                    }
                    .note_ui(line[0]);
                }
            });
    });
}

/// Draws the line that folds and unfolds the rarely changed settings.
fn advanced_head_ui(ui: &mut Ui, is_open: bool, palette: &Palette, commands: &mut Vec<Command>) {
    let (row, response) = row_ui(ui, palette, false, false, "Advanced settings");
    chevron(ui, pos2(row.left() + 6.0, row.center().y), is_open, palette);
    painted_text(ui, row, 16.0, "Advanced", medium(BODY_SIZE), palette.text);
    named_switch(response, Role::Button, is_open, "Advanced settings")
        .asks(LayoutCommand::ShowAdvanced(!is_open), commands);
}

/// Returns the effective settings, line by line.
fn lines_of(state: &State) -> Vec<Vec<&'static Setting>> {
    let mut lines: Vec<Vec<&'static Setting>> = Vec::new();
    for setting in SETTINGS
        .iter()
        .filter(|setting| (setting.control.applies)(&state.study))
    {
        match (setting.control.place, lines.last_mut()) {
            (Place::Elsewhere, _) => {}
            (Place::Beside, Some(line)) => line.push(setting),
            _ => lines.push(vec![setting]),
        }
    }
    lines
}
