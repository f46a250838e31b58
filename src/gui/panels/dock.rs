//! Dock below the views: net gains, schedule cost, and leads. It can be folded to its bar, and
//! enlarged.

use egui::containers::panel::PanelState;
use egui::{Align, Frame, Layout, Margin, Panel, Rect, RichText, Role, Sense, Ui, vec2};

use super::view_frame::{PADDING, clipped_ui, title_ui, tools_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::view_content;
use crate::gui::widgets::choices::PageWords;
use crate::gui::widgets::controls::{Asks, named_switch};
use crate::gui::widgets::page_switch::{PageTab, page_switch_ui, page_switch_width};
use crate::gui::widgets::painted_text::chevron;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};
use crate::gui::widgets::panel_layout::{in_line_ui, restore_panel_size};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Draws the dock with its page; in a low window, the dock is folded to its bar by default. A
/// double click on the bar doubles the dock's height, or restores it.
pub(super) fn dock_ui(
    ui: &mut Ui,
    state: &mut State,
    page: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let window = ui.ctx().content_rect().height();
    let arrangement = &state.display.layout.arrangement;
    let dock = Dock {
        page: present_page(state, page),
        is_open: arrangement.is_dock_open(window >= LEAST_WITH_DOCK),
        is_enlarged: arrangement.is_dock_enlarged(),
    };
    let frame = Frame::new().fill(palette.background);
    restore_panel_size(ui, "dock");
    let usual = usual_height(ui, window);
    let panel = Panel::bottom(dock.panel_name()).frame(frame);
    let panel = if dock.is_open && dock.is_enlarged {
        panel.exact_size((2.0 * usual).min(MOST_PART * window).round())
    } else if dock.is_open {
        panel
            .resizable(true)
            .default_size(usual)
            .size_range(LEAST_OPEN..=0.6 * window)
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
            if dock.is_open {
                let draw = view_content(dock.page).draw;
                region_ui(ui, Region::Dock, |ui| draw(ui, state, palette, commands));
            }
        });
    });
}

/// Folded dock height \[pt\].
const FOLDED: f32 = 34.0;
/// Minimum window height at which the dock is unfolded by default \[pt\].
const LEAST_WITH_DOCK: f32 = 680.0;
/// Default dock height, as a share of the window height: a larger share would take height
/// from the view above.
const DOCK_PART: f32 = 0.252;
/// Maximum height of the enlarged dock, as a share of the window height; the view above it stays
/// visible.
const MOST_PART: f32 = 0.66;
/// Minimum height of the unfolded dock \[pt\].
const LEAST_OPEN: f32 = 140.0;
/// Window height, without the dock, that gives the Bode plots five ticks on each axis \[pt\]. In
/// low windows the dock shrinks first.
const REST_OF_WINDOW: f32 = 568.0;

/// Returns the height to which the unfolded dock was dragged, else its default height \[pt\].
fn usual_height(ui: &Ui, window: f32) -> f32 {
    match PanelState::load(ui.ctx(), ui.scope_id().with("dock")) {
        Some(dragged) => dragged.size().y,
        None => default_height(window),
    }
}

/// Returns the unfolded dock's default height for a window height \[pt\].
fn default_height(window: f32) -> f32 {
    (DOCK_PART * window)
        .min(window - REST_OF_WINDOW)
        .max(LEAST_OPEN)
        .round()
}

/// Returns the page, or the net gains if the study has no content for it.
fn present_page(state: &State, page: View) -> View {
    let mut pages = View::docked(state.study.settings.phase);
    if pages.any(|present| present == page) {
        page
    } else {
        View::NetGain
    }
}

/// The dock's page, whether the dock is unfolded, and whether its height is doubled.
#[derive(Clone, Copy)]
struct Dock {
    page: View,
    is_open: bool,
    is_enlarged: bool,
}

impl Dock {
    /// Returns the name under which the panel keeps its height.
    fn panel_name(self) -> &'static str {
        match (self.is_open, self.is_enlarged) {
            (true, true) => "enlarged dock",
            (true, false) => "dock",
            (false, _) => "folded dock",
        }
    }
}

/// Draws the dock's head: an arrow that folds it, the pages, and the tools.
fn dock_head_ui(
    ui: &mut Ui,
    state: &State,
    dock: Dock,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let width = ui.available_width();
    let bar = Rect::from_min_size(ui.cursor().min, vec2(width, FOLDED));
    let bar = ui.interact(bar, ui.scope_id().with("dock bar"), Sense::click());
    if bar.double_clicked() {
        let is_enlarged = dock.is_open && dock.is_enlarged;
        commands.push(LayoutCommand::EnlargeDock(!is_enlarged).into());
    }
    named_switch(bar, Role::Button, dock.is_enlarged, "Enlarge the dock");
    ui.allocate_ui_with_layout(
        vec2(width, FOLDED),
        Layout::right_to_left(Align::Center),
        |ui| {
            ui.set_min_size(vec2(width, FOLDED));
            if dock.is_open {
                tools_ui(ui, state, dock.page, palette, commands);
            }
            let rest = ui.available_rect_before_wrap();
            in_line_ui(ui, rest, false, |ui| {
                fold_ui(ui, dock.is_open, palette, commands);
                dock_pages_ui(ui, state, dock.page, palette, commands);
                ui.add_space(4.0);
                // Selectable text would take the double click from the bar.
                ui.style_mut().interaction.selectable_labels = false;
                title_ui(ui, state, view_content(dock.page).title, palette);
            });
        },
    );
}

fn fold_ui(ui: &mut Ui, is_open: bool, palette: &Palette, commands: &mut Vec<Command>) {
    let (place, response) = ui.allocate_exact_size(vec2(16.0, FOLDED), Sense::click());
    chevron(ui, place.center(), is_open, palette);
    let hint = if is_open {
        "Fold the plots below; a double click on the bar enlarges the dock, or restores it"
    } else {
        "Unfold the plots below"
    };
    named_switch(response, Role::Button, is_open, "Dock")
        .on_hover_text(hint)
        .asks(LayoutCommand::OpenDock(!is_open), commands);
}

/// Draws the switch between the dock's pages, or a plain name if there is only one. Without room
/// beside the tools, the schedule's cost has a shorter name.
fn dock_pages_ui(
    ui: &mut Ui,
    state: &State,
    shown_page: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pages: Vec<View> = View::docked(state.study.settings.phase).collect();
    if let [only] = pages[..] {
        let name = only.name();
        ui.label(RichText::new(name).font(medium(BODY_SIZE)));
        return;
    }
    let is_narrow =
        page_switch_width(ui, pages.iter().map(|page| page.name())) > ui.available_width();
    let mut tabs = Vec::new();
    for page in &pages {
        let short_name = match page {
            View::ScheduleCost if is_narrow => "Cost",
            _ => page.name(),
        };
        tabs.push(PageTab {
            words: PageWords {
                name: page.name(),
                short_name,
                purpose: page.facts().purpose,
            },
            is_shown: *page == shown_page,
        });
    }
    if let Some(clicked) = page_switch_ui(ui, &tabs, palette) {
        commands.push(LayoutCommand::ShowInDock(pages[clicked]).into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dock_shrinks_before_the_plots_above() {
        assert_eq!(default_height(900.0), 227.0);
        assert_eq!(default_height(720.0), 152.0);
        assert_eq!(default_height(600.0), LEAST_OPEN);
    }
}
