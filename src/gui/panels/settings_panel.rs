//! Settings beside live results: a control for each row in the settings table. The panel replaces
//! the model list, so that verdict, result, matrix and plots keep their places.
//!
//! A setting's control says where it is drawn ([`Place`]) and whether it has an effect in the
//! study. α is the weight of the output gains' deviation from 1 in the objective (M8:
//! docs/method.md).

use egui::{Button, Grid, Label, Rect, Role, ScrollArea, Sense, Ui, UiBuilder, pos2, vec2};

use gdcm_model::number_format::counted;
use gdcm_study::decisions::setting::{Kind, Place, Setting};
use gdcm_study::decisions::setting_table;
use gdcm_study::decisions::setting_table::SETTINGS;
use gdcm_study::decisions::settings::Settings;

use super::trade_off_plot::{TRADE_OFF_HEIGHT, trade_off_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::window_state::State;
use crate::gui::views::setting_controls::SettingControls;
use crate::gui::widgets::controls::{Asks, named, named_switch};
use crate::gui::widgets::list_row::row_ui;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, chevron, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium, small};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Heading height \[pt\].
const HEAD: f32 = 30.0;
/// Foot height \[pt\]. The foot shows either *Revert* or the explanation for the control under the
/// pointer.
const FOOT: f32 = 60.0;
/// Distance between two settings \[pt\].
const GAP: f32 = 7.0;
/// Width at the right for the scroll bar \[pt\].
const SCROLL_BAR: f32 = 6.0;

/// Draws every setting that does not belong to a view: first the frequently changed settings, then
/// the others in a foldable part.
pub fn settings_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = 0.0;
    region_ui(ui, Region::Settings, |ui| {
        let area = ui.available_rect_before_wrap();
        let (head, rest) = area.split_top_bottom_at_y(area.top() + HEAD);
        let (body, foot) = rest.split_top_bottom_at_y(rest.bottom() - FOOT);
        ui.scope_builder(
            UiBuilder::new().id_salt("settings head").max_rect(head),
            |ui| {
                head_ui(ui, state, palette, commands);
            },
        );
        let mut help = None;
        ui.scope_builder(UiBuilder::new().id_salt("settings").max_rect(body), |ui| {
            ScrollArea::vertical()
                .id_salt("settings")
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    ui.set_max_width(ui.available_width() - SCROLL_BAR);
                    body_ui(ui, state, palette, commands, &mut help);
                });
        });
        ui.scope_builder(
            UiBuilder::new().id_salt("settings foot").max_rect(foot),
            |ui| {
                foot_ui(ui, state, help, palette, commands);
            },
        );
        ui.advance_cursor_after_rect(area);
    });
}

/// Draws the heading with the count of changed settings, and the button that closes the panel.
fn head_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let row = ui.max_rect();
    painted_text(ui, row, 0.0, "Settings", medium(BODY_SIZE), palette.text);
    let close = Rect::from_min_size(
        pos2(row.right() - 18.0, row.center().y - 9.0),
        vec2(18.0, 18.0),
    );
    let button = ui.put(close, Button::new("×").frame(false));
    named(button, Role::Button, "Close the settings")
        .asks(LayoutCommand::ShowSettings(false), commands);
    let changed = state.changed_settings().len();
    if changed > 0 {
        let room = row.with_max_x(close.left() - 6.0);
        let words = format!("{changed} changed");
        painted_text(ui, room, AT_RIGHT_END, &words, small(), palette.dim_text);
    }
}

/// Settings drawn on the same line.
type Line = Vec<&'static Setting>;

/// Returns whether a line belongs to the frequently changed settings.
fn is_frequent(line: &Line) -> bool {
    let place = line[0].control.place;
    matches!(place, Place::Slider | Place::Top) || *line[0] == setting_table::BAND
}

/// Returns a line's rank among the frequent settings: sliders, segmented controls, the band,
/// others.
fn rank(line: &Line) -> usize {
    match line[0].control.place {
        Place::Slider => 0,
        Place::Top if is_segmented(line) => 1,
        Place::Top => 3,
        _ => 2,
    }
}

/// Returns whether the line has a single setting, a choice among at most four entries.
fn is_segmented(line: &Line) -> bool {
    line.len() == 1 && matches!(line[0].kind, Kind::Choice { words, .. } if words.len() <= 4)
}

/// Draws the frequently changed settings by rank, the trade-off below the slider for α, and the
/// advanced settings if they are unfolded.
fn body_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
    help: &mut Option<&'static str>,
) {
    let (mut first, advanced): (Vec<_>, Vec<_>) =
        lines_of(state).into_iter().partition(is_frequent);
    first.sort_by_key(rank);
    for line in first {
        if line[0].control.place == Place::Slider {
            let rail = controls(ui, state, palette, commands, help).slider_ui(line[0]);
            if *line[0] == setting_table::ALPHA_GAIN
                && let Some(rail) = rail
            {
                let size = vec2(ui.available_width(), TRADE_OFF_HEIGHT);
                let (place, _) = ui.allocate_exact_size(size, Sense::hover());
                trade_off_ui(ui, place, rail, state, palette, help);
            }
        } else if is_segmented(&line) {
            controls(ui, state, palette, commands, help).segments_ui(line[0]);
        } else {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 6.0;
                let mut line_controls = controls(ui, state, palette, commands, help);
                line_controls.caption_ui(line[0]);
                line_controls.controls_ui(&line);
            });
        }
        ui.add_space(GAP);
    }
    let is_open = state.display.layout.advanced_open;
    advanced_head_ui(ui, state, &advanced, is_open, palette, commands);
    if is_open {
        ui.add_space(4.0);
        advanced_ui(ui, state, &advanced, palette, commands, help);
    }
}

fn advanced_ui(
    ui: &mut Ui,
    state: &State,
    lines: &[Line],
    palette: &Palette,
    commands: &mut Vec<Command>,
    help: &mut Option<&'static str>,
) {
    Grid::new("settings")
        .num_columns(2)
        .spacing([8.0, 5.0])
        .show(ui, |ui| {
            for line in lines {
                controls(ui, state, palette, commands, help).caption_ui(line[0]);
                ui.horizontal_wrapped(|ui| {
                    ui.spacing_mut().item_spacing = vec2(4.0, 2.0);
                    controls(ui, state, palette, commands, help).controls_ui(line);
                });
                ui.end_row();
                controls(ui, state, palette, commands, help).note_ui(line[0]);
            }
        });
}

fn controls<'a, 'c>(
    ui: &'a mut Ui,
    state: &'a State,
    palette: &'a Palette,
    commands: &'c mut Vec<Command>,
    help: &'c mut Option<&'static str>,
) -> SettingControls<'a, 'c> {
    SettingControls {
        ui,
        state,
        palette,
        commands,
        help,
    }
}

/// Draws the line that folds and unfolds the rarely changed settings, and counts those that differ
/// from a new study's settings.
fn advanced_head_ui(
    ui: &mut Ui,
    state: &State,
    lines: &[Line],
    is_open: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (row, response) = row_ui(ui, palette, false, false, "Advanced settings");
    chevron(ui, pos2(row.left() + 6.0, row.center().y), is_open, palette);
    painted_text(ui, row, 16.0, "Advanced", medium(BODY_SIZE), palette.text);
    let defaults = Settings::for_dataset(state.dataset());
    let settings: Vec<&Setting> = lines.iter().flatten().copied().collect();
    let changed = settings
        .iter()
        .filter(|setting| setting.value(&defaults) != setting.value(&state.study.settings))
        .count();
    let count = settings.len();
    let (words, color) = match changed {
        0 => (format!("{count}, all default"), palette.dim_text),
        changed => (format!("{changed} of {count} changed"), palette.text),
    };
    painted_text(ui, row, AT_RIGHT_END, &words, small(), color);
    named_switch(response, Role::Button, is_open, "Advanced settings")
        .asks(LayoutCommand::ShowAdvanced(!is_open), commands);
}

/// Draws the explanation for the control under the pointer; without one, the button that restores
/// the settings from when the panel was opened.
fn foot_ui(
    ui: &mut Ui,
    state: &State,
    help: Option<&'static str>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let area = ui.max_rect();
    ui.painter().hline(
        area.expand2(vec2(12.0, 0.0)).x_range(),
        area.top(),
        ui.visuals().widgets.noninteractive.bg_stroke,
    );
    if let Some(help) = help {
        let inner = area.with_min_y(area.top() + 4.0);
        ui.scope_builder(UiBuilder::new().max_rect(inner), |ui| {
            ui.add(Label::new(palette.small(help)).wrap());
        });
        return;
    }
    let edits = state.reverting_edits();
    let place = Rect::from_min_size(pos2(area.left(), area.center().y - 12.0), vec2(64.0, 24.0));
    let is_changed = !edits.is_empty();
    let button = ui
        .scope_builder(UiBuilder::new().max_rect(place), |ui| {
            ui.add_enabled(is_changed, Button::new("Revert").min_size(place.size()))
        })
        .inner;
    if named(button, Role::Button, "Revert the settings").clicked() {
        commands.extend(edits.into_iter().map(Command::from));
        commands.push(StudyCommand::EndEdit.into());
    }
    let words = match state.changed_settings().len() {
        0 => "nothing changed".to_owned(),
        1 => "1 change".to_owned(),
        count => format!("{}, in one undo step", counted(count, "change")),
    };
    painted_text(ui, area, AT_RIGHT_END, &words, small(), palette.dim_text);
}

/// Returns the settings that currently have an effect, line by line; a setting with the place
/// `Beside` joins the line before it, and settings with the place `Elsewhere`, which a view shows,
/// are omitted.
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
