//! Text in markup that is HTML and well-formed XML at once.

use crate::figure_file::escaped;
use gdcm_core::message_text::sanitized;

/// Words from wherever they come as a page takes them: nothing in them is markup, nothing in them is invisible.
pub(super) fn words(text: &str) -> String {
    escaped(&sanitized(text))
}

/// An element with these words in it.
pub(super) fn element(tag: &str, text: &str) -> String {
    format!("<{tag}>{}</{tag}>\n", words(text))
}

/// An element of a class with these words in it.
pub(super) fn classed(tag: &str, class: &str, text: &str) -> String {
    format!("<{tag} class=\"{class}\">{}</{tag}>\n", words(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_from_a_file_are_no_markup_and_hide_nothing() {
        let name = "<b onclick=\"x\">V+5kt & 'roll'\u{1b}[2J\u{202e}";
        let text = "&lt;b onclick=&quot;x&quot;&gt;V+5kt &amp; 'roll'\\u{1b}[2J\\u{202e}";
        assert_eq!(words(name), text);
        assert_eq!(element("td", name), format!("<td>{text}</td>\n"));
    }

    #[test]
    fn letters_of_every_language_stay() {
        assert_eq!(words("Höhe Δφ → 重量"), "Höhe Δφ → 重量");
    }
}
