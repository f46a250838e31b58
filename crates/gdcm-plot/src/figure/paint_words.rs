//! Paints the texts in a panel: labels on rules and guides, and notes.

use super::drawing::{Anchor, Area, Color, Shape, Text};
use super::layout::{SMALL_LINE, SMALL_PT};
use super::letters::{HALF_LETTER_HEIGHT, width};
use super::marks::{Along, Guide, Mark, Note, Place, Rule};
use super::placed::Placed;

/// Space between a rule and its label, and between a note and the left or right edge of the
/// frame \[pt\].
const GAP: f64 = 2.0;
/// Margin of a rule label's background to the left and to the right of the text \[pt\].
const GROUND_MARGIN: f64 = 1.0;
/// Distance from the base line of a rule's label up to the upper edge of its background, relative
/// to the font size.
const GROUND_ASCENT: f64 = 0.75;
/// Height of the background of a rule's label, relative to the font size.
const GROUND_HEIGHT: f64 = 0.8;
/// Space between a guide's last visible point and its label \[pt\].
const GUIDE_GAP: f64 = 1.5;
/// Space between a note at the lower left and the lower edge of the frame \[pt\].
const LOWER_GAP: f64 = 2.5;
/// Amount by which a note at the upper right is moved towards the upper edge of the frame \[pt\].
const UPPER_RISE: f64 = 1.0;

/// Paints a rule's label at its upper or right end, on a white background that hides curves behind
/// it; returns nothing without a label or if the rule lies outside the frame.
pub(super) fn rule_label(placed: &Placed<'_>, rule: &Rule) -> Vec<Shape> {
    if rule.label.is_empty() {
        return Vec::new();
    }
    let Some([_, end]) = placed.across(rule.along, rule.at) else {
        return Vec::new();
    };
    if !placed.shows(end) {
        return Vec::new();
    }
    let [x, y] = match rule.along {
        Along::X => [end[0] - GAP, end[1] + SMALL_LINE],
        Along::Y => [end[0] - GAP, end[1] - GAP],
    };
    let length = SMALL_PT * width(&rule.label);
    let ground = Area::new(
        x - length - GROUND_MARGIN,
        y - GROUND_ASCENT * SMALL_PT,
        length + 2.0 * GROUND_MARGIN,
        GROUND_HEIGHT * SMALL_PT,
    );
    let text = Text::new([x, y], &rule.label, SMALL_PT)
        .anchored(Anchor::End)
        .colored(Color::DIM);
    vec![
        Shape::rectangle(ground, Some(Color::WHITE), None),
        Shape::Text(text),
    ]
}

/// Paints a guide's label, or a note; `None` for other marks, for a guide that has no label or is
/// not visible, and for a note that does not fit.
pub(super) fn mark_words(placed: &Placed<'_>, mark: &Mark) -> Option<Shape> {
    let text = match mark {
        Mark::Guide(guide) => guide_label(placed, guide)?,
        Mark::Note(note) => note_text(placed, note)?,
        _ => return None,
    };
    Some(Shape::Text(text.colored(Color::DIM)))
}

/// Returns a guide's label, to the lower right of its last visible point; `None` without a label or
/// a visible point.
fn guide_label(placed: &Placed<'_>, guide: &Guide) -> Option<Text> {
    if guide.label.is_empty() {
        return None;
    }
    let [x, y] = guide
        .points
        .iter()
        .rev()
        .filter_map(|point| placed.at(*point))
        .find(|position| placed.shows(*position))?;
    let size_pt = placed.font_size_pt;
    Some(Text::new(
        [x + GUIDE_GAP, y + size_pt],
        &guide.label,
        size_pt,
    ))
}

/// Returns a note's text; `None` at a value that an axis cannot show, or for a horizontal text that
/// is wider than the distance between two names.
fn note_text(placed: &Placed<'_>, note: &Note) -> Option<Text> {
    let size_pt = placed.font_size_pt;
    match note.at {
        Place::Value { x, y, upright } => {
            let is_named = placed.panel.x.names.is_some();
            let slot = placed.frame.width / placed.x.range.width();
            if is_named && !upright && size_pt * width(&note.text) > slot {
                // A wider text would overlap the text at the next name.
                return None;
            }
            let [x, y] = placed.at([x, y])?;
            let place = if upright {
                [x + HALF_LETTER_HEIGHT * size_pt, y]
            } else {
                [x, y + HALF_LETTER_HEIGHT * size_pt]
            };
            let text = Text::new(place, &note.text, size_pt);
            Some(text.anchored(Anchor::Middle).upright(upright))
        }
        Place::UpperRight => {
            let [x, y] = placed.frame.at(1.0, 1.0);
            let place = [x - GAP, y + SMALL_LINE - UPPER_RISE];
            Some(Text::new(place, &note.text, size_pt).anchored(Anchor::End))
        }
        Place::LowerLeft => {
            let [x, y] = placed.frame.at(0.0, 0.0);
            Some(Text::new([x + GAP, y - LOWER_GAP], &note.text, size_pt))
        }
    }
}
