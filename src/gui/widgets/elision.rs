//! Texts that are too long for their place: a part, usually the middle, is replaced by "…".

use egui::{Color32, FontId, Ui};

/// Returns text no wider than `room` \[pt\], with the middle elided if it is too long; empty if not
/// even a letter fits.
pub fn elided(ui: &Ui, text: &str, room: f32, size: f32) -> String {
    elided_at(ui, text, room, size, 0.5)
}

/// Like [`elided`], but elides the end of the text.
pub fn end_elided(ui: &Ui, text: &str, room: f32, size: f32) -> String {
    elided_at(ui, text, room, size, 1.0)
}

/// Like [`elided`], for a name in a list: if one of its `neighbours` would be shortened to the same
/// text, the gap moves to the beginning or to the end. If no gap tells the names apart, it stays in
/// the middle.
pub fn elided_among(
    ui: &Ui,
    text: &str,
    neighbours: [Option<&str>; 2],
    room: f32,
    size: f32,
) -> String {
    /// Shares of the kept letters before the gap, in the order tried: gap in the middle, at the
    /// beginning, at the end.
    const HEADS: [f32; 3] = [0.5, 0.0, 1.0];
    for head in HEADS {
        let shown = elided_at(ui, text, room, size, head);
        let is_unique = neighbours
            .iter()
            .flatten()
            .filter(|other| **other != text)
            .all(|other| elided_at(ui, other, room, size, head) != shown);
        if is_unique {
            return shown;
        }
    }
    elided_at(ui, text, room, size, HEADS[0])
}

/// Elides text that is wider than `room`, with the share `head` of the kept letters before the gap.
fn elided_at(ui: &Ui, text: &str, room: f32, size: f32, head: f32) -> String {
    let font = FontId::proportional(size);
    if text_width(ui, text, font.clone()) <= room {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    // The width grows with the count of kept letters, so bisection finds the largest count that
    // fits.
    let mut fits = 0;
    let mut too_wide = letters.len();
    while too_wide - fits > 1 {
        let middle = (fits + too_wide) / 2;
        let shown = with_gap(&letters, middle, head);
        if text_width(ui, &shown, font.clone()) <= room {
            fits = middle;
        } else {
            too_wide = middle;
        }
    }
    if fits == 0 {
        String::new()
    } else {
        with_gap(&letters, fits, head)
    }
}

/// Replaces all but `kept` letters by "…", placed after the share `head` of the kept letters.
fn with_gap(letters: &[char], kept: usize, head: f32) -> String {
    let before = (head * kept as f32) as usize;
    let after = letters.len() - (kept - before);
    letters[..before]
        .iter()
        .chain(&['…'])
        .chain(&letters[after..])
        .collect()
}

/// Returns as many leading comma-separated parts as fit into `room` \[pt\]; at least the first
/// part.
pub fn leading_parts<'a>(ui: &Ui, text: &'a str, room: f32, size: f32) -> &'a str {
    let mut shown = text;
    while text_width(ui, shown, FontId::proportional(size)) > room
        && let Some((leading, _)) = shown.rsplit_once(", ")
    {
        shown = leading;
    }
    shown
}

/// Returns the text width on a single line \[pt\].
pub fn text_width(ui: &Ui, text: &str, font: FontId) -> f32 {
    ui.fonts_mut(|fonts| {
        fonts
            .layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER)
            .size()
            .x
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_parts_are_dropped_first() {
        let ctx = egui::Context::default();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let text = "condition 10: 60 kt, low altitude, high weight";
            let width = |text| text_width(ui, text, FontId::proportional(12.0));
            let two = "condition 10: 60 kt, low altitude";
            assert_eq!(leading_parts(ui, text, width(text), 12.0), text);
            assert_eq!(leading_parts(ui, text, width(two) + 1.0, 12.0), two);
            assert_eq!(leading_parts(ui, text, 0.0, 12.0), "condition 10: 60 kt");
        });
        drop(output);
    }

    #[test]
    fn long_names_that_differ_only_at_one_end_differ_when_they_are_shortened() {
        let ctx = egui::Context::default();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let names = [
                "FLIGHTLAB BO105 trim V+5kt weight 2300kg",
                "FLIGHTLAB BO105 trim V+5kt weight 2400kg",
            ];
            let [first, second] = names.map(|name| elided(ui, name, 90.0, 13.0));
            assert!(
                first != second && first.starts_with("FLI") && first.ends_with("00kg"),
                "{first} {second}"
            );
            assert_eq!(elided(ui, "nominal", 90.0, 13.0), "nominal");
            let above = "ROC-300fpm";
            let below = "ROC-150fpm";
            let first = elided_among(ui, above, [None, Some(below)], 52.0, 13.0);
            let second = elided_among(ui, below, [Some(above), None], 52.0, 13.0);
            assert!(
                first != second && first.ends_with("00fpm"),
                "{first} {second}: they differ in the middle"
            );
            assert_eq!(elided(ui, "nominal", 4.0, 13.0), "");
        });
        output.drop_without_applying_deltas();
    }
}
