//! The page of keys and gestures.

use egui::{Grid, RichText, ScrollArea, Ui};

use super::command_table::{Reach, command_table};
use super::palette::Palette;
use super::state::State;

/// What the pointer does, besides what is pressed by its name.
const GESTURES: &[(&str, &str)] = &[
    ("click on a curve", "reject or restore its model"),
    ("Alt+click on a curve", "show it alone; again: show all"),
    ("drag, wheel", "move, zoom a plot; on an axis: that axis alone"),
    ("drag with the secondary button", "zoom to a box"),
    ("Shift+drag", "select the curves that a box touches, to reject or restore them at once"),
    ("double click in a plot", "on empty ground: fit it; on an axis: type its limits"),
    ("secondary click in a plot", "what can be done with the curve, or with the frequency there"),
    ("click in a legend", "hide the curves of a role, or show them"),
    ("Arrows, + −, Home", "in a plot that has the focus: move, zoom (Shift: frequencies only), fit"),
    ("Escape", "end the isolation of a model, and a selection"),
    ("drag an end of the band", "move the band of comparison"),
    ("click on a cell", "show its response; on its box, or twice: hold or free it"),
    ("click on a star", "let this model represent its bundle; again: the medoid represents"),
    ("secondary click", "on a heading: copy or save its table; on a cell or a condition: more"),
];

/// Marks in the list of conditions: what is still to do there.
const MARKS: &[(&str, &str)] = &[
    ("⚠ 3", "three models are suggested as outliers and not rejected"),
    ("k 2", "two held gains are not matched"),
    (
        "τ 1",
        "one held delay is not matched though a delay could; what needs lead is not counted, for no delay gives it",
    ),
    ("left out", "the condition does not enter the schedule"),
];

/// Every key of the table of commands, the gestures, and the marks.
pub fn keys_page_ui(ui: &mut Ui, state: &State, palette: &Palette) {
    let room = ui.ctx().content_rect().height() - 120.0;
    ScrollArea::vertical().max_height(room).auto_shrink([false, true]).show(ui, |ui| {
        let keys: Vec<(String, String)> = command_table(state)
            .into_iter()
            .filter(|entry| !entry.shortcuts.is_empty())
            .map(|entry| {
                let keys: Vec<String> = entry.shortcuts.iter().map(|keys| ui.ctx().format_shortcut(keys)).collect();
                let without_focus = if entry.reach == Reach::WithoutFocus { " *" } else { "" };
                (format!("{}{without_focus}", keys.join(", ")), entry.name)
            })
            .collect();
        let others =
            [("Tab, Shift+Tab", "next, previous control"), ("Escape", "close a form, leave a field as it was")];
        let keys = keys.iter().map(|(keys, name)| (keys.as_str(), name.as_str()));
        rows_ui(ui, "keys", keys.chain(others), palette);
        ui.label(RichText::new("* while nothing has the focus").color(palette.dim_text));
        ui.separator();
        rows_ui(ui, "gestures", GESTURES.iter().copied(), palette);
        ui.separator();
        rows_ui(ui, "marks", MARKS.iter().copied(), palette);
    });
}

fn rows_ui<'a>(ui: &mut Ui, name: &str, rows: impl Iterator<Item = (&'a str, &'a str)>, palette: &Palette) {
    let left = 170.0;
    Grid::new(name).num_columns(2).spacing([16.0, 4.0]).min_col_width(left).show(ui, |ui| {
        for (keys, meaning) in rows {
            ui.label(RichText::new(keys).strong());
            ui.scope(|ui| {
                ui.set_max_width(270.0);
                ui.add(egui::Label::new(RichText::new(meaning).color(palette.dim_text)).wrap());
            });
            ui.end_row();
        }
    });
}
