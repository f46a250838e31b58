//! Help on the window: keys, gestures and marks, and the guided tour.

use egui::{
    Align2, Area, Button, Context, Frame, Grid, Id, Order, Rect, RichText, ScrollArea, Stroke,
    StrokeKind, Ui, Vec2, vec2,
};

use crate::gui::commands::command::Command;
use crate::gui::commands::command_table::command_table;
use crate::gui::commands::entry::Reach;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::Asks;
use crate::gui::widgets::focus::{Region, region_place, take_escape};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Width of a note \[pt\].
const WIDTH: f32 = 300.0;

/// Step in the guided tour.
struct Step {
    region: Region,
    title: &'static str,
    words: &'static str,
}

const STEPS: [Step; 5] = [
    Step {
        region: Region::Conditions,
        title: "Flight conditions",
        words: "Click a condition, or press Up or Down, to show it. The map beside the list shows \
            the remaining J of each held response: magnitude on the left, phase on the right; \
            pale means matched. ⚠: models are suggested as outliers.",
    },
    Step {
        region: Region::Models,
        title: "The bundle of models",
        words: "Each physics model belongs to a perturbed trim. Its bar shows the distance from \
            the other models, relative to the distance that the perturbation explains. The box \
            rejects or restores the model, the star makes it the representative.",
    },
    Step {
        region: Region::Plots,
        title: "The curves",
        words: "Red: nominal model. Blue: perturbed models. Amber: models identified from flight. \
                Green: corrected model. A click on a curve rejects or restores its model.",
    },
    Step {
        region: Region::Matrix,
        title: "Held responses",
        words: "Each cell is a response: the gain and the delay that would match it, underlined \
            by the magnitude and phase parts of J. In filled cells the gain is held exactly; the \
            box, or the space bar, holds or releases the response.",
    },
    Step {
        region: Region::Verdict,
        title: "The verdict",
        words: "Whether gain and phase of the held responses are matched, here and in all \
            conditions, and the next step. Green: both are matched. Ctrl+Z undoes any decision; \
            Ctrl+K finds every command.",
    },
];

/// Draws the current step, if any: a ring around its region, and a note beside it.
pub fn tour_ui(ctx: &Context, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(number) = state.tour else {
        return;
    };
    let Some(step) = STEPS.get(number) else {
        return;
    };
    // The notes refer to the panels, so the tour waits while these are hidden.
    if state.forms.shown.is_some() || state.assembling.is_some() || state.on_start_page {
        return;
    }
    let window = ctx.content_rect();
    let place = region_place(ctx, step.region)
        .unwrap_or(window)
        .intersect(window.shrink(3.0));
    let id = Id::unique("guided tour");
    let painter = ctx.layer_painter(egui::LayerId::new(Order::Middle, id));
    painter.rect_stroke(
        place,
        4.0,
        Stroke::new(2.0, palette.warning),
        StrokeKind::Outside,
    );
    let (pivot, corner) = beside(place, window);
    Area::new(id.with("note"))
        .order(Order::Foreground)
        .pivot(pivot)
        .fixed_pos(corner)
        .show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(WIDTH);
                note_ui(ui, number, step, palette, commands);
            });
        });
    if take_escape(ctx) {
        commands.push(LayoutCommand::ShowTourStep(None).into());
    }
}

fn note_ui(
    ui: &mut Ui,
    number: usize,
    step: &Step,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(step.title).strong());
        let count = format!("{} of {}", number + 1, STEPS.len());
        ui.label(
            RichText::new(count)
                .size(SMALL_SIZE)
                .color(palette.dim_text),
        );
    });
    ui.label(step.words);
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        let is_last = number + 1 == STEPS.len();
        let end = LayoutCommand::ShowTourStep(None);
        let previous = LayoutCommand::ShowTourStep(Some(number.saturating_sub(1)));
        let next = LayoutCommand::ShowTourStep(Some(number + 1));
        if is_last {
            ui.button("End the tour").asks(end.clone(), commands);
        } else {
            ui.button("Next step").asks(next, commands);
        }
        ui.add_enabled(number > 0, Button::new("Previous step"))
            .asks(previous, commands);
        if !is_last {
            ui.button("Skip the tour").asks(end, commands);
        }
    });
}

/// Returns the corner of the note to be aligned, and its position: right of the region, left of it,
/// or over it if the region takes the whole width.
fn beside(place: Rect, window: Rect) -> (Align2, egui::Pos2) {
    const GAP: Vec2 = vec2(12.0, 0.0);
    let room = WIDTH + 40.0;
    if window.right() - place.right() > room {
        (Align2::LEFT_TOP, place.right_top() + GAP)
    } else if place.left() - window.left() > room {
        // A region near the foot of the window has no space below it, so the note grows upwards.
        let is_low = place.top() > window.center().y;
        if is_low {
            (Align2::RIGHT_BOTTOM, place.left_bottom() - GAP)
        } else {
            (Align2::RIGHT_TOP, place.left_top() - GAP)
        }
    } else {
        (Align2::CENTER_CENTER, place.center())
    }
}

/// Pointer gestures, except clicks on named controls.
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
        "models are suggested as outliers, or a held gain or a held delay that needs no lead is not \
         matched; the tooltip of the row counts them",
    ),
    (
        "dot or square",
        "its altitude and weight: the same mark as in Net gain",
    ),
    (
        "cells",
        "J of each held response: magnitude on the left, phase on the right; pale: matched",
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

/// Keys and their meaning.
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

/// Returns the keys of the command table; " *" marks keys that work only without focus.
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
