//! A field whose text is taken up when it is left.

use egui::{Id, Key, Role, TextEdit, Ui, WidgetInfo, vec2};

const HEIGHT: f32 = 20.0;

/// A text field of this accessible name that shows `value`; gives what was typed once the field is left or Enter is pressed.
pub fn entry_ui(ui: &mut Ui, name: &str, value: &str, hint: &str, width: f32) -> Option<String> {
    let id = Id::unique(("entry", name));
    let held = ui.data(|data| data.get_temp::<String>(id));
    let mut text = held.unwrap_or_else(|| value.to_owned());
    let edit = TextEdit::singleline(&mut text).id(id.with("field")).hint_text(hint);
    let response = ui.add_sized(vec2(width, HEIGHT), edit);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::TextInput, true, name);
        info.current_text_value = Some(text.clone());
        info
    });
    if response.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        let is_given_up = ui.input(|input| input.key_pressed(Key::Escape));
        return (!is_given_up && text != value).then_some(text);
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    }
    None
}

/// A number as engineers type it, with a decimal comma or a point; nothing for an empty text.
pub fn typed_number(text: &str) -> Result<Option<f64>, String> {
    let text = text.trim().replace(',', ".");
    if text.is_empty() {
        return Ok(None);
    }
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => Err(format!("expected a number, found \"{text}\"")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_taken_with_a_comma_or_a_point_and_nothing_else_is() {
        assert_eq!(typed_number(" 1,5 "), Ok(Some(1.5)));
        assert_eq!(typed_number(""), Ok(None));
        assert!(typed_number("12 kt").is_err() && typed_number("inf").is_err());
    }
}
