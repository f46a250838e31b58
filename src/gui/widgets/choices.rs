//! Controls for choices: check boxes, switches, tabs and drop-down lists.

use egui::{Button, ComboBox, Response, Role, Ui, WidgetInfo};

use super::controls::{hint_ui, named, named_switch};

/// Draws a small drop-down list of choices (value, text, tooltip); stores the selected value in
/// `value`.
pub fn choice_ui<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    value: &mut T,
    choices: &[(T, &str, &str)],
) {
    let mut current = "…";
    for (choice, text, _) in choices {
        if choice == value {
            current = text;
            break;
        }
    }
    let shown = ComboBox::from_id_salt(name)
        .selected_text(current)
        .width(60.0)
        .show_ui(ui, |ui| {
            for (choice, text, hint) in choices {
                ui.selectable_value(value, *choice, *text)
                    .on_hover_text(*hint);
            }
        });
    shown
        .response
        .widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
    shown.response.on_hover_text(name);
}

/// Draws a check box; returns its new state after a click.
pub fn check_ui(
    ui: &mut Ui,
    is_on: bool,
    text: impl Into<String>,
    hint: impl Into<String>,
) -> Option<bool> {
    let mut value = is_on;
    let response = ui.checkbox(&mut value, text.into());
    let changed = response.changed();
    hint_ui(response, hint);
    if changed { Some(value) } else { None }
}

/// Draws a drop-down list with an accessible name and `text` as its value; returns the choice.
pub fn list_ui<T: Copy>(
    ui: &mut Ui,
    name: &str,
    (width, text): (f32, &str),
    choices: impl IntoIterator<Item = (T, bool, String)>,
) -> Option<T> {
    let shown = ComboBox::from_id_salt(name)
        .width(width)
        .selected_text(text)
        .show_ui(ui, |ui| {
            let mut clicked = None;
            for (choice, is_chosen, text) in choices {
                if ui.selectable_label(is_chosen, text).clicked() {
                    clicked = Some(choice);
                }
            }
            clicked
        });
    named(shown.response, Role::ComboBox, name);
    shown.inner.flatten()
}

/// Draws an on/off button with a text and an accessible name; returns whether it was clicked.
pub fn toggle_ui(ui: &mut Ui, (text, name): (&str, &str), is_on: bool, hint: &str) -> bool {
    let button = Button::new(text).selected(is_on).corner_radius(6.0);
    named_switch(ui.add(button), Role::CheckBox, is_on, name)
        .on_hover_text(hint)
        .clicked()
}

/// Draws the tab of a page of a view; returns whether it was clicked. Its accessible name is "Page
/// NAME".
pub fn page_tab_ui(
    ui: &mut Ui,
    is_shown: bool,
    short_name: &str,
    (name, purpose): (&str, &str),
) -> (Response, bool) {
    let tab = ui.selectable_label(is_shown, short_name);
    let tab = named_switch(tab, Role::Button, is_shown, format!("Page {name}"))
        .on_hover_text(format!("{name}: {purpose}"));
    let is_clicked = tab.clicked();
    (tab, is_clicked)
}
