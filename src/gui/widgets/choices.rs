//! Controls for choices: check boxes, switches, tabs and drop-down lists.
//!
//! [`choice_ui`] changes a value in place; [`DropDown`] returns the chosen entry, which may be a
//! command.

use egui::text::{LayoutJob, TextFormat};
use egui::{Button, ComboBox, Role, TextWrapMode, Ui, WidgetInfo};

use super::controls::{hint_ui, named, named_switch};
use super::painted_text::chevron_down;
use super::palette::{BODY_SIZE, Palette, body, medium};

/// Draws a small drop-down list of choices (value, text, tooltip); stores the selected value in
/// `value`.
pub fn choice_ui<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    value: &mut T,
    choices: &[(T, &str, &str)],
) {
    let shown = ComboBox::from_id_salt(name)
        .selected_text(current_text(choices, value))
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

/// Returns the text of the selected choice; "…" if the value is none of the choices.
fn current_text<'a, T: PartialEq>(choices: &'a [(T, &str, &str)], value: &T) -> &'a str {
    for (choice, text, _) in choices {
        if choice == value {
            return text;
        }
    }
    "…"
}

/// Option in a page bar: a drop-down list whose closed text is its label and the chosen value.
pub struct PageOption<'a> {
    /// Accessible name.
    pub name: &'a str,
    /// Word before the value.
    pub label: &'a str,
}

impl PageOption<'_> {
    /// Draws the list of choices (value, text, tooltip); stores the selected value in `value`.
    pub fn ui<T: Copy + PartialEq>(
        &self,
        ui: &mut Ui,
        value: &mut T,
        choices: &[(T, &str, &str)],
        palette: &Palette,
    ) {
        let current = current_text(choices, value);
        let text = Self::closed_text_of(self.label, current, palette);
        let arrow = palette.dim_text;
        let shown = ComboBox::from_id_salt(self.name)
            .selected_text(text)
            .width(0.0)
            .wrap_mode(TextWrapMode::Extend)
            .icon(move |ui, place, _, _| {
                chevron_down(ui, place.center(), arrow);
            })
            .show_ui(ui, |ui| {
                for (choice, text, hint) in choices {
                    ui.selectable_value(value, *choice, *text)
                        .on_hover_text(*hint);
                }
            });
        named(shown.response, Role::ComboBox, self.name);
    }

    /// Returns the dim label, followed by the value.
    pub fn closed_text_of(label: &str, value: &str, palette: &Palette) -> LayoutJob {
        let mut text = LayoutJob::default();
        let dim = TextFormat::simple(body(), palette.dim_text);
        let strong = TextFormat::simple(medium(BODY_SIZE), palette.text);
        text.append(&format!("{label} "), 0.0, dim);
        text.append(value, 0.0, strong);
        text
    }
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

/// Drop-down list whose entries are commands or values of any kind.
pub struct DropDown<'a> {
    /// Accessible name.
    pub name: &'a str,
    /// Width \[pt\].
    pub width: f32,
    /// Text in the closed list.
    pub text: &'a str,
}

impl DropDown<'_> {
    /// Draws the list with its choices (value, whether it is the current one, text); returns the
    /// value of a clicked choice.
    pub fn ui<T: Copy>(
        &self,
        ui: &mut Ui,
        choices: impl IntoIterator<Item = (T, bool, String)>,
    ) -> Option<T> {
        let shown = ComboBox::from_id_salt(self.name)
            .width(self.width)
            .selected_text(self.text)
            .show_ui(ui, |ui| {
                let mut clicked = None;
                for (choice, is_chosen, text) in choices {
                    if ui.selectable_label(is_chosen, text).clicked() {
                        clicked = Some(choice);
                    }
                }
                clicked
            });
        named(shown.response, Role::ComboBox, self.name);
        shown.inner.flatten()
    }
}

/// On/off button.
pub struct Toggle<'a> {
    pub text: &'a str,
    /// Accessible name.
    pub name: &'a str,
    /// Tooltip.
    pub hint: &'a str,
}

impl Toggle<'_> {
    /// Draws the button; returns whether it was clicked.
    pub fn ui(&self, ui: &mut Ui, is_on: bool) -> bool {
        let button = Button::new(self.text).selected(is_on).corner_radius(6.0);
        named_switch(ui.add(button), Role::CheckBox, is_on, self.name)
            .on_hover_text(self.hint)
            .clicked()
    }
}

/// Texts for a page's tab.
#[derive(Clone, Copy, Debug)]
pub struct PageWords {
    /// Name in tooltips and in the accessible name.
    pub name: &'static str,
    /// Tab text, short enough for narrow windows.
    pub short_name: &'static str,
    /// Sentence about the page's content.
    pub purpose: &'static str,
}
