//! Text made safe for messages: escaped and shortened.
//!
//! | function | text | shortened |
//! |---|---|---|
//! | [`sanitized`], [`sanitized_path`] | any; a path | no |
//! | [`quoted`] | given by a user or a file | after 80 characters, in quotation marks |
//! | [`shortened`] | the same, without escapes and quotation marks | after 80 characters |
//! | [`shortened_name`] | a name or a path | in the middle, if longer than 400 characters |
//! | [`shortened_message`] | a whole message | in the middle, if longer than 2000 characters |

use std::path::Path;

/// Escapes control characters and invisible characters. A name with a line end, an escape sequence
/// or a direction change could garble a message or a terminal, or be mistaken for another name.
pub fn sanitized(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        if is_unprintable(character) {
            escaped.extend(character.escape_default());
        } else {
            escaped.push(character);
        }
    }
    escaped
}

/// Returns a path as text with unprintable characters escaped.
pub fn sanitized_path(path: &Path) -> String {
    sanitized(&path.to_string_lossy())
}

/// Returns whether a character is unprintable: a control character, or an invisible character that
/// changes the writing direction, joins or separates letters, or ends a line or a paragraph.
pub fn is_unprintable(character: char) -> bool {
    let is_invisible = matches!(
        character,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'
    );
    is_invisible || character.is_control()
}

/// Escapes unprintable characters in a text, shortens it to 80 characters, and puts it in quotation
/// marks.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", shortened(&sanitized(text)))
}

/// Shortens each long word in a message, then the message if it is still too long, by replacing the
/// middle with an ellipsis.
pub fn shortened_message(text: &str) -> String {
    /// Maximum length \[characters\]: more than any message of the program needs, even with sixty
    /// column names.
    const LONGEST: usize = 2000;
    /// Number of characters that remain at each end.
    const KEPT: usize = 900;
    let words: Vec<String> = text.split(' ').map(shortened_name).collect();
    without_middle(&words.join(" "), LONGEST, KEPT)
}

/// Shortens a long name in a message by replacing the middle with an ellipsis.
pub fn shortened_name(text: &str) -> String {
    /// Maximum length \[characters\]: longer than most file paths.
    const LONGEST: usize = 400;
    /// Number of characters that remain at each end.
    const KEPT: usize = 40;
    without_middle(text, LONGEST, KEPT)
}

/// If a text has more than `longest` characters, replaces its middle with an ellipsis; `kept`
/// characters remain at each end.
fn without_middle(text: &str, longest: usize, kept: usize) -> String {
    let letters = text.chars().count();
    if letters <= longest {
        return text.to_owned();
    }
    let start = text.chars().take(kept);
    let end = text.chars().skip(letters - kept);
    start.chain(std::iter::once('…')).chain(end).collect()
}

/// Returns the first 80 characters of a text, followed by an ellipsis if it is longer.
pub fn shortened(text: &str) -> String {
    /// Maximum length \[characters\].
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
    fn control_and_invisible_characters_are_escaped() {
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
    fn only_the_long_word_of_a_message_is_shortened() {
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
    fn a_long_message_of_short_words_is_shortened() {
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
