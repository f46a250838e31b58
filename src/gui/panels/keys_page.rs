//! Page about keys, pointer gestures, and the marks in the conditions list.

use egui::{Context, Grid, RichText, ScrollArea, Ui};

use crate::gui::commands::command_table::command_table;
use crate::gui::commands::entry::Reach;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Draws keys, gestures and marks.
pub fn keys_page_ui(ui: &mut Ui, state: &State, palette: &Palette) {
    let room = ui.ctx().content_rect().height() - 120.0;
    ScrollArea::vertical()
        .max_height(room)
        .min_scrolled_height(room)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            let mut keys = command_keys(ui.ctx(), state);
            keys.push(KeyRow::new("Tab, Shift+Tab", "next, previous control"));
            keys.push(KeyRow::new(
                "Escape",
                "close a form, or restore the value of a field",
            ));
            let keys = keys
                .iter()
                .map(|row| (row.keys.as_str(), row.meaning.as_str()));
            rows_ui(ui, "keys", keys, palette);
            ui.label(
                RichText::new("* only while no control has the focus").color(palette.dim_text),
            );
            ui.separator();
            rows_ui(ui, "gestures", GESTURES.iter().copied(), palette);
            ui.separator();
            rows_ui(ui, "marks", MARKS.iter().copied(), palette);
        });
}

struct KeyRow {
    keys: String,
    meaning: String,
}

impl KeyRow {
    fn new(keys: &str, meaning: &str) -> Self {
        Self {
            keys: keys.to_owned(),
            meaning: meaning.to_owned(),
        }
    }
}

/// Returns the keys in the command table; " *" marks keys that work only without focus.
fn command_keys(ctx: &Context, state: &State) -> Vec<KeyRow> {
    let mut rows = Vec::new();
    for entry in command_table(state) {
        if entry.shortcuts.is_empty() {
            continue;
        }
        let shortcuts: Vec<String> = entry
            .shortcuts
            .iter()
            .map(|keys| ctx.format_shortcut(keys))
            .collect();
        let mut keys = shortcuts.join(", ");
        if entry.reach == Reach::WithoutFocus {
            keys.push_str(" *");
        }
        rows.push(KeyRow {
            keys,
            meaning: entry.name,
        });
    }
    rows
}

fn rows_ui<'a>(
    ui: &mut Ui,
    name: &str,
    rows: impl Iterator<Item = (&'a str, &'a str)>,
    palette: &Palette,
) {
    let left = 170.0;
    Grid::new(name)
        .num_columns(2)
        .spacing([16.0, 4.0])
        .min_col_width(left)
        .show(ui, |ui| {
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

/// Pointer gestures, and keys in plots and tables.
const GESTURES: &[(&str, &str)] = &[
    ("click on a curve", "reject or restore its model"),
    ("Alt+click on a curve", "show it alone; again: show all"),
    (
        "drag, wheel",
        "pan or zoom a plot; on an axis: only that axis",
    ),
    ("right-drag", "zoom to a box"),
    (
        "Shift+drag",
        "select the curves that a box touches, to reject or restore them at once",
    ),
    (
        "double click in a plot",
        "beside the curves: fit it; on an axis: type its limits",
    ),
    (
        "pointing in a plot",
        "describe the item under the pointer in the status bar",
    ),
    (
        "right-click in a plot",
        "actions on the curve, or on the frequency there",
    ),
    (
        "click on a chip",
        "hide the curves of a role, or show them; Alt: show it alone; Shift: in front",
    ),
    (
        "1 to 9",
        "in a focused plot: like a click on the chip with that number",
    ),
    (
        "Arrows, + −, Home",
        "in a focused plot: pan, zoom (Shift: frequencies only), fit",
    ),
    (
        "Arrows, Enter, Ctrl+C",
        "in a table: move through the cells, click on one, copy the table",
    ),
    ("Escape", "show all models again and clear the selection"),
    ("drag an end of the band", "move the comparison band"),
    (
        "click on a cell",
        "show its response; on its box, or a double click: hold its net gain exactly and its \
        delay as far as possible, or release both",
    ),
    (
        "click on a star",
        "use this model as representative; again: use the medoid",
    ),
    (
        "right-click",
        "on a heading: copy or save its table; on a cell or a condition: more actions",
    ),
];

/// Marks in the conditions list.
const MARKS: &[(&str, &str)] = &[
    (
        "⚠",
        "suggested outliers, held gains or delays not matched (those that need lead count only while \
         leads are in use), or no result; the tooltip of the row lists them",
    ),
    (
        "dot or square",
        "altitude and weight of the condition: the same mark as in Net gain",
    ),
    (
        "cells",
        "J of each held response: magnitude on the left, phase on the right; faint: matched",
    ),
    (
        "number struck out",
        "the condition does not enter the schedule",
    ),
    (
        "bar at the left",
        "the condition is held out and used to validate the schedule",
    ),
];
