//! Text from a file, fit for a message.

/// A text with its control characters spelt out: a name with a line end or an escape sequence in it would break a message, or a
/// terminal.
pub fn plain(text: &str) -> String {
    let mut words = String::with_capacity(text.len());
    for character in text.chars() {
        if character.is_control() {
            words.extend(character.escape_default());
        } else {
            words.push(character);
        }
    }
    words
}

/// A plain text in quotation marks, no longer than a message can bear.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{}\"", shortened(&plain(text)))
}

/// The start of a text, no longer than a message can bear.
pub(super) fn shortened(text: &str) -> String {
    const LONGEST: usize = 80;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_spelt_out_and_letters_are_not() {
        assert_eq!(plain("a\u{1b}[31m\nΔ → °"), "a\\u{1b}[31m\\nΔ → °");
    }

    #[test]
    fn a_long_text_is_cut_between_characters() {
        assert_eq!(quoted(&"°".repeat(1000)).chars().count(), 83);
    }
}
