//! Typed number lists: frequency bands, model orders, window lengths.

use gdcm_model::units::number;

use crate::gui::widgets::number_entry::typed_number;
use crate::message::Message;

/// Parses numbers separated by blanks; a comma or semicolon after a number is ignored.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, Message> {
    let mut list = Vec::new();
    for part in text.split_whitespace() {
        if let Some(value) = typed_number(part.trim_end_matches([',', ';']))? {
            list.push(value);
        }
    }
    Ok(list)
}

/// Returns the band given by two increasing frequencies \[rad/s\]; `None` for an empty list.
pub(super) fn typed_band(list: &[f64]) -> Result<Option<[f64; 2]>, Message> {
    match *list {
        [] => Ok(None),
        [low, high] if 0.0 < low && low < high => Ok(Some([low, high])),
        _ => Err(Message::new(
            "wrong-band",
            "expected two positive frequencies in rad/s, the lower first, as in \"0.5 12\"",
        )),
    }
}

/// Returns the numbers if all of them are whole numbers from 1 to `highest`.
pub(super) fn whole_numbers(list: &[f64], highest: usize) -> Result<Vec<usize>, Message> {
    let mut whole = Vec::new();
    for &value in list {
        if value.fract() != 0.0 || !(1.0..=highest as f64).contains(&value) {
            let text = format!(
                "expected whole numbers from 1 to {highest}, found {}",
                number(value)
            );
            return Err(Message::new("not-whole-numbers", text));
        }
        whole.push(value as usize);
    }
    Ok(whole)
}

/// Writes a list with blanks between its entries.
pub(super) fn list_text<T: ToString>(list: &[T]) -> String {
    list.iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use gdcm_sysid::identification_error::HIGHEST_ORDER;

    use super::*;

    #[test]
    fn lists_are_parsed_and_wrong_entries_refused() {
        assert_eq!(numbers("2, 4 6.5;").unwrap(), [2.0, 4.0, 6.5]);
        assert_eq!(numbers("2 x").unwrap_err().code, "not-a-number");
        assert_eq!(typed_band(&[]), Ok(None));
        assert_eq!(typed_band(&[0.5, 12.0]), Ok(Some([0.5, 12.0])));
        assert_eq!(typed_band(&[12.0, 0.5]).unwrap_err().code, "wrong-band");
        assert_eq!(whole_numbers(&[2.0, 4.0], HIGHEST_ORDER), Ok(vec![2, 4]));
        for wrong in [0.0, 2.5] {
            let refusal = whole_numbers(&[wrong], HIGHEST_ORDER).unwrap_err();
            assert_eq!(refusal.code, "not-whole-numbers");
        }
    }
}
