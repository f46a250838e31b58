//! Guided tour: notes beside regions in the window.

use egui::{
    Align2, Area, Button, Context, Frame, Id, Order, Rect, RichText, Stroke, StrokeKind, Ui, Vec2,
    vec2,
};

use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::Asks;
use crate::gui::widgets::escape_key::take_escape;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};
use crate::gui::widgets::window_regions::{Region, region_place};

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
    let (pivot, corner) = note_corner(place, window);
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

/// Note width \[pt\].
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
            faint means matched. ⚠: suggested outliers, held responses not matched, or no result.",
    },
    Step {
        region: Region::Models,
        title: "The bundle of models",
        words: "Each physics model belongs to the nominal trim or to a perturbed trim. The bar of a \
            model shows the distance from the other models, relative to the distance that the perturbation explains. The box \
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

/// Returns which corner of the note to align, and its position: right of the region, left of it, or
/// over it if neither side has room.
fn note_corner(place: Rect, window: Rect) -> (Align2, egui::Pos2) {
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
