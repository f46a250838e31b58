//! Frame of a view: the page bar with title, pages and tools, above the clipped content.

use egui::{Align, AsIdSalt, Frame, Label, Layout, Margin, Rect, RichText, Ui, UiBuilder, vec2};

use crate::gui::commands::command::Command;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::across::across_context;
use crate::gui::views::figure_button::figure_button_ui;
use crate::gui::views::{PageEntry, ViewTitle, view_content};
use crate::gui::widgets::page_switch::{PageTab, page_switch_ui};
use crate::gui::widgets::palette::{Palette, TITLE_SIZE, medium};
use crate::gui::widgets::panel_layout::in_line_ui;
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Draws a view with its title and tools into an area.
pub(super) fn view_frame_ui(
    ui: &mut Ui,
    area: Rect,
    state: &mut State,
    view: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let padding = Margin {
        left: PADDING,
        right: PADDING,
        top: 0,
        bottom: 4,
    };
    clipped_ui(ui, ("view", view), area, padding, |ui| {
        page_bar_ui(ui, state, view, palette, commands);
        let draw = view_content(view).draw;
        region_ui(ui, Region::Plots, |ui| draw(ui, state, palette, commands));
    });
}

/// Horizontal padding \[pt\].
pub(super) const PADDING: i8 = 16;
/// Page bar height \[pt\].
const PAGE_BAR: f32 = 40.0;

/// Draws content clipped to an area.
pub(super) fn clipped_ui(
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

/// Draws the page bar: title, page switch and context at the left, tools at the right; if they do
/// not fit, the tools move to a line below.
fn page_bar_ui(
    ui: &mut Ui,
    state: &State,
    view: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    /// Minimum width of title and pages \[pt\].
    const LEAST: f32 = 200.0;
    let content = view_content(view);
    let width = ui.available_width();
    let pages = (content.pages)(state);
    let is_titled = !matches!(content.title, ViewTitle::None) || pages.len() > 1;
    if is_titled && width - content.tools_width < LEAST && content.tools_width > 0.0 {
        row_ui(ui, width, |ui| {
            titled_pages_ui(ui, state, content.title, &pages, palette, commands);
        });
        row_ui(ui, width, |ui| tools_ui(ui, state, view, palette, commands));
    } else if is_titled || content.tools_width > 0.0 {
        row_ui(ui, width, |ui| {
            tools_ui(ui, state, view, palette, commands);
            titled_pages_ui(ui, state, content.title, &pages, palette, commands);
        });
    }
}

/// Draws the title, the page switch and the context, in this order, in the rest of a row.
fn titled_pages_ui(
    ui: &mut Ui,
    state: &State,
    title: ViewTitle,
    pages: &[PageEntry],
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let rest = ui.available_rect_before_wrap();
    in_line_ui(ui, rest, false, |ui| {
        let words = title_words(state, title);
        if !words.heading.is_empty() {
            heading_ui(ui, &words.heading);
        }
        pages_ui(ui, pages, palette, commands);
        context_ui(ui, palette, words.context);
    });
}

/// Draws the page switch of a view; a click shows the page.
fn pages_ui(ui: &mut Ui, pages: &[PageEntry], palette: &Palette, commands: &mut Vec<Command>) {
    let tabs: Vec<PageTab> = pages
        .iter()
        .map(|page| PageTab {
            words: page.words,
            is_shown: page.is_shown,
        })
        .collect();
    if let Some(clicked) = page_switch_ui(ui, &tabs, palette) {
        commands.push(pages[clicked].command.clone());
    }
}

fn row_ui(ui: &mut Ui, width: f32, add: impl FnOnce(&mut Ui)) {
    ui.allocate_ui_with_layout(
        vec2(width, PAGE_BAR),
        Layout::right_to_left(Align::Center).with_main_wrap(false),
        |ui| {
            ui.set_min_size(vec2(width, PAGE_BAR));
            add(ui);
        },
    );
}

pub(super) fn tools_ui(
    ui: &mut Ui,
    state: &State,
    view: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // Skip the front view: its figure button is in the view bar.
    if view != state.display.layout.arrangement.view() {
        figure_button_ui(ui, view, commands);
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
pub(super) fn title_ui(ui: &mut Ui, state: &State, title: ViewTitle, palette: &Palette) {
    let words = title_words(state, title);
    if !words.heading.is_empty() {
        heading_ui(ui, &words.heading);
    }
    context_ui(ui, palette, words.context);
}

/// Title of a view in two parts, each empty if the view has none.
struct TitleWords {
    /// What the view shows, such as the response.
    heading: String,
    /// Further words, which are cut first in a narrow window.
    context: String,
}

fn title_words(state: &State, title: ViewTitle) -> TitleWords {
    let condition = state.condition();
    let id = condition.id();
    let flight_state = &condition.flight_state().name;
    let response = state.dataset().pair_name(state.display.selection.pair);
    match title {
        ViewTitle::ResponseAndCondition => TitleWords {
            heading: response,
            context: format!("condition {id}: {flight_state}"),
        },
        ViewTitle::ResponseOnly => TitleWords {
            heading: response,
            context: across_context(state),
        },
        ViewTitle::Condition => TitleWords {
            heading: format!("Condition {id}"),
            context: flight_state.clone(),
        },
        ViewTitle::NameAndCondition(name) => TitleWords {
            heading: name.to_owned(),
            context: format!("condition {id}, {flight_state}"),
        },
        ViewTitle::Words(words) => TitleWords {
            heading: String::new(),
            context: words(state),
        },
        ViewTitle::Named(name, words) => TitleWords {
            heading: name.to_owned(),
            context: words(state),
        },
        ViewTitle::None => TitleWords {
            heading: String::new(),
            context: String::new(),
        },
    }
}

fn heading_ui(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).font(medium(TITLE_SIZE)));
}

fn context_ui(ui: &mut Ui, palette: &Palette, text: String) {
    if !text.is_empty() {
        ui.add(Label::new(palette.dim(text)).truncate());
    }
}
