//! Middle of the window: the view bar, the front view, perhaps a second view beside it, and the
//! dock below.

use egui::{Stroke, Ui};

use super::dock::dock_ui;
use super::view_bar::view_bar_ui;
use super::view_frame::view_frame_ui;
use crate::gui::commands::command::Command;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Draws everything between the side panels.
pub fn centre_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    view_bar_ui(ui, state, palette, commands);
    if let Some(dock) = state.display.layout.arrangement.dock() {
        dock_ui(ui, state, dock, palette, commands);
    }
    let view = state.display.layout.arrangement.view();
    let beside = state.display.layout.arrangement.beside();
    let area = ui.available_rect_before_wrap();
    let Some(beside) = beside else {
        return view_frame_ui(ui, area, state, view, palette, commands);
    };
    let middle = area.center().x;
    view_frame_ui(ui, area.with_max_x(middle), state, view, palette, commands);
    ui.painter()
        .vline(middle, area.y_range(), Stroke::new(1.0, palette.line));
    view_frame_ui(
        ui,
        area.with_min_x(middle),
        state,
        beside,
        palette,
        commands,
    );
}
