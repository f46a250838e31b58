//! Sanitised text for messages.

use std::path::Path;

/// Escapes control and invisible characters: a name with a line end, an escape sequence or a change
/// of writing direction could break a message or a terminal, or read as another name.
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

/// Returns a path as sanitised text.
pub fn sanitized_path(path: &Path) -> String {
    sanitized(&path.to_string_lossy())
}

/// Returns whether a character is unprintable: a control character, or one without a shape that
/// changes the writing direction, joins or separates letters, or ends a line or a paragraph.
pub fn is_unprintable(character: char) -> bool {
    let is_invisible = matches!(
        character,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'
    );
    is_invisible || character.is_control()
}

/// Returns sanitised text in quotation marks, shortened to fit a message.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", shortened(&sanitized(text)))
}

/// Shortens a message and its words to a readable length; an ellipsis replaces the middle of each.
pub fn shortened_message(text: &str) -> String {
    /// Limit above every sentence of the program with sixty column names, and length kept at each
    /// end.
    const MESSAGE: [usize; 2] = [2000, 900];
    let words: Vec<String> = text
        .split(' ')
        .map(|word| without_middle(word, WORD))
        .collect();
    without_middle(&words.join(" "), MESSAGE)
}

/// Shortens a name in a message by its middle where it is longer than most file paths.
pub fn shortened_name(text: &str) -> String {
    without_middle(text, WORD)
}

/// Limit above most file paths, and length kept at each end.
const WORD: [usize; 2] = [400, 40];

/// Removes the middle of a text above `longest` characters; `kept` characters remain at each end.
fn without_middle(text: &str, [longest, kept]: [usize; 2]) -> String {
    let letters = text.chars().count();
    if letters <= longest {
        return text.to_owned();
    }
    let start = text.chars().take(kept);
    let end = text.chars().skip(letters - kept);
    start.chain(std::iter::once('…')).chain(end).collect()
}

/// Returns the start of a text, short enough for a message.
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
        // A letter and its accent as two characters, as stored in file names by some systems.
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
