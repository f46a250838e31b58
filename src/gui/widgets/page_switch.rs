//! Segmented control that changes the page in a view, the dock or a drawer; every page change uses
//! this control.

use egui::{Align2, Rect, Role, Sense, Stroke, StrokeKind, Ui, pos2, vec2};

use super::choices::PageWords;
use super::controls::named_switch;
use super::elision::text_width;
use super::palette::{BODY_SIZE, Palette, medium};

/// Page offered by the segmented control.
#[derive(Clone, Copy, Debug)]
pub struct PageTab {
    pub words: PageWords,
    pub is_shown: bool,
}

/// Control height \[pt\].
const HEIGHT: f32 = 24.0;
/// Space on each side of a segment's text \[pt\].
const SEGMENT_PADDING: f32 = 11.0;
/// Distance between the frame and the selected segment \[pt\].
const INSET: f32 = 2.0;

/// Returns the width of the segments with these names \[pt\].
pub fn page_switch_width<'a>(ui: &Ui, names: impl IntoIterator<Item = &'a str>) -> f32 {
    let mut width = 2.0 * INSET;
    for name in names {
        width += text_width(ui, name, medium(BODY_SIZE)) + 2.0 * SEGMENT_PADDING;
    }
    width
}

/// Draws a row of joined segments, one for each page; returns the index of a clicked segment unless
/// it is already selected. A segment's accessible name is "Page NAME".
///
/// Draws nothing for fewer than two pages.
pub fn page_switch_ui(ui: &mut Ui, tabs: &[PageTab], palette: &Palette) -> Option<usize> {
    if tabs.len() < 2 {
        return None;
    }
    let font = medium(BODY_SIZE);
    let widths: Vec<f32> = tabs
        .iter()
        .map(|tab| text_width(ui, tab.words.short_name, font.clone()) + 2.0 * SEGMENT_PADDING)
        .collect();
    let size = vec2(widths.iter().sum::<f32>() + 2.0 * INSET, HEIGHT);
    let (frame, _) = ui.allocate_exact_size(size, Sense::hover());
    ui.painter().rect(
        frame,
        6.0,
        palette.background,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
    let mut clicked = None;
    let mut left = frame.left() + INSET;
    for (index, (tab, width)) in tabs.iter().zip(widths).enumerate() {
        let place = Rect::from_min_size(
            pos2(left, frame.top() + INSET),
            vec2(width, HEIGHT - 2.0 * INSET),
        );
        left = place.right();
        let id = ui.scope_id().with(("page", tab.words.name));
        let response = ui.interact(place, id, Sense::click());
        if tab.is_shown || response.hovered() {
            ui.painter().rect_filled(place, 4.5, palette.raised);
        }
        let color = if tab.is_shown {
            palette.text
        } else {
            palette.dim_text
        };
        ui.painter().text(
            place.center(),
            Align2::CENTER_CENTER,
            tab.words.short_name,
            font.clone(),
            color,
        );
        if response.has_focus() {
            let stroke = Stroke::new(1.0, palette.accent);
            ui.painter()
                .rect_stroke(place, 4.5, stroke, StrokeKind::Inside);
        }
        let name = format!("Page {}", tab.words.name);
        let response = named_switch(response, Role::Button, tab.is_shown, name)
            .on_hover_text(tab.words.purpose);
        if response.clicked() && !tab.is_shown {
            clicked = Some(index);
        }
    }
    clicked
}

/// Returns the index of the page `by` places after the shown page, wrapping around; `None` for
/// fewer than two pages.
pub fn neighbouring_page(shown: &[bool], by: isize) -> Option<usize> {
    if shown.len() < 2 {
        return None;
    }
    let here = shown.iter().position(|is_shown| *is_shown).unwrap_or(0);
    let next = (here as isize + by).rem_euclid(shown.len() as isize);
    Some(next as usize)
}

#[cfg(test)]
mod tests {
    use super::neighbouring_page;

    #[test]
    fn the_page_after_the_last_is_the_first() {
        let last_of_three = [false, false, true];
        assert_eq!(neighbouring_page(&last_of_three, 1), Some(0));
        assert_eq!(neighbouring_page(&last_of_three, -1), Some(1));
        assert_eq!(neighbouring_page(&[true, false, false], -1), Some(2));
    }

    #[test]
    fn a_single_page_has_no_neighbour() {
        assert_eq!(neighbouring_page(&[true], 1), None);
        assert_eq!(neighbouring_page(&[], -1), None);
    }
}
