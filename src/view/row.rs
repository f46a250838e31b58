//! What panels are made of: headings, and rows of lists that fill the width.

use egui::{Align, Align2, Color32, FontId, Layout, Rect, Response, RichText, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::command::Command;
use super::palette::{Palette, SMALL_SIZE};
use super::tables::TableKind;

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

/// A text no wider than `room` \[pt\], its middle left out where it is too long. Empty where there is no room for one letter.
pub fn elided(ui: &Ui, text: &str, room: f32, size: f32) -> String {
    elided_at(ui, text, room, size, 0.5)
}

/// As [`elided`], of a name in a list: where its neighbours would be shortened to the same text, what is left out is at its
/// beginning or at its end instead.
pub fn elided_among(ui: &Ui, text: &str, neighbours: [Option<&str>; 2], room: f32, size: f32) -> String {
    /// Which part of what is kept stands before the gap.
    const HEADS: [f32; 3] = [0.5, 0.0, 1.0];
    let candidates = HEADS.map(|head| (head, elided_at(ui, text, room, size, head)));
    let is_told_apart = |(head, shown): &&(f32, String)| {
        let mut others = neighbours.iter().flatten().filter(|other| **other != text);
        others.all(|other| elided_at(ui, other, room, size, *head) != *shown)
    };
    let found = candidates.iter().find(is_told_apart).unwrap_or(&candidates[0]);
    found.1.clone()
}

fn elided_at(ui: &Ui, text: &str, room: f32, size: f32, head: f32) -> String {
    let width = |text: String| {
        let font = FontId::proportional(size);
        ui.fonts_mut(|fonts| fonts.layout_no_wrap(text, font, Color32::PLACEHOLDER).size().x)
    };
    if width(text.to_owned()) <= room {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let keeping = |kept: usize| {
        let before = (head * kept as f32) as usize;
        let after = letters.len() - (kept - before);
        letters[..before].iter().chain(&['…']).chain(&letters[after..]).collect::<String>()
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

/// A dim heading on the left, a figure on the right.
pub fn heading_ui(ui: &mut Ui, palette: &Palette, title: &str, figure: &str) -> egui::Response {
    ui.add_space(4.0);
    let shown = ui.horizontal(|ui| {
        ui.label(RichText::new(title).size(SMALL_SIZE).strong().color(palette.dim_text));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(RichText::new(figure).size(SMALL_SIZE).color(palette.dim_text));
        });
    });
    shown.response
}

/// The same over a table: the secondary button copies it or saves it, as the palette does.
pub fn table_heading_ui(
    ui: &mut Ui,
    palette: &Palette,
    (title, figure): (&str, &str),
    kind: TableKind,
    commands: &mut Vec<Command>,
) {
    let heading = heading_ui(ui, palette, title, figure);
    table_menu_ui(ui, &heading, kind, commands);
}

/// What the secondary button offers on the heading of a table.
pub fn table_menu_ui(ui: &mut Ui, heading: &egui::Response, kind: TableKind, commands: &mut Vec<Command>) {
    // No stop of the Tab key: nothing on it can be pressed.
    let response = ui.interact(heading.rect, heading.id.with("table"), Sense::CLICK);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Heading of {}", kind.name())));
    response.context_menu(|ui| {
        let choices = [("Copy table", Command::CopyTable(kind)), ("Save table as CSV…", Command::AskSaveTable(kind))];
        for (text, command) in choices {
            if ui.button(text).clicked() {
                commands.push(command);
                ui.close();
            }
        }
    });
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
            let shown = |name, other| elided_among(ui, name, [None, Some(other)], 52.0, 13.0);
            let [first, second] = [shown("ROC-300fpm", "ROC-150fpm"), shown("ROC-150fpm", "ROC-300fpm")];
            assert!(first != second && first.ends_with("00fpm"), "{first} {second}: they differ in the middle");
            assert_eq!(elided(ui, "nominal", 4.0, 13.0), "");
        });
        output.drop_without_applying_deltas();
    }
}
