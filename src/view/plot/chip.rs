//! Small buttons over a plot that say what holds for it now, and end it.

use egui::{Align2, CursorIcon, Rect, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};

use super::axes::caption_font;
use crate::view::palette::Palette;

/// What holds for a plot now, and what a click on it does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chip {
    /// What it says: "Only V+10kt ×".
    pub text: String,
    /// What a click does.
    pub hint: String,
}

/// Draws chips along the upper edge of `frame`, from left to right; gives the index of the one clicked. `plot` tells them from those
/// of other plots.
pub(super) fn chips_ui(ui: &Ui, (frame, plot): (Rect, &str), chips: &[Chip], palette: &Palette) -> Option<usize> {
    let mut clicked = None;
    let mut left = frame.left() + 8.0;
    for (index, chip) in chips.iter().enumerate() {
        let painter = ui.painter().with_clip_rect(frame);
        let galley = painter.layout_no_wrap(chip.text.clone(), caption_font(), palette.text);
        let size = galley.size() + vec2(14.0, 6.0);
        let place = Align2::LEFT_TOP.anchor_size(pos2(left, frame.top() + 7.0), size);
        left = place.right() + 5.0;
        let response = ui.interact(place, ui.scope_id().with(("chip", index)), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("{}{plot}", chip.text)));
        let is_meant = response.hovered() || response.has_focus();
        let outline = if is_meant { palette.accent } else { palette.line };
        painter.rect(place, 0.5 * size.y, palette.selected, Stroke::new(1.0, outline), StrokeKind::Inside);
        painter.galley(place.min + vec2(7.0, 3.0), galley, palette.text);
        if response.on_hover_cursor(CursorIcon::PointingHand).on_hover_text(&chip.hint).clicked() {
            clicked = Some(index);
        }
    }
    clicked
}
