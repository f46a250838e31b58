//! Controls with accessible names, and controls that emit commands: buttons, menu entries.
//!
//! Texts are in `painted_text.rs` and `text_fields.rs`, numbers in `number_field.rs` and
//! `number_entry.rs`, check boxes and drop-down lists in `choices.rs`, list rows in `list_row.rs`.
//!
//! A command is a request that a control adds to a list for its caller to carry out; its type `C`
//! is the caller's.

use egui::{Button, Rect, RectAlign, Response, Role, Tooltip, Ui, WidgetInfo};

/// Names a control for screen readers and tests.
pub fn named(response: Response, role: Role, name: impl Into<String>) -> Response {
    let enabled = response.enabled();
    let name = name.into();
    response.widget_info(|| WidgetInfo::labeled(role, enabled, &name));
    response
}

/// Names an on/off control and reports its state for screen readers and tests.
pub fn named_switch(
    response: Response,
    role: Role,
    is_on: bool,
    name: impl Into<String>,
) -> Response {
    let enabled = response.enabled();
    let name = name.into();
    response.widget_info(|| WidgetInfo::selected(role, enabled, is_on, &name));
    response
}

/// Adds a tooltip unless `hint` is empty, because egui would draw an empty box.
pub fn hint_ui(response: Response, hint: impl Into<String>) -> Response {
    let hint = hint.into();
    if hint.is_empty() {
        response
    } else {
        response.on_hover_text(hint)
    }
}

/// Adds a tooltip at the left of `subject`, the part of the window that the tooltip explains, so
/// that it covers neither the subject nor the controls in it.
pub fn hint_left_of(response: Response, subject: Rect, hint: &str) -> Response {
    tooltip_left_of(&response, subject, |ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        ui.label(hint);
    });
    response
}

/// Like [`hint_left_of`], with content drawn by `add`.
pub fn tooltip_left_of(response: &Response, subject: Rect, add: impl FnOnce(&mut Ui)) {
    let mut tooltip = Tooltip::for_enabled(response);
    tooltip.popup = tooltip.popup.anchor(subject).align(RectAlign::LEFT_START);
    tooltip.show(add);
}

/// Adds a tooltip at the right of `subject`, a row of a list or table, so that it covers no other
/// row.
pub fn hint_right_of(response: Response, subject: Rect, hint: &str) -> Response {
    tooltip_right_of(&response, subject, |ui| {
        ui.set_max_width(BESIDE_ROW);
        ui.label(hint);
    });
    response
}

/// Width of a text beside a row \[pt\]: the panel at the right of a table has room for it.
const BESIDE_ROW: f32 = 270.0;

/// Like [`hint_right_of`], with content drawn by `add`.
pub fn tooltip_right_of(response: &Response, subject: Rect, add: impl FnOnce(&mut Ui)) {
    let mut tooltip = Tooltip::for_enabled(response);
    tooltip.popup = tooltip.popup.anchor(subject).align(RectAlign::RIGHT_START);
    tooltip.show(add);
}

/// Adds a tooltip above a control whose subject lies below it, such as a curve.
pub fn hint_above(response: Response, hint: &str) -> Response {
    let mut tooltip = Tooltip::for_enabled(&response);
    tooltip.popup = tooltip.popup.align(RectAlign::TOP_START);
    tooltip.show(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        ui.label(hint);
    });
    response
}

/// Control that emits a command.
pub trait Asks {
    /// Emits the command on a click.
    fn asks<C>(&self, command: impl Into<C>, commands: &mut Vec<C>);
}

impl Asks for Response {
    fn asks<C>(&self, command: impl Into<C>, commands: &mut Vec<C>) {
        if self.clicked() {
            commands.push(command.into());
        }
    }
}

/// Draws a button that emits a command.
pub fn button_ui<C>(
    ui: &mut Ui,
    button: Button<'_>,
    hint: &str,
    command: impl Into<C>,
    commands: &mut Vec<C>,
) {
    hint_ui(ui.add(button), hint).asks(command, commands);
}

/// Draws menu entries, each with its command; a click closes the menu.
pub fn entries_ui<N: Into<String>, C>(
    ui: &mut Ui,
    entries: impl IntoIterator<Item = (N, C)>,
    commands: &mut Vec<C>,
) {
    for (text, command) in entries {
        if ui.button(text.into()).clicked() {
            commands.push(command);
            ui.close();
        }
    }
}
