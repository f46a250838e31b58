//! Dock below the views: a further view, which can be folded to its head.

use egui::{Align, Button, Frame, Layout, Margin, Panel, RichText, Role, Sense, Ui, vec2};

use super::view_frame::{PADDING, clipped_ui, title_ui, tools_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::view_content;
use crate::gui::widgets::controls::{Asks, named_switch};
use crate::gui::widgets::painted_text::chevron;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};
use crate::gui::widgets::panel_layout::{in_line_ui, restore_panel_size};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Draws the view in the dock, which is folded to its bar in a low window.
pub(super) fn dock_ui(
    ui: &mut Ui,
    state: &mut State,
    view: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let window = ui.ctx().content_rect().height();
    let is_open = state
        .display
        .layout
        .arrangement
        .is_dock_open(window >= LEAST_WITH_DOCK);
    let dock = Dock { view, is_open };
    let frame = Frame::new().fill(palette.background);
    restore_panel_size(ui, "dock");
    let panel = Panel::bottom(if is_open { "dock" } else { "folded dock" }).frame(frame);
    let panel = if is_open {
        panel
            .resizable(true)
            .default_size((DOCK_PART * window).round())
            .size_range(140.0..=0.6 * window)
    } else {
        panel.exact_size(FOLDED)
    };
    panel.show(ui, |ui| {
        let area = ui.available_rect_before_wrap();
        let padding = Margin {
            left: PADDING,
            right: PADDING,
            top: 0,
            bottom: 2,
        };
        clipped_ui(ui, "dock content", area, padding, |ui| {
            dock_head_ui(ui, state, dock, palette, commands);
            if is_open {
                let draw = view_content(view).draw;
                region_ui(ui, Region::Dock, |ui| draw(ui, state, palette, commands));
            }
        });
    });
}

/// Folded dock height \[pt\].
const FOLDED: f32 = 34.0;
/// Minimum window height at which the dock is unfolded by default \[pt\].
const LEAST_WITH_DOCK: f32 = 680.0;
/// Height of the dock, as a share of the window's height.
const DOCK_PART: f32 = 0.252;

/// View in the dock, and whether the dock is unfolded.
#[derive(Clone, Copy)]
struct Dock {
    view: View,
    is_open: bool,
}

/// Draws the dock's head: an arrow that folds it, the views it can show, and the tools.
fn dock_head_ui(
    ui: &mut Ui,
    state: &State,
    dock: Dock,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let width = ui.available_width();
    ui.allocate_ui_with_layout(
        vec2(width, FOLDED),
        Layout::right_to_left(Align::Center),
        |ui| {
            ui.set_min_size(vec2(width, FOLDED));
            if dock.is_open {
                tools_ui(ui, state, dock.view, palette, commands);
            }
            let rest = ui.available_rect_before_wrap();
            in_line_ui(ui, rest, false, |ui| {
                fold_ui(ui, dock.is_open, palette, commands);
                dock_tabs_ui(ui, state, dock.view, commands);
                ui.add_space(4.0);
                title_ui(ui, state, view_content(dock.view).title, palette);
            });
        },
    );
}

fn fold_ui(ui: &mut Ui, is_open: bool, palette: &Palette, commands: &mut Vec<Command>) {
    let (place, response) = ui.allocate_exact_size(vec2(16.0, FOLDED), Sense::click());
    chevron(ui, place.center(), is_open, palette);
    let hint = if is_open {
        "Fold the plots below"
    } else {
        "Unfold the plots below"
    };
    named_switch(response, Role::Button, is_open, "Dock")
        .on_hover_text(hint)
        .asks(LayoutCommand::OpenDock(!is_open), commands);
}

/// Draws a tab for each view that the dock can show, or a plain name if it can show only one.
fn dock_tabs_ui(ui: &mut Ui, state: &State, front: View, commands: &mut Vec<Command>) {
    let views: Vec<View> = View::docked(state.study.settings.phase).collect();
    for view in &views {
        let name = view.facts().long_name.unwrap_or(view.name());
        let text = RichText::new(name).font(medium(BODY_SIZE));
        if views.len() == 1 {
            ui.label(text);
            continue;
        }
        let is_front = *view == front;
        let button = ui.add(Button::selectable(is_front, text));
        let name = format!("{} in the dock", view.name());
        named_switch(button, Role::Tab, is_front, name)
            .asks(LayoutCommand::ShowInDock(*view), commands);
    }
}
