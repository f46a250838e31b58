//! Bar above the views: groups at the left, the front group's views beside them, tools at the
//! right.

use egui::containers::menu::MenuButton;
use egui::{Button, Rect, RichText, Role, Sense, Stroke, StrokeKind, Ui, pos2, vec2};

use super::view_frame::PADDING;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::view::{View, ViewGroup};
use crate::gui::state::window_state::State;
use crate::gui::views::figure_button::figure_button_ui;
use crate::gui::widgets::controls::{Asks, button_ui, entries_ui, hint_above, named, named_switch};
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium};
use crate::gui::widgets::panel_layout::in_line_ui;

/// Draws the groups at the left, the views in the front group beside them, and the tools at the
/// right.
pub(super) fn view_bar_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let bar = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), BAR_HEIGHT));
    ui.allocate_rect(bar, Sense::hover());
    ui.painter().rect_filled(bar, 0.0, palette.panel);
    ui.painter()
        .hline(bar.x_range(), bar.bottom(), Stroke::new(1.0, palette.line));
    let inner = bar.shrink2(vec2(f32::from(PADDING), 0.0));
    let left = in_line_ui(ui, inner, false, |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        groups_ui(ui, state, palette, commands);
        ui.add_space(12.0);
        tabs_ui(ui, state, bar, palette, commands);
    });
    in_line_ui(
        ui,
        inner.with_min_x(left.response.rect.right() + 8.0),
        true,
        |ui| {
            figure_button_ui(ui, state.display.layout.arrangement.view(), commands);
            let hint = "Bring all curves into view (F, or double click)";
            button_ui(
                ui,
                Button::new("Fit").frame(false),
                hint,
                DisplayCommand::FitPlots,
                commands,
            );
            beside_ui(ui, state, palette, commands);
        },
    );
}

/// View bar height \[pt\].
const BAR_HEIGHT: f32 = 40.0;

/// Draws the view groups as a row of joined buttons.
fn groups_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let font = medium(BODY_SIZE);
    let widths = ViewGroup::ALL.map(|group| text_width(ui, group.name(), font.clone()) + 24.0);
    let (area, _) =
        ui.allocate_exact_size(vec2(widths.iter().sum::<f32>() + 4.0, 30.0), Sense::hover());
    ui.painter().rect(
        area,
        6.0,
        palette.background,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
    let mut left = area.left() + 2.0;
    for (group, width) in ViewGroup::ALL.into_iter().zip(widths) {
        let place = Rect::from_min_size(pos2(left, area.top() + 2.0), vec2(width, 26.0));
        left = place.right();
        let is_front = state.display.layout.arrangement.group() == group;
        let response = ui.interact(
            place,
            ui.scope_id().with(("group", group.name())),
            Sense::click(),
        );
        if is_front || response.hovered() {
            ui.painter().rect_filled(place, 5.0, palette.raised);
        }
        let color = if is_front {
            palette.text
        } else {
            palette.dim_text
        };
        ui.painter().text(
            place.center(),
            egui::Align2::CENTER_CENTER,
            group.name(),
            font.clone(),
            color,
        );
        let response = named_switch(
            response,
            Role::Button,
            is_front,
            format!("Views: {}", group.name()),
        );
        let names: Vec<&str> = group.views().map(View::name).collect();
        hint_above(response, &names.join(", ")).asks(LayoutCommand::ShowGroup(group), commands);
    }
}

/// Draws the front group's views side by side, or as a menu if they do not fit.
fn tabs_ui(ui: &mut Ui, state: &State, bar: Rect, palette: &Palette, commands: &mut Vec<Command>) {
    /// Width reserved for the other controls in the bar \[pt\].
    const TOOLS: f32 = 130.0;
    let arrangement = &state.display.layout.arrangement;
    let room = bar.right() - ui.cursor().left() - TOOLS;
    let width: f32 = arrangement
        .group()
        .views()
        .map(|view| text_width(ui, view.name(), medium(BODY_SIZE)) + 16.0)
        .sum();
    if width <= room {
        for view in arrangement.group().views() {
            tab_ui(ui, bar, view, arrangement.view() == view, palette, commands);
        }
        return;
    }
    let front = arrangement.view();
    let text = RichText::new(format!("{} ▾", front.name())).font(medium(BODY_SIZE));
    let (button, _) = MenuButton::from_button(Button::new(text).frame(false)).ui(ui, |ui| {
        let views = arrangement.group().views();
        entries_ui(
            ui,
            views.map(|view| (view.name(), Command::Layout(LayoutCommand::ShowView(view)))),
            commands,
        );
    });
    named_switch(button, Role::Tab, true, front.name()).on_hover_text("Views in this group");
}

/// Draws a view's name, underlined in the accent colour if it is in front.
fn tab_ui(
    ui: &mut Ui,
    bar: Rect,
    view: View,
    is_front: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let font = if is_front { medium(BODY_SIZE) } else { body() };
    let color = if is_front {
        palette.text
    } else {
        palette.dim_text
    };
    let galley = ui.fonts_mut(|fonts| fonts.layout_no_wrap(view.name().to_owned(), font, color));
    let (place, response) =
        ui.allocate_exact_size(vec2(galley.size().x + 14.0, BAR_HEIGHT), Sense::click());
    ui.painter()
        .galley(place.center() - 0.5 * galley.size(), galley, color);
    if is_front || response.hovered() {
        let line = Rect::from_x_y_ranges(
            place.shrink2(vec2(4.0, 0.0)).x_range(),
            bar.bottom() - 2.0..=bar.bottom(),
        );
        let line_color = if is_front {
            palette.accent
        } else {
            palette.line
        };
        ui.painter().rect_filled(line, 1.0, line_color);
    }
    let response = named_switch(response, Role::Tab, is_front, view.name());
    hint_above(response, view.facts().purpose).asks(LayoutCommand::ShowView(view), commands);
}

/// Draws the button whose menu shows a second view beside the view in front, or hides it.
fn beside_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let arrangement = &state.display.layout.arrangement;
    // The spaces make room for the symbol, which is painted over the button.
    let (button, _) = MenuButton::from_button(Button::new("     ").frame(false)).ui(ui, |ui| {
        let others = View::ALL
            .into_iter()
            .filter(|view| *view != arrangement.view() && !view.is_dock_page())
            .map(|view| {
                (
                    format!("Show {} beside", view.name()),
                    Command::Layout(LayoutCommand::ShowBeside(Some(view))),
                )
            });
        entries_ui(ui, others, commands);
        if arrangement.beside().is_some() {
            ui.separator();
            let alone = Command::Layout(LayoutCommand::ShowBeside(None));
            entries_ui(ui, [("Show one view only", alone)], commands);
        }
    });
    let symbol = Rect::from_center_size(button.rect.center(), vec2(14.0, 12.0));
    let color = if arrangement.beside().is_some() {
        palette.accent
    } else {
        palette.dim_text
    };
    ui.painter()
        .rect_stroke(symbol, 2.0, Stroke::new(1.3, color), StrokeKind::Inside);
    ui.painter()
        .vline(symbol.center().x, symbol.y_range(), Stroke::new(1.3, color));
    named(button, Role::Button, "Show another view beside")
        .on_hover_text("Shows a second view next to this view");
}
