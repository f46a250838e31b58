//! Paints the texts in a panel: labels on rules and guides, and notes.

use super::drawing::{Anchor, Area, Color, Shape, Text};
use super::layout::{SMALL_LINE, SMALL_PT};
use super::letters::{HALF_LETTER_HEIGHT, width};
use super::marks::{Along, Guide, Mark, Note, Place, Rule};
use super::placed::Placed;

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
        Along::X => [end[0] - 2.0, end[1] + SMALL_LINE],
        Along::Y => [end[0] - 2.0, end[1] - 2.0],
    };
    let length = SMALL_PT * width(&rule.label);
    let ground = Area::new(
        x - length - 1.0,
        y - 0.75 * SMALL_PT,
        length + 2.0,
        0.8 * SMALL_PT,
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
    Some(Text::new([x + 1.5, y + size_pt], &guide.label, size_pt))
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
            let place = [x - 2.0, y + SMALL_LINE - 1.0];
            Some(Text::new(place, &note.text, size_pt).anchored(Anchor::End))
        }
        Place::LowerLeft => {
            let [x, y] = placed.frame.at(0.0, 0.0);
            Some(Text::new([x + 2.0, y - 2.5], &note.text, size_pt))
        }
    }
}
