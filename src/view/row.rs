//! A selectable row that fills the width: one line of a list.

use egui::{Align2, Color32, FontId, Rect, Response, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::palette::Palette;

/// Height of a row \[pt\].
pub const ROW_HEIGHT: f32 = 20.0;

/// Allocates a row that can be clicked, paints its background, and names it for screen readers and tests.
pub fn row_ui(ui: &mut Ui, palette: &Palette, selected: bool, pointed: bool, name: &str) -> (Rect, Response) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, ui.is_enabled(), selected, name));
    let fill = if selected {
        palette.selected
    } else if response.hovered() || pointed || response.has_focus() {
        palette.raised
    } else {
        Color32::TRANSPARENT
    };
    ui.painter().rect_filled(rect, 3.0, fill);
    (rect, response)
}

/// Where a row has room for a text \[pt from the row's left edge\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    pub left: f32,
    pub right: f32,
}

/// Paints text into its room, shortened in the middle where it is too long; nothing where there is no room for a letter of it.
pub fn row_text_within(ui: &Ui, row: Rect, room: Room, text: &str, size: f32, color: Color32) {
    let shown = elided(ui, text, room.right - room.left, size);
    if !shown.is_empty() {
        row_text(ui, row, room.left, &shown, size, color);
    }
}

/// A text no wider than `room` \[pt\]: names that differ only at their end, or only at their beginning, differ still when the
/// middle is left out. Empty where there is no room for one letter.
pub fn elided(ui: &Ui, text: &str, room: f32, size: f32) -> String {
    let width = |text: String| {
        let font = FontId::proportional(size);
        ui.fonts_mut(|fonts| fonts.layout_no_wrap(text, font, Color32::PLACEHOLDER).size().x)
    };
    if width(text.to_owned()) <= room {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let keeping = |kept: usize| {
        let (head, tail) = (kept / 2, kept - kept / 2);
        letters[..head].iter().chain(&['…']).chain(&letters[letters.len() - tail..]).collect::<String>()
    };
    // The widths grow with what is kept: the greatest that fits is found by halving.
    let (mut fits, mut too_wide) = (0, letters.len());
    while too_wide - fits > 1 {
        let middle = (fits + too_wide) / 2;
        if width(keeping(middle)) <= room {
            fits = middle;
        } else {
            too_wide = middle;
        }
    }
    if fits == 0 { String::new() } else { keeping(fits) }
}

/// Paints text at `x` points from the row's left edge (from its right edge where negative), centred in height.
pub fn row_text(ui: &Ui, row: Rect, x: f32, text: &str, size: f32, color: Color32) -> Rect {
    let (left, align) =
        if x < 0.0 { (row.right() + x, Align2::RIGHT_CENTER) } else { (row.left() + x, Align2::LEFT_CENTER) };
    ui.painter().text(pos2(left, row.center().y), align, text, FontId::proportional(size), color)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_that_differ_only_at_one_end_differ_when_they_are_shortened() {
        let ctx = egui::Context::default();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let names = ["FLIGHTLAB BO105 trim V+5kt weight 2300kg", "FLIGHTLAB BO105 trim V+5kt weight 2400kg"];
            let [first, second] = names.map(|name| elided(ui, name, 90.0, 13.0));
            assert!(first != second && first.starts_with("FLI") && first.ends_with("00kg"), "{first} {second}");
            assert_eq!(elided(ui, "nominal", 90.0, 13.0), "nominal");
            assert_eq!(elided(ui, "nominal", 4.0, 13.0), "");
        });
        output.drop_without_applying_deltas();
    }
}
