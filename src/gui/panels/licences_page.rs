//! Licences of the program's libraries, as a scrollable text.

use std::sync::LazyLock;

use egui::style::ScrollAnimation;
use egui::{FontId, Key, Label, RichText, ScrollArea, TextWrapMode, Ui, vec2};

use super::form_parts::Form;
use crate::gui::commands::form::FormCommand;
use crate::gui::widgets::palette::SMALL_SIZE;
use crate::licences;

/// Width of the longest line \[pt\].
const WIDTH: f32 = 720.0;
/// Height of the form without the text \[pt\].
const OTHER_HEIGHT: f32 = 160.0;

/// Text lines; only visible lines are laid out.
static LINES: LazyLock<Vec<&str>> = LazyLock::new(|| licences::TEXT.lines().collect());

/// Draws the licences; Page up, Page down, Home and End scroll them.
pub(super) fn licences_ui(form: &mut Form<'_, '_>) {
    form.ui.set_width(WIDTH);
    form.title("Licences of the libraries");
    let font = FontId::monospace(SMALL_SIZE);
    let row_height = form.ui.fonts_mut(|fonts| fonts.row_height(&font));
    let room = form.ui.ctx().content_rect().height() - OTHER_HEIGHT;
    let spacing = form.ui.spacing().item_spacing;
    form.ui.spacing_mut().item_spacing.y = 0.0;
    ScrollArea::vertical()
        .max_height(room)
        .auto_shrink([false, true])
        .show_rows(form.ui, row_height, LINES.len(), |ui, rows| {
            scroll_with_keys(ui, room - row_height, row_height * LINES.len() as f32);
            ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
            for line in &LINES[rows] {
                ui.add(Label::new(RichText::new(*line).font(font.clone())));
            }
        });
    form.ui.spacing_mut().item_spacing = spacing;
    form.ui.add_space(8.0);
    form.button_ui("Close", true, FormCommand::ShowForm(None));
}

/// Scrolls by a page, or to the start or end of the text.
fn scroll_with_keys(ui: &Ui, page: f32, whole: f32) {
    for (key, distance) in [
        (Key::PageDown, -page),
        (Key::PageUp, page),
        (Key::End, -whole),
        (Key::Home, whole),
    ] {
        if ui.input(|input| input.key_pressed(key)) {
            ui.scroll_with_delta_animation(vec2(0.0, distance), ScrollAnimation::none());
        }
    }
}
