//! Glyphs with their widths, and breaking text into lines.

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, GlyphId, MetadataProvider};

use gdcm_model::message_text::sanitized;

/// Fonts, each with the name by which an SVG viewer may find it. A later font supplies characters
/// that are missing in the earlier fonts.
pub const FONTS: [(&str, &[u8]); 2] = [
    ("Ubuntu", epaint_default_fonts::UBUNTU_LIGHT),
    ("Hack", epaint_default_fonts::HACK_REGULAR),
];

/// Distance from the middle of a text line down to its base line, relative to the font size.
pub(super) const HALF_LETTER_HEIGHT: f64 = 0.34;

/// A glyph in a font.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Letter {
    pub character: char,
    /// Font index in [`FONTS`].
    pub font: usize,
    /// Glyph index in that font; 0 for a character that is in neither font.
    pub glyph: u16,
    /// Distance to the next letter, relative to the font size.
    pub advance: f64,
}

/// Returns the letters in a text line; control characters are shown as escape sequences.
pub fn letters(words: &str) -> Vec<Letter> {
    let fonts: Vec<FontRef<'_>> = FONTS
        .iter()
        .filter_map(|(_, bytes)| FontRef::new(bytes).ok())
        .collect();
    sanitized(words)
        .chars()
        .filter_map(|character| letter(&fonts, character))
        .collect()
}

/// Returns a character's glyph in the first font that contains it, otherwise the first font's empty
/// box; `None` if no font can be read.
fn letter(fonts: &[FontRef<'_>], character: char) -> Option<Letter> {
    let found = fonts
        .iter()
        .enumerate()
        .find_map(|(font, face)| Some((font, face.charmap().map(character)?)));
    let (font, glyph) = found.unwrap_or((0, GlyphId::NOTDEF));
    let metrics = fonts
        .get(font)?
        .glyph_metrics(Size::new(1.0), LocationRef::default());
    let advance = f64::from(metrics.advance_width(glyph)?);
    Some(Letter {
        character,
        font,
        glyph: u16::try_from(glyph.to_u32()).ok()?,
        advance,
    })
}

/// Returns a text line's width, relative to the font size.
pub fn width(words: &str) -> f64 {
    letters(words).iter().map(|letter| letter.advance).sum()
}

/// Breaks a text between words into lines no wider than `most`, relative to the font size. A wider
/// word has its own line.
pub(super) fn wrapped(text: &str, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if width(line) + width(" ") + width(word) <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sign_that_figures_use_has_a_glyph() {
        let signs = "aZ0 Δατωφλζ → − ° ² · … – × ± ≤ ≥ ● ◆ [rad/s]";
        for letter in letters(signs) {
            assert_ne!(letter.glyph, 0, "{}", letter.character);
        }
        let arrow = letters("→")[0];
        assert_eq!(FONTS[arrow.font].0, "Hack", "the first font has no arrows");
    }

    #[test]
    fn a_letter_that_no_font_has_takes_room_all_the_same() {
        let unknown = letters("永")[0];
        assert!(unknown.glyph == 0 && unknown.advance > 0.0);
    }

    #[test]
    fn lines_are_no_wider_than_they_may_be() {
        let text = "settings that matter to the figure ".repeat(8);
        let lines = wrapped(&text, 20.0);
        assert!(lines.len() > 3 && lines.iter().all(|line| width(line) <= 20.0));
        assert_eq!(lines.join(" "), text.trim_end());
    }
}
