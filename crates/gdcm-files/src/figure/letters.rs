//! The letters that figures are written in: which font has them, and how wide they are.
//!
//! These are the fonts that the window is written in: the first is used wherever it has a letter, the others in turn.

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, GlyphId, MetadataProvider};

/// The fonts, with the name that a reader of SVG may know them by.
pub const FONTS: [(&str, &[u8]); 2] =
    [("Ubuntu", epaint_default_fonts::UBUNTU_LIGHT), ("Hack", epaint_default_fonts::HACK_REGULAR)];

/// One letter as a font draws it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Letter {
    /// The character.
    pub character: char,
    /// Index of the font in [`FONTS`].
    pub font: usize,
    /// Number of the glyph in that font; 0 stands for a letter that no font has.
    pub glyph: u16,
    /// How far the next letter is, as a part of the size.
    pub advance: f64,
}

/// The letters of a line of words, in their order.
pub fn letters(words: &str) -> Vec<Letter> {
    let fonts: Vec<FontRef<'_>> = FONTS.iter().filter_map(|(_, bytes)| FontRef::new(bytes).ok()).collect();
    words
        .chars()
        .filter(|character| !character.is_control())
        .filter_map(|character| letter(&fonts, character))
        .collect()
}

fn letter(fonts: &[FontRef<'_>], character: char) -> Option<Letter> {
    let found = fonts.iter().enumerate().find_map(|(font, face)| Some((font, face.charmap().map(character)?)));
    let (font, glyph) = found.unwrap_or((0, GlyphId::NOTDEF));
    let metrics = fonts.get(font)?.glyph_metrics(Size::new(1.0), LocationRef::default());
    let advance = f64::from(metrics.advance_width(glyph)?);
    Some(Letter { character, font, glyph: u16::try_from(glyph.to_u32()).ok()?, advance })
}

/// Width of a line of words as a part of the size of its letters.
pub fn width(words: &str) -> f64 {
    letters(words).iter().map(|letter| letter.advance).sum()
}

/// A text broken between words into lines no wider than `most`, a part of the size of its letters.
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
        for letter in letters("aZ0 Δατωφλζ → − ° ² · … – × ± ≤ ≥ ● ◆ [rad/s]") {
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
