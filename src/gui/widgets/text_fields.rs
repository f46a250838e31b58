//! Text fields: [`text_field_ui`] changes a text while it is typed, [`entry_ui`] returns the text
//! once it is complete.

use egui::{Id, Key, Response, Role, TextEdit, Ui, WidgetInfo, vec2};

/// Text entry height \[pt\].
const ENTRY_HEIGHT: f32 = 20.0;

/// Draws a single-line text field with an accessible name.
pub fn text_field_ui(
    ui: &mut Ui,
    name: &str,
    text: &mut String,
    hint: &str,
    width: f32,
) -> Response {
    let response = ui.add(
        TextEdit::singleline(text)
            .hint_text(hint)
            .desired_width(width),
    );
    name_text_field(&response, name, text);
    response
}

/// Names a text field and reports its content to screen readers.
pub fn name_text_field(response: &Response, name: &str, text: &str) {
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::TextInput, true, name);
        info.current_text_value = Some(text.to_owned());
        info
    });
}

/// Returns whether editing was ended by Enter.
pub fn is_entered(ui: &Ui, field: &Response) -> bool {
    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}

/// Returns the id of the text field that [`entry_ui`] draws under this name, to focus it.
pub fn entry_field_id(name: &str) -> Id {
    entry_id(name).with("field")
}

/// Returns the id under which an entry's unfinished text is stored.
fn entry_id(name: &str) -> Id {
    Id::unique(("entry", name))
}

/// Draws a text field with an accessible name and `value`; returns the typed text after Enter or
/// when the focus leaves, `None` if it equals `value` or Escape was pressed.
pub fn entry_ui(ui: &mut Ui, name: &str, value: &str, hint: &str, width: f32) -> Option<String> {
    let id = entry_id(name);
    let edited = ui.data(|data| data.get_temp::<String>(id));
    let mut text = edited.unwrap_or_else(|| value.to_owned());
    let edit = TextEdit::singleline(&mut text)
        .id(entry_field_id(name))
        .hint_text(hint);
    let response = ui.add_sized(vec2(width, ENTRY_HEIGHT), edit);
    name_text_field(&response, name, &text);
    if response.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        let is_given_up = ui.input(|input| input.key_pressed(Key::Escape));
        if is_given_up || text == value {
            return None;
        }
        return Some(text);
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    }
    None
}
