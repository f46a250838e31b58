//! Text field for a number that may be missing. The number is typed without its unit;
//! `number_field.rs` has the fields that can be dragged and show their unit.

use egui::Ui;

use super::text_fields::entry_ui;
use crate::message::Message;

/// Reason why an entry is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedEntry(pub Message);

/// Like [`entry_ui`], but for a number; any other text is refused by a command with the reason.
/// Returns `None` without a new number, and `Some(None)` if the field was emptied.
pub fn number_entry_ui<C: From<RefusedEntry>>(
    ui: &mut Ui,
    name: &str,
    value: &str,
    hint: &str,
    width: f32,
    commands: &mut Vec<C>,
) -> Option<Option<f64>> {
    match typed_number(&entry_ui(ui, name, value, hint, width)?) {
        Ok(number) => Some(number),
        Err(why) => {
            let message = Message::new(why.code, format!("{name}: {}", why.text));
            commands.push(RefusedEntry(message).into());
            None
        }
    }
}

/// Parses a number with a decimal comma or point; `None` for empty text.
///
/// # Errors
/// A message with the expected and the found text.
pub fn typed_number(text: &str) -> Result<Option<f64>, Message> {
    let text = text.trim().replace(',', ".");
    if text.is_empty() {
        return Ok(None);
    }
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => Err(Message::new(
            "not-a-number",
            format!("expected a number, found \"{text}\""),
        )),
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
