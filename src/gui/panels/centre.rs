//! Middle of the window: view groups, the front view with its title, and the dock below.

use egui::containers::menu::MenuButton;
use egui::{
    Align, AsIdSalt, Button, Frame, Label, Layout, Margin, Panel, Rect, RichText, Role, Sense,
    Stroke, StrokeKind, Ui, UiBuilder, pos2, vec2,
};

use super::start_page::example_line_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::view::{View, ViewGroup};
use crate::gui::state::window_state::State;
use crate::gui::views::figure_button::figure_button_ui;
use crate::gui::views::{ViewTitle, view_content};
use crate::gui::widgets::controls::{
    Asks, button_ui, chevron, entries_ui, in_line_ui, named, named_switch, restore_panel_size,
    text_width,
};
use crate::gui::widgets::focus::{Region, region_ui};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, TITLE_SIZE, body, medium};

/// View bar height \[pt\].
const BAR: f32 = 40.0;
/// Title row height \[pt\].
const TITLE: f32 = 28.0;
/// Folded dock height \[pt\].
const FOLDED: f32 = 34.0;
/// Minimum window height that unfolds the dock \[pt\].
const LEAST_WITH_DOCK: f32 = 680.0;
/// Height of the dock, as a share of the window's height.
const DOCK_PART: f32 = 0.252;
/// Horizontal padding \[pt\].
const PADDING: i8 = 16;

/// Draws everything between the side panels.
pub fn centre_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    view_bar_ui(ui, state, palette, commands);
    if state.is_example {
        let frame = Frame::new().inner_margin(Margin {
            left: PADDING,
            right: PADDING,
            top: 2,
            bottom: 0,
        });
        frame.show(ui, |ui| example_line_ui(ui, palette, commands));
    }
    if let Some(dock) = state.display.layout.arrangement.dock() {
        dock_ui(ui, state, dock, palette, commands);
    }
    let view = state.display.layout.arrangement.view();
    let beside = state.display.layout.arrangement.beside();
    let area = ui.available_rect_before_wrap();
    let Some(beside) = beside else {
        return part_ui(ui, area, state, view, palette, commands);
    };
    let middle = area.center().x;
    part_ui(ui, area.with_max_x(middle), state, view, palette, commands);
    ui.painter()
        .vline(middle, area.y_range(), Stroke::new(1.0, palette.line));
    part_ui(
        ui,
        area.with_min_x(middle),
        state,
        beside,
        palette,
        commands,
    );
}

/// Draws the groups at the left, the views in the front group beside them, and the tools at the
/// right.
fn view_bar_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let bar = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), BAR));
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
            figure_button_ui(ui, state, state.display.layout.arrangement.view(), commands);
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
        response
            .on_hover_text(names.join(", "))
            .asks(LayoutCommand::ShowGroup(group), commands);
    }
}

/// Draws the views of the front group side by side, or as a menu if they do not fit.
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
        ui.allocate_exact_size(vec2(galley.size().x + 14.0, BAR), Sense::click());
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
    response
        .on_hover_text(view.facts().purpose)
        .asks(LayoutCommand::ShowView(view), commands);
}

/// Draws the button that shows a second view beside the view in front, or hides it.
fn beside_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let arrangement = &state.display.layout.arrangement;
    let (button, _) = MenuButton::from_button(Button::new("     ").frame(false)).ui(ui, |ui| {
        let others = View::ALL
            .into_iter()
            .filter(|view| *view != arrangement.view())
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

/// Draws a view with its title and tools into an area.
fn part_ui(
    ui: &mut Ui,
    area: Rect,
    state: &mut State,
    view: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let top = if state.is_example { 0 } else { 6 };
    let padding = Margin {
        left: PADDING,
        right: PADDING,
        top,
        bottom: 4,
    };
    clipped_ui(ui, ("view", view), area, padding, |ui| {
        title_row_ui(ui, state, view, palette, commands);
        let draw = view_content(view).draw;
        region_ui(ui, Region::Plots, |ui| draw(ui, state, palette, commands));
    });
}

/// Draws content clipped to an area.
fn clipped_ui(
    ui: &mut Ui,
    id: impl AsIdSalt,
    area: Rect,
    padding: Margin,
    add: impl FnOnce(&mut Ui),
) {
    ui.scope_builder(UiBuilder::new().id_salt(id).max_rect(area), |ui| {
        ui.set_clip_rect(area.intersect(ui.clip_rect()));
        Frame::new().inner_margin(padding).show(ui, add);
    });
    ui.advance_cursor_after_rect(area);
}

/// Draws the title of the view at the left and its tools at the right; if they do not fit, the
/// tools move to a line below.
fn title_row_ui(
    ui: &mut Ui,
    state: &State,
    view: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    /// Minimum title width \[pt\].
    const LEAST: f32 = 200.0;
    let content = view_content(view);
    let width = ui.available_width();
    let is_titled = !matches!(content.title, ViewTitle::None);
    if is_titled && width - content.tools_width < LEAST && content.tools_width > 0.0 {
        row_ui(ui, width, |ui| title_ui(ui, state, content.title, palette));
        row_ui(ui, width, |ui| tools_ui(ui, state, view, palette, commands));
    } else if is_titled || content.tools_width > 0.0 {
        row_ui(ui, width, |ui| {
            tools_ui(ui, state, view, palette, commands);
            let rest = ui.available_rect_before_wrap();
            in_line_ui(ui, rest, false, |ui| {
                title_ui(ui, state, content.title, palette)
            });
        });
    }
}

fn row_ui(ui: &mut Ui, width: f32, add: impl FnOnce(&mut Ui)) {
    ui.allocate_ui_with_layout(
        vec2(width, TITLE),
        Layout::right_to_left(Align::Center).with_main_wrap(false),
        |ui| {
            ui.set_min_size(vec2(width, TITLE));
            add(ui);
        },
    );
}

fn tools_ui(
    ui: &mut Ui,
    state: &State,
    view: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // Skip the front view: its figure button is in the view bar.
    if view != state.display.layout.arrangement.view() {
        figure_button_ui(ui, state, view, commands);
    }
    (view_content(view).tools)(ui, state, palette, commands);
    if view.facts().is_of_all_conditions && state.others_are_older() {
        let text = palette.small_warning("of older settings");
        ui.label(text)
            .on_hover_text("The displayed condition is up to date; the others are being computed");
    }
}

/// Draws a title such as "LON → Q  condition 10: 60 kt, low altitude, high weight"; some views omit
/// the response or the condition.
fn title_ui(ui: &mut Ui, state: &State, title: ViewTitle, palette: &Palette) {
    let condition = state.condition();
    let id = condition.id();
    let flight_state = &condition.flight_state().name;
    let response = state.dataset().pair_name(state.display.selection.pair);
    match title {
        ViewTitle::ResponseAndCondition => {
            heading_ui(ui, &response);
            dim_ui(ui, palette, format!("condition {id}: {flight_state}"));
        }
        ViewTitle::ResponseOnly => heading_ui(ui, &response),
        ViewTitle::Condition => {
            heading_ui(ui, &format!("Condition {id}"));
            dim_ui(ui, palette, flight_state.clone());
        }
        ViewTitle::Words(words) => dim_ui(ui, palette, words(state)),
        ViewTitle::None => {}
    }
}

fn heading_ui(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).font(medium(TITLE_SIZE)));
}

fn dim_ui(ui: &mut Ui, palette: &Palette, text: String) {
    ui.add(Label::new(palette.dim(text)).truncate());
}

/// Draws the view in the dock, which is folded to its bar in a low window.
fn dock_ui(
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
