//! Frame of a view: the page bar with title, pages and tools, above the clipped content.

use egui::{Align, AsIdSalt, Frame, Layout, Margin, Rect, RichText, Ui, UiBuilder, vec2};

use crate::gui::commands::command::Command;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::across::across_context;
use crate::gui::views::figure_button::figure_button_ui;
use crate::gui::views::{PageEntry, ViewTitle, view_content};
use crate::gui::widgets::elision::{leading_parts, text_width};
use crate::gui::widgets::page_switch::{PageTab, page_switch_ui};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, TITLE_SIZE, body, medium};
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
/// not fit beside one another, as in half of a narrow window, the tools move to a line below.
fn page_bar_ui(
    ui: &mut Ui,
    state: &State,
    view: View,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let content = view_content(view);
    let width = ui.available_width();
    let bar = PageBar {
        title: title_words(state, content.title).or_named(view),
        pages: (content.pages)(state),
    };
    if bar.least_width(ui) + content.tools_width > width && content.tools_width > 0.0 {
        row_ui(ui, width, |ui| bar.ui(ui, palette, commands));
        row_ui(ui, width, |ui| tools_ui(ui, state, view, palette, commands));
        return;
    }
    row_ui(ui, width, |ui| {
        tools_ui(ui, state, view, palette, commands);
        bar.ui(ui, palette, commands);
    });
}

/// Left part of a page bar.
struct PageBar {
    title: TitleWords,
    pages: Vec<PageEntry>,
}

impl PageBar {
    /// Returns the width of title and page switch, without the context \[pt\].
    fn least_width(&self, ui: &Ui) -> f32 {
        /// Segment padding, and the gap beside the title \[pt\].
        const PAD: f32 = 24.0;
        let mut width = text_width(ui, &self.title.heading, medium(TITLE_SIZE)) + PAD;
        if self.pages.len() > 1 {
            for page in &self.pages {
                width += text_width(ui, page.words.short_name, medium(BODY_SIZE)) + PAD;
            }
        }
        width
    }

    /// Draws the title, the page switch and the context, in this order, in the rest of a row.
    fn ui(&self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        let rest = ui.available_rect_before_wrap();
        in_line_ui(ui, rest, false, |ui| {
            heading_ui(ui, &self.title.heading);
            pages_ui(ui, &self.pages, palette, commands);
            context_ui(ui, palette, &self.title.context);
        });
    }
}

/// Draws a view's page switch; a click shows the page.
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
        let text = palette.small_warning("from older settings");
        let hint = if state.results.stopped {
            "The displayed condition is up to date; the computation of the others was stopped: choose \
            Compute to continue"
        } else {
            "The displayed condition is up to date; the others are being computed"
        };
        ui.label(text).on_hover_text(hint);
    }
}

/// Draws the title of a dock page, such as "LON → Q condition 10: 60 kt, low altitude, high
/// weight"; some omit the response or the condition.
pub(super) fn title_ui(ui: &mut Ui, state: &State, title: ViewTitle, palette: &Palette) {
    let words = title_words(state, title);
    if !words.heading.is_empty() {
        heading_ui(ui, &words.heading);
    }
    context_ui(ui, palette, &words.context);
}

/// A view's title in two parts, each empty if the view has none.
struct TitleWords {
    /// Subject shown in the view, such as the response.
    heading: String,
    /// Additional text, whose last parts are omitted in a narrow window.
    context: String,
}

impl TitleWords {
    /// Returns the title with the view's name as heading, if it has none.
    fn or_named(mut self, view: View) -> Self {
        if self.heading.is_empty() {
            view.name().clone_into(&mut self.heading);
        }
        self
    }
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
            heading: String::new(),
            context: format!("condition {id}: {flight_state}"),
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

/// Draws as many leading parts of the context as fit; nothing if not even the first part fits.
fn context_ui(ui: &mut Ui, palette: &Palette, text: &str) {
    let room = ui.available_width() - ui.spacing().item_spacing.x;
    let shown = leading_parts(ui, text, room, BODY_SIZE);
    if !shown.is_empty() && text_width(ui, shown, body()) <= room {
        ui.label(palette.dim(shown));
    }
}
