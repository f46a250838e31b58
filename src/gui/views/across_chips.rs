//! Line above the plots across conditions: a chip for each role, and a colour key for airspeed.

use egui::{Align2, FontId, Pos2, Rect, Ui, pos2, vec2};

use gdcm_plot::figure::responses::line_of;
use gdcm_study::AcrossRole;

use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::plot::Role;
use crate::gui::plot::chip_row::{ChipFace, ChipRow, Sample};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Length of a curve sample in a chip \[pt\].
const SAMPLE: f32 = 18.0;
/// Position of the samples' colour on the airspeed scale, which goes from 0 for the slowest
/// condition to 255 for the fastest: the samples show the line of a role, not an airspeed.
const MID_SCALE: u8 = 128;
/// Number of colour steps in the key.
const KEY_STEPS: u8 = 24;
/// Width of the colour key \[pt\].
const KEY_WIDTH: f32 = 120.0;
/// Height of the colour key \[pt\].
const KEY_HEIGHT: f32 = 8.0;
/// Distance between the key and its texts \[pt\].
const TEXT_GAP: f32 = 8.0;
/// Width of the key with its texts \[pt\].
const KEY_ROOM: f32 = 270.0;

/// Draws the chips and, if there is room beside them, the colour key at the top of `area`; returns
/// the total height of the lines of chips \[pt\].
pub(super) fn across_chips_ui(
    ui: &Ui,
    area: Rect,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) -> f32 {
    let mut row = ChipRow::new(area, SAMPLE);
    for role in AcrossRole::ALL {
        let is_shown = state.display.frequency.across_display.roles.contains(&role);
        let face = ChipFace {
            text: role.name(),
            name: &format!("Show {}, plot of every condition", role.name()),
            sample: Some(Sample {
                style: palette.role_style(Role::OfAirspeed(MID_SCALE, line_of(role)), false),
                is_shown,
            }),
            is_lit: false,
        };
        let response = row.chip_ui(ui, &face, palette);
        let effect = if is_shown { "hide" } else { "show" };
        let response = response.on_hover_text(format!("Click: {effect} · Alt+click: alone"));
        if response.clicked() {
            let is_alone = ui.input(|input| input.modifiers.alt);
            let command = if is_alone {
                DisplayCommand::ShowAcrossAlone(role)
            } else {
                DisplayCommand::ShowAcross(role, !is_shown)
            };
            commands.push(command.into());
        }
    }
    let height = row.height();
    if row.line_end() + KEY_ROOM <= area.right() {
        let middle = area.top() + 0.5 * height - 2.0;
        paint_key(ui, pos2(area.right(), middle), state, palette);
    }
    height
}

/// Paints the colours from the slowest condition to the fastest, right-aligned at `end`.
fn paint_key(ui: &Ui, end: Pos2, state: &State, palette: &Palette) {
    let (slowest, fastest) = state.dataset().airspeed_range_kt();
    let font = FontId::proportional(SMALL_SIZE);
    let dim = palette.dim_text;
    let painter = ui.painter();
    let fastest_text = painter.text(
        end,
        Align2::RIGHT_CENTER,
        format!("{fastest:.0} kt"),
        font.clone(),
        dim,
    );
    let corner = pos2(
        fastest_text.left() - TEXT_GAP - KEY_WIDTH,
        end.y - 0.5 * KEY_HEIGHT,
    );
    let width = KEY_WIDTH / f32::from(KEY_STEPS);
    for step in 0..KEY_STEPS {
        // Wider than a step, so that no gap shows between two colours.
        let place = Rect::from_min_size(
            corner + vec2(width * f32::from(step), 0.0),
            vec2(width + 0.5, KEY_HEIGHT),
        );
        let color = palette.airspeed_color(step.saturating_mul(u8::MAX / (KEY_STEPS - 1)));
        painter.rect_filled(place, 0.0, color);
    }
    let slowest_text = painter.text(
        pos2(corner.x - TEXT_GAP, end.y),
        Align2::RIGHT_CENTER,
        format!("{slowest:.0}"),
        font.clone(),
        dim,
    );
    let beside = pos2(slowest_text.left() - TEXT_GAP, end.y);
    painter.text(beside, Align2::RIGHT_CENTER, "airspeed", font, dim);
}
