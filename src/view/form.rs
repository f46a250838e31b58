//! What every form is made of: a title, a field that has the focus when it opens, and buttons.

use egui::text::{CCursor, CCursorRange};
use egui::{Button, Key, RichText, Role, TextEdit, Ui, WidgetInfo};

use super::command::Command;

/// A form being drawn.
pub(super) struct Form<'a, 'c> {
    pub(super) ui: &'a mut Ui,
    /// Whether this is the first frame that shows it.
    pub(super) opens: bool,
    pub(super) commands: &'c mut Vec<Command>,
}

impl Form<'_, '_> {
    pub(super) fn title(&mut self, text: &str) {
        self.ui.label(RichText::new(text).strong().size(15.0));
        self.ui.add_space(4.0);
    }

    /// The text field of the form; whether the Enter key was pressed in it.
    pub(super) fn text_ui(&mut self, name: &str, text: &mut String, hint: &str) -> bool {
        let shown = TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY).show(self.ui);
        let response = shown.response.response;
        response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::TextInput, true, name);
            info.current_text_value = Some(text.clone());
            info
        });
        if self.opens {
            // What stands there is replaced by what is typed.
            let mut edited = shown.state;
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
            edited.cursor.set_char_range(Some(all));
            edited.store(self.ui.ctx(), response.id);
            response.request_focus();
        }
        response.lost_focus() && self.ui.input(|input| input.key_pressed(Key::Enter))
    }

    /// The button that submits the form, which Enter does too; others follow on the same line.
    pub(super) fn submit_ui(&mut self, text: &str, is_ready: bool, entered: bool, command: impl FnOnce() -> Command) {
        let clicked = self.ui.add_enabled(is_ready, Button::new(text)).clicked();
        if clicked || (entered && is_ready) {
            self.commands.push(command());
        }
    }

    /// A button; the first of a form without a text field has the focus when it opens.
    pub(super) fn button_ui(&mut self, text: &str, is_first: bool, command: Command) {
        let response = self.ui.button(text);
        if is_first && self.opens {
            response.request_focus();
        }
        if response.clicked() {
            self.commands.push(command);
        }
    }

    /// What follows stands on one line.
    pub(super) fn line(&mut self, add: impl FnOnce(&mut Form<'_, '_>)) {
        let (opens, commands) = (self.opens, &mut *self.commands);
        self.ui.horizontal(|ui| add(&mut Form { ui, opens, commands }));
    }
}
