//! Picture of the cost map on the start page: the first conditions, without interaction.

use egui::{Align2, Rect, Ui, pos2, vec2};

use super::condition_rows::{CELL_HEIGHT, ConditionRows, HALF_CELL_WIDTH, paint_cost};
use super::cost_map::cost_of_column;
use crate::gui::state::window_state::State;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{Palette, small};

/// Maximum count of conditions in the picture.
const MOST_PICTURED: usize = 12;

/// Heading height in the picture \[pt\].
pub(super) const PICTURE_HEAD: f32 = 18.0;

/// Row height in the picture \[pt\].
const PICTURE_ROW: f32 = 17.0;

/// Vertical centre of the column headings, below the picture's top \[pt\].
const HEADING_CENTER: f32 = 8.0;

/// Centre of the flight-state symbol, from the picture's left edge \[pt\].
const SYMBOL_CENTER: f32 = 6.0;

/// Right end of the airspeed, from the picture's left edge \[pt\].
const AIRSPEED_END: f32 = 40.0;

/// Left edge of the cells in the picture \[pt\].
const PICTURE_CELLS_LEFT: f32 = 48.0;

/// Returns the height of the picture drawn by [`cost_picture_ui`] \[pt\].
pub(super) fn cost_picture_height(state: &State) -> f32 {
    let rows = state.dataset().conditions().len().min(MOST_PICTURED);
    PICTURE_HEAD + PICTURE_ROW * rows as f32
}

/// Paints the first conditions as a picture without interaction: symbols, airspeeds, and a cost for
/// each column of responses.
pub fn cost_picture_ui(ui: &Ui, area: Rect, state: &State, palette: &Palette) {
    let map = ConditionRows::picture(state, PICTURE_CELLS_LEFT, area.width());
    for (place, column) in map.columns().iter().enumerate() {
        let at = pos2(map.center(area, place), area.top() + HEADING_CENTER);
        ui.painter().text(
            at,
            Align2::CENTER_CENTER,
            &column.head,
            small(),
            palette.dim_text,
        );
    }
    for (number, condition) in state
        .dataset()
        .conditions()
        .iter()
        .take(MOST_PICTURED)
        .enumerate()
    {
        let row = Rect::from_min_size(
            area.min + vec2(0.0, PICTURE_HEAD + PICTURE_ROW * number as f32),
            vec2(area.width(), PICTURE_ROW),
        );
        let flight_state = condition.flight_state();
        map.paint_symbol(
            ui,
            pos2(row.left() + SYMBOL_CENTER, row.center().y),
            flight_state,
            palette,
        );
        let airspeed = flight_state.airspeed_kt.to_string();
        painted_text(
            ui,
            row.with_max_x(row.left() + AIRSPEED_END),
            AT_RIGHT_END,
            &airspeed,
            small(),
            palette.dim_text,
        );
        for (place, column) in map.columns().iter().enumerate() {
            let Some(column_cost) = cost_of_column(state, condition.id(), column) else {
                continue;
            };
            let at = pos2(map.center(row, place), row.center().y);
            let cell = Rect::from_center_size(at, vec2(2.0 * HALF_CELL_WIDTH, CELL_HEIGHT));
            paint_cost(ui, cell, column_cost.cost, palette);
        }
    }
}
