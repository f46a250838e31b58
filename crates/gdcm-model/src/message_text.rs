//! Text from a file, fit for a message.

use std::path::Path;

/// A text with its control characters and its invisible ones spelt out: a name with a line end, an escape sequence or a change of
/// the writing direction in it would break a message, or a terminal, or read as another name.
pub fn sanitized(text: &str) -> String {
    let mut words = String::with_capacity(text.len());
    for character in text.chars() {
        if is_unprintable(character) {
            words.extend(character.escape_default());
        } else {
            words.push(character);
        }
    }
    words
}

/// A path in a plain text.
pub fn sanitized_path(path: &Path) -> String {
    sanitized(&path.to_string_lossy())
}

/// Whether a character is no part of a plain text: a control character, or one that has no shape of its own, but turns the writing
/// direction, joins or parts letters, ends a line or a paragraph.
pub fn is_unprintable(character: char) -> bool {
    let is_invisible = matches!(
        character,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'
    );
    is_invisible || character.is_control()
}

/// A plain text in quotation marks, no longer than a message can bear.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", shortened(&sanitized(text)))
}

/// A message that is no longer than a reader can bear, nor any word in it: what is left out of either stands in its middle.
pub fn shortened_message(text: &str) -> String {
    /// Longer than every sentence of the program with the names of sixty columns in it, and what is kept of each end.
    const MESSAGE: [usize; 2] = [2000, 900];
    let words: Vec<String> = text
        .split(' ')
        .map(|word| without_middle(word, WORD))
        .collect();
    without_middle(&words.join(" "), MESSAGE)
}

/// A name in a message, without its middle where it is longer than the path of most files.
pub fn shortened_name(text: &str) -> String {
    without_middle(text, WORD)
}

/// Longer than the path of most files, and what is kept of each end.
const WORD: [usize; 2] = [400, 40];

/// A text of more than so many letters without its middle: so many of either end are kept.
fn without_middle(text: &str, [longest, kept]: [usize; 2]) -> String {
    let letters = text.chars().count();
    if letters <= longest {
        return text.to_owned();
    }
    let start = text.chars().take(kept);
    let end = text.chars().skip(letters - kept);
    start.chain(std::iter::once('…')).chain(end).collect()
}

/// The start of a text, no longer than a message can bear.
pub fn shortened(text: &str) -> String {
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
    fn control_characters_and_invisible_ones_are_spelt_out_and_letters_are_not() {
        assert_eq!(sanitized("a\u{1b}[31m\nΔ → °"), "a\\u{1b}[31m\\nΔ → °");
        for invisible in
            "\u{200b}\u{200f}\u{202e}\u{2028}\u{2029}\u{2066}\u{2069}\u{feff}\u{61c}\u{7f}\u{9b}"
                .chars()
        {
            assert_eq!(
                sanitized(&format!("a{invisible}b")),
                format!("a{}b", invisible.escape_default())
            );
        }
        // A letter and its accent as two characters, as some systems write file names.
        assert_eq!(sanitized("e\u{301}"), "e\u{301}");
    }

    #[test]
    fn a_word_of_seventy_thousand_letters_is_shortened_and_the_others_stay() {
        let shown = shortened_message(&format!("condition {} is odd", "x".repeat(70_000)));
        assert!(
            shown.starts_with("condition xxx")
                && shown.ends_with("xxx is odd")
                && shown.len() < 200,
            "{shown}"
        );
        assert_eq!(shortened_message("a  b"), "a  b");
    }

    #[test]
    fn a_name_of_many_short_words_is_shortened_too() {
        let shown = shortened_message(&format!(
            "condition {} is odd",
            "hover at low altitude ".repeat(4000)
        ));
        assert!(
            shown.starts_with("condition hover at") && shown.ends_with("altitude  is odd"),
            "{shown}"
        );
        assert_eq!(shown.chars().count(), 1801);
    }

    #[test]
    fn a_long_text_is_cut_between_characters() {
        assert_eq!(quoted(&"°".repeat(1000)).chars().count(), 83);
    }
}
