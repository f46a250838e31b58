//! List of flight conditions with the cost map, and the map's key.
//!
//! The cost map shades J, the cost of a response's mismatch (M4: docs/method.md), in its magnitude
//! and its phase part, for the held (constrained) responses in every condition. The shades are
//! interpolated between colours for the costs [`HEAT_COSTS`], with increasing contrast to the
//! background.

use egui::{Align2, Mesh, Rect, Sense, Ui, pos2, vec2};

use super::condition_rows::ConditionRows;
use super::table_menu::TableHeading;
use crate::gui::commands::command::Command;
use crate::gui::state::mapped_cost::MappedCost;
use crate::gui::state::panel_tables::TableKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{HEAT_COSTS, Palette, small};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Draws every condition with its airspeed and the mapped costs (`cost_map.rs`); a click shows the
/// condition.
pub fn conditions_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    region_ui(ui, Region::Conditions, |ui| {
        let older = if state.others_are_older() {
            " · from older settings"
        } else {
            ""
        };
        let count = format!("{}{older}", state.dataset().conditions().len());
        let heading = TableHeading {
            title: "Conditions",
            value: &count,
            kind: TableKind::Conditions,
        };
        heading.ui(ui, palette, commands);
        let map = ConditionRows::list(state, ui.available_width());
        map.heads_ui(ui, palette, commands);
        for condition in state.dataset().conditions() {
            map.row_ui(ui, condition, palette, commands);
        }
        key_ui(ui, state.display.judging.mapped_cost, palette);
    });
}

/// Key height, with the space below it \[pt\].
const KEY_HEIGHT: f32 = 38.0;

/// Draws the key that explains the shades, below the list.
fn key_ui(ui: &mut Ui, mapped: MappedCost, palette: &Palette) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), KEY_HEIGHT), Sense::hover());
    let rect = rect.with_max_y(rect.bottom() - 6.0);
    let lines = [
        rect.with_max_y(rect.center().y),
        rect.with_min_y(rect.center().y),
    ];
    let title = match mapped {
        MappedCost::Before => "J before, held responses",
        MappedCost::Own => "J of the held responses",
        MappedCost::Scheduled => "J under the schedule",
    };
    painted_text(ui, lines[0], 0.0, title, small(), palette.dim_text);
    painted_text(
        ui,
        lines[1],
        0.0,
        "left magnitude, right phase",
        small(),
        palette.dim_text,
    );
    let bar = Rect::from_min_max(
        pos2(rect.right() - 76.0, rect.top() + 5.0),
        pos2(rect.right() - 4.0, rect.top() + 11.0),
    );
    let mut mesh = Mesh::default();
    for (cost, color) in HEAT_COSTS.into_iter().zip(palette.heat) {
        let x = position_on_key(bar, cost);
        mesh.colored_vertex(pos2(x, bar.top()), color);
        mesh.colored_vertex(pos2(x, bar.bottom()), color);
    }
    for step in 0..HEAT_COSTS.len() as u32 - 1 {
        mesh.add_triangle(2 * step, 2 * step + 1, 2 * step + 2);
        mesh.add_triangle(2 * step + 1, 2 * step + 2, 2 * step + 3);
    }
    ui.painter().add(mesh);
    for cost in [0.0, 50.0, 100.0] {
        let place = pos2(position_on_key(bar, cost), lines[1].center().y);
        ui.painter().text(
            place,
            Align2::CENTER_CENTER,
            cost.to_string(),
            small(),
            palette.dim_text,
        );
    }
}

/// Returns the horizontal position of a cost on the shade bar.
fn position_on_key(bar: Rect, cost: f32) -> f32 {
    let most = HEAT_COSTS[HEAT_COSTS.len() - 1];
    bar.left() + bar.width() * cost / most
}
