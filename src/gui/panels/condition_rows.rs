//! Condition rows: number, symbol of the flight state, airspeed, and cost-map cells, with marks for
//! open tasks (`condition_marks.rs`). The list and the rail lay them out differently;
//! `cost_picture.rs` paints some rows as a picture.
//!
//! The cost J of a response's mismatch has a magnitude and a phase part (M4: docs/method.md); a
//! cell shows both. The rail is the narrow form of the left panel.

use egui::{
    Align2, Color32, CornerRadius, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui, pos2, vec2,
};

use gdcm_method::fidelity::Cost;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::{Condition, ConditionId};
use gdcm_model::number_format::counted;
use gdcm_model::number_format::decimals;
use gdcm_plot::figure::gains::Classes;

use super::condition_marks::Marks;
use super::cost_map::{ColumnCost, CostColumn, columns, cost_of_column};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::mapped_cost::MappedCost;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, entries_ui, hint_right_of, named, tooltip_right_of};
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::list_row::RowLook;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body, medium, small};

/// Condition rows with their cost-map cells, as laid out in the current frame.
pub(super) struct ConditionRows<'a> {
    state: &'a State,
    classes: Classes,
    columns: Vec<CostColumn>,
    /// Distance between cell columns \[pt\].
    pitch: f32,
    layout: RowLayout,
    /// Whether these are the narrow rows of the rail, which do not mark the response in focus.
    is_rail: bool,
}

/// Positions in a row \[pt from the row's left edge\].
struct RowLayout {
    /// Right edge of the condition number.
    number_end: f32,
    /// Centre of the flight-state symbol; `None` without symbols.
    symbol_center: Option<f32>,
    /// Right edge of the airspeed.
    airspeed_end: f32,
    cells_left: f32,
    /// Row height \[pt\].
    height: f32,
}

/// Returns the room between the right edge of the condition number, or its symbol, and the right
/// edge of the airspeed \[pt\].
pub(super) fn airspeed_room(number_end: f32, symbol_center: Option<f32>, airspeed_end: f32) -> f32 {
    let left = match symbol_center {
        Some(center) => center + SYMBOL_REACH,
        None => number_end + AIRSPEED_GAP,
    };
    airspeed_end - left
}

/// Returns the airspeed \[kt\], rounded to whole knots if it does not fit into `room` \[pt\], where
/// it would touch the condition number.
pub(super) fn airspeed_text(ui: &Ui, airspeed_kt: f64, room: f32) -> String {
    let exact = airspeed_kt.to_string();
    if text_width(ui, &exact, body()) <= room {
        exact
    } else {
        format!("{airspeed_kt:.0}")
    }
}

const LIST: RowLayout = RowLayout {
    number_end: 20.0,
    symbol_center: Some(33.0),
    airspeed_end: 78.0,
    cells_left: 88.0,
    height: 20.0,
};

const RAIL: RowLayout = RowLayout {
    number_end: 20.0,
    symbol_center: None,
    airspeed_end: 50.0,
    cells_left: 60.0,
    height: 24.0,
};

/// Maximum distance between cell columns \[pt\].
const MOST_PITCH: f32 = 26.0;
/// Half a cell's width \[pt\].
pub(super) const HALF_CELL_WIDTH: f32 = 10.0;
/// Minimum gap between two cells \[pt\].
const LEAST_GAP: f32 = 3.0;
/// Minimum distance between the centre of a flight-state symbol and the airspeed \[pt\].
const SYMBOL_REACH: f32 = 6.5;
/// Minimum gap between the number and the airspeed of a condition \[pt\].
const AIRSPEED_GAP: f32 = 5.0;
/// Width of the frame around the cell in focus \[pt\].
const FOCUS_WIDTH: f32 = 1.5;
/// Cell height \[pt\].
pub(super) const CELL_HEIGHT: f32 = 12.0;
/// Space at a row's right end, for the mark about open tasks \[pt\].
const MARK_ROOM: f32 = 16.0;

impl<'a> ConditionRows<'a> {
    /// Lays out the list's rows with the given `width` \[pt\].
    pub(super) fn list(state: &'a State, width: f32) -> Self {
        Self::new(state, LIST, width - LIST.cells_left - MARK_ROOM)
    }

    /// Lays out the cells in rows with the given `width` \[pt\], starting at `cells_left`; the
    /// caller paints the rest.
    pub(super) fn picture(state: &'a State, cells_left: f32, width: f32) -> Self {
        let layout = RowLayout { cells_left, ..LIST };
        Self::new(state, layout, width - cells_left)
    }

    pub(super) fn columns(&self) -> &[CostColumn] {
        &self.columns
    }

    /// Lays out the cell columns within a width `room` \[pt\].
    fn new(state: &'a State, layout: RowLayout, room: f32) -> Self {
        let columns = columns(state);
        let pitch = (room / columns.len().max(1) as f32).min(MOST_PITCH);
        Self {
            state,
            classes: Classes::from_dataset(state.dataset()),
            columns,
            pitch,
            layout,
            is_rail: false,
        }
    }

    /// Lays out narrow rows with a single cell: the greatest cost of all constrained responses.
    pub(super) fn rail(state: &'a State) -> Self {
        let pairs = state.study.settings.constrained.marked().collect();
        let columns = vec![CostColumn {
            head: "J".to_owned(),
            pairs,
            is_mean: false,
        }];
        Self {
            state,
            classes: Classes::from_dataset(state.dataset()),
            columns,
            pitch: MOST_PITCH,
            layout: RAIL,
            is_rail: true,
        }
    }

    /// Returns the horizontal centre of the column with index `place`.
    pub(super) fn center(&self, row: Rect, place: usize) -> f32 {
        let first = row.left() + self.layout.cells_left + self.half_width();
        first + self.pitch * place as f32
    }

    /// Returns half a cell's width \[pt\]; cells in narrow columns shrink to leave [`LEAST_GAP`]
    /// between them.
    fn half_width(&self) -> f32 {
        HALF_CELL_WIDTH.min(0.5 * (self.pitch - LEAST_GAP))
    }

    fn cell(&self, row: Rect, place: usize) -> Rect {
        let center = pos2(self.center(row, place), row.center().y);
        Rect::from_center_size(center, vec2(2.0 * self.half_width(), CELL_HEIGHT))
    }

    /// Returns the inner edge of the frame around a cell. The frame stays within the gaps beside
    /// the cell.
    fn focus_frame(&self, cell: Rect) -> Rect {
        let gap = self.pitch - cell.width();
        let margin = (gap - FOCUS_WIDTH).clamp(0.0, 2.0);
        cell.expand2(vec2(margin, 2.0))
    }

    /// Paints a flight state's symbol as in the Net gain view: the shape shows the altitude class
    /// (a circle for the first, else a square on its corner), the fill the weight class (filled for
    /// the first).
    pub(super) fn paint_symbol(
        &self,
        ui: &Ui,
        at: Pos2,
        flight_state: &FlightState,
        palette: &Palette,
    ) {
        let is_filled = self.classes.is_first_weight(flight_state);
        let (fill, stroke) = if is_filled {
            (palette.perturbed, Stroke::NONE)
        } else {
            (Color32::TRANSPARENT, Stroke::new(1.6, palette.perturbed))
        };
        if self.classes.is_first_altitude(flight_state) {
            ui.painter()
                .circle(at, if is_filled { 4.2 } else { 3.5 }, fill, stroke);
        } else {
            let reach = if is_filled { 5.2 } else { 4.4 };
            let corners = [
                vec2(0.0, -reach),
                vec2(reach, 0.0),
                vec2(0.0, reach),
                vec2(-reach, 0.0),
            ]
            .map(|offset| at + offset);
            ui.painter()
                .add(egui::Shape::convex_polygon(corners.to_vec(), fill, stroke));
        }
    }

    /// Draws the column headings; a right-click opens the menu that selects the mapped cost.
    pub(super) fn heads_ui(&self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        let (row, heading) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::CLICK);
        for (end, words) in [
            (self.layout.number_end, "no."),
            (self.layout.airspeed_end, "kt"),
        ] {
            painted_text(
                ui,
                row.with_max_x(row.left() + end),
                AT_RIGHT_END,
                words,
                small(),
                palette.dim_text,
            );
        }
        for (place, column) in self.columns.iter().enumerate() {
            let is_focused = column.pairs.contains(&self.state.display.selection.pair);
            let (color, font) = if is_focused {
                (palette.text, medium(SMALL_SIZE))
            } else {
                (palette.dim_text, small())
            };
            let at = pos2(self.center(row, place), row.center().y);
            ui.painter()
                .text(at, Align2::CENTER_CENTER, &column.head, font, color);
        }
        let heading = named(heading, Role::Label, "Heading of the map of costs");
        heading.context_menu(|ui| {
            let entries = MappedCost::ALL.map(|mapped| {
                (
                    format!("Map J of {}", mapped.name()),
                    Command::Display(DisplayCommand::MapCost(mapped)),
                )
            });
            entries_ui(ui, entries, commands);
        });
    }

    /// Draws a condition's row; a click shows the condition.
    pub(super) fn row_ui(
        &self,
        ui: &mut Ui,
        condition: &Condition,
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let state = self.state;
        let id = condition.id();
        let marks = Marks::new(state, id);
        let flight_state = condition.flight_state();
        let name = condition_name(condition, &marks);
        let look = RowLook {
            is_selected: id == state.condition().id(),
            is_pointed: state.display.selection.hovered_condition == Some(id),
            height: self.layout.height,
        };
        let (row, response) = look.row_ui(ui, palette, &name);
        if response.contains_pointer() {
            commands.push(SelectionCommand::HoverCondition(id).into());
        }
        let color = if marks.left_out {
            palette.quiet_text
        } else {
            palette.text
        };
        painted_text(
            ui,
            row.with_max_x(row.left() + self.layout.number_end),
            AT_RIGHT_END,
            &id.to_string(),
            medium(BODY_SIZE),
            color,
        );
        let RowLayout {
            number_end,
            symbol_center,
            airspeed_end,
            ..
        } = self.layout;
        let room = airspeed_room(number_end, symbol_center, airspeed_end);
        painted_text(
            ui,
            row.with_max_x(row.left() + airspeed_end),
            AT_RIGHT_END,
            &airspeed_text(ui, flight_state.airspeed_kt, room),
            body(),
            color,
        );
        if let Some(center) = self.layout.symbol_center {
            let at = pos2(row.left() + center, row.center().y);
            self.paint_symbol(ui, at, flight_state, palette);
        }
        self.cells_ui(ui, row, &marks, palette, commands);
        marks.paint(ui, row, palette);
        response.asks(SelectionCommand::SelectCondition(id), commands);
        response.context_menu(|ui| marks.menu_ui(ui, commands));
        tooltip_right_of(&response, row, |ui| {
            marks.tooltip_ui(ui, condition, palette)
        });
    }

    /// Draws a condition's cells; a click on a cell shows the condition and the cell's response, of
    /// several the one with the greatest J.
    fn cells_ui(
        &self,
        ui: &mut Ui,
        row: Rect,
        marks: &Marks,
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let id = marks.condition;
        let mut focused = None;
        for (place, column) in self.columns.iter().enumerate() {
            let Some(worst) = cost_of_column(self.state, id, column) else {
                continue;
            };
            let cell = self.cell(row, place);
            paint_cost(ui, cell, worst.cost, palette);
            let is_focus = column.pairs.contains(&self.state.display.selection.pair)
                && id == self.state.condition().id();
            if is_focus && !self.is_rail {
                focused = Some(cell);
            }
            let response = ui.interact(cell, ui.scope_id().with(("cost", id, place)), Sense::CLICK);
            let words = cost_words(self.state, id, column, &worst);
            let response = named(response, Role::Button, words.clone());
            response.context_menu(|ui| marks.menu_ui(ui, commands));
            if hint_right_of(response, row, &words).clicked() {
                commands.extend([
                    Command::Selection(SelectionCommand::SelectCondition(id)),
                    Command::Selection(SelectionCommand::FocusPair(worst.pair)),
                ]);
            }
        }
        // Painted after all cells, so that the frame lies above its neighbours.
        if let Some(cell) = focused {
            let stroke = Stroke::new(FOCUS_WIDTH, palette.accent);
            let frame = self.focus_frame(cell);
            ui.painter()
                .rect_stroke(frame, 4.0, stroke, StrokeKind::Outside);
        }
    }
}

/// Paints a cell: the magnitude part of the cost in the left half, the phase part in the right
/// half.
pub(super) fn paint_cost(ui: &Ui, cell: Rect, cost: Cost, palette: &Palette) {
    let middle = cell.center().x;
    let halves = [
        (cell.with_max_x(middle - 0.5), cost.magnitude),
        (cell.with_min_x(middle + 0.5), cost.phase),
    ];
    for (half, cost) in halves {
        ui.painter()
            .rect_filled(half, CornerRadius::same(2), palette.heat_color(cost));
    }
}

fn cost_words(
    state: &State,
    condition: ConditionId,
    column: &CostColumn,
    worst: &ColumnCost,
) -> String {
    let magnitude = decimals(worst.cost.magnitude, 1);
    let phase = decimals(worst.cost.phase, 1);
    let name = state.dataset().pair_name(worst.pair);
    if column.is_mean {
        let responses = counted(column.pairs.len(), "response");
        return format!(
            "{responses} not held, condition {condition}: mean magnitude J \
            {magnitude}, phase J {phase}; largest: {name}"
        );
    }
    format!("{name} in condition {condition}: magnitude J {magnitude}, phase J {phase}")
}

/// Returns a row's accessible name, such as "Condition 10: 60 kt, low altitude, high weight".
pub(super) fn condition_name(condition: &Condition, marks: &Marks) -> String {
    format!(
        "Condition {}: {}{}",
        condition.id(),
        flight_state_words(condition.flight_state()),
        marks.after_name()
    )
}

/// Describes a condition, for example "60 kt, low altitude, high weight".
fn flight_state_words(state: &FlightState) -> String {
    let mut words = format!("{} kt", state.airspeed_kt);
    if let Some(altitude) = &state.altitude {
        words.push_str(&format!(", {altitude} altitude"));
    }
    if let Some(weight) = &state.weight {
        words.push_str(&format!(", {weight} weight"));
    }
    words
}

#[cfg(test)]
mod tests {
    use gdcm_io::embedded_example;
    use gdcm_study::decisions::setting_table;
    use gdcm_study::{CouplingCorrection, Study};

    use super::*;

    #[test]
    fn the_frame_of_a_cell_does_not_reach_the_cells_beside_it() {
        let mut study = Study::new(embedded_example().unwrap().dataset);
        let with_off_column = setting_table::COUPLINGS.to(CouplingCorrection::Mixing);
        for edit in [None, Some(with_off_column)] {
            if let Some(edit) = edit {
                study.apply(&edit).unwrap();
            }
            let state = State::new(study.clone(), String::new(), Vec::new());
            for width in [230.0, 248.0, 300.0] {
                let rows = ConditionRows::list(&state, width);
                let row = Rect::from_min_size(pos2(10.0, 0.0), vec2(width, 20.0));
                let last = rows.columns().len() - 1;
                for place in 0..last {
                    let reach = |cell: Rect| rows.focus_frame(cell).expand(FOCUS_WIDTH);
                    let cell = rows.cell(row, place);
                    let next = rows.cell(row, place + 1);
                    assert!(reach(cell).right() <= next.left() + 0.01, "{width}");
                    assert!(reach(next).left() >= cell.right() - 0.01, "{width}");
                }
                assert!(rows.cell(row, last).right() <= row.right() - MARK_ROOM + 1.0);
            }
        }
    }

    #[test]
    fn a_long_airspeed_is_rounded_in_the_rail_and_exact_in_the_list() {
        let ctx = egui::Context::default();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let [rail, list] = [RAIL, LIST].map(|layout| {
                airspeed_room(layout.number_end, layout.symbol_center, layout.airspeed_end)
            });
            assert_eq!(airspeed_text(ui, 120.5, rail), "120");
            assert_eq!(airspeed_text(ui, 120.5, list), "120.5");
            assert_eq!(airspeed_text(ui, 140.0, rail), "140");
        });
        output.drop_without_applying_deltas();
    }
}
