//! Form parts: title, fields, buttons.

use egui::text::{CCursor, CCursorRange};
use egui::{Align, Button, Layout, RichText, TextEdit, Ui, vec2};

use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::text_fields::{is_entered, name_text_field};

/// Form being drawn.
pub(super) struct Form<'a, 'c> {
    pub(super) ui: &'a mut Ui,
    /// Whether this is the form's first frame.
    pub(super) opens: bool,
    pub(super) palette: &'a Palette,
    pub(super) commands: &'c mut Vec<Command>,
}

impl Form<'_, '_> {
    pub(super) fn title(&mut self, text: &str) {
        self.ui.label(RichText::new(text).strong().size(15.0));
        self.ui.add_space(4.0);
    }

    pub(super) fn explain(&mut self, text: &str) {
        self.ui.label(self.palette.dim(text));
    }

    pub(super) fn choices_ui<T: PartialEq>(
        &mut self,
        chosen: &mut T,
        choices: impl IntoIterator<Item = (T, &'static str)>,
    ) {
        for (value, text) in choices {
            self.ui.radio_value(chosen, value, text);
        }
    }

    /// Draws a label before a field.
    pub(super) fn labelled(&mut self, text: &str) {
        let size = vec2(56.0, self.ui.spacing().interact_size.y);
        self.ui
            .allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
                ui.set_min_width(size.x);
                ui.label(self.palette.dim(text));
            });
    }

    /// Draws the button that closes the form, and a note if the form's action waits for the newest
    /// results.
    pub(super) fn cancel_ui(&mut self, waits: bool) {
        self.button_ui("Cancel", false, FormCommand::ShowForm(None));
        if waits {
            self.explain("waiting for the newest results");
        }
    }

    /// Draws the form's text field; returns whether Enter was pressed in it.
    pub(super) fn text_ui(&mut self, name: &str, text: &mut String, hint: &str) -> bool {
        let shown = TextEdit::singleline(text)
            .hint_text(hint)
            .desired_width(f32::INFINITY)
            .show(self.ui);
        let response = shown.response.response;
        name_text_field(&response, name, text);
        if self.opens {
            // Typing replaces the initial text.
            let mut edited = shown.state;
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
            edited.cursor.set_char_range(Some(all));
            edited.store(self.ui.ctx(), response.id);
            response.request_focus();
        }
        is_entered(self.ui, &response)
    }

    /// Draws the submit button; Enter in a field of the form (`entered`) also presses it, if it is
    /// enabled (`is_ready`).
    pub(super) fn submit_ui(
        &mut self,
        text: &str,
        is_ready: bool,
        entered: bool,
        command: Option<Command>,
    ) {
        let clicked = self.ui.add_enabled(is_ready, Button::new(text)).clicked();
        if clicked || (entered && is_ready) {
            self.commands.extend(command);
        }
    }

    /// Draws a button. `is_first` marks the first button of a form without a text field, which has
    /// the focus when the form opens.
    pub(super) fn button_ui(&mut self, text: &str, is_first: bool, command: impl Into<Command>) {
        let response = self.ui.button(text);
        if is_first && self.opens {
            response.request_focus();
        }
        if response.clicked() {
            self.commands.push(command.into());
        }
    }

    /// Lays out the content in a single line.
    pub(super) fn line(&mut self, add: impl FnOnce(&mut Form<'_, '_>)) {
        let opens = self.opens;
        let palette = self.palette;
        let commands = &mut *self.commands;
        self.ui.horizontal(|ui| {
            add(&mut Form {
                ui,
                opens,
                palette,
                commands,
            })
        });
    }
}
