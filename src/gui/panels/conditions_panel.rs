//! Flight conditions with a map of the remaining costs; as a wide list, or as a rail.

use egui::{
    Align2, Color32, CornerRadius, Mesh, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui, pos2,
    vec2,
};

use gdcm_method::fidelity::Cost;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::{BundleKind, Condition, ConditionId};
use gdcm_model::number_format::decimals;
use gdcm_plot::figure::gains::Classes;

use super::condition_marks::Marks;
use super::cost_map::{ColumnCost, CostColumn, columns, cost_of_column};
use super::table_menu::{TableHeading, table_menu_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::mapped_cost::MappedCost;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::tables::TableKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, RowLook, entries_ui, named, painted_text};
use crate::gui::widgets::focus::{Region, region_ui};
use crate::gui::widgets::palette::{
    BODY_SIZE, HEAT_COSTS, Palette, SMALL_SIZE, body, medium, small,
};

/// Right edge of the condition number, centre of the mark, right edge of the airspeed \[pt from the
/// row's left edge\].
const PLACES: [f32; 3] = [20.0, 33.0, 70.0];
/// Left edge of the map, and its maximum column spacing \[pt\].
const MAP: [f32; 2] = [88.0, 26.0];
/// Half the width and height of a cell \[pt\].
const HALF_CELL: [f32; 2] = [10.0, 12.0];
/// Row heights of list and rail \[pt\].
const ROWS: [f32; 2] = [20.0, 24.0];

/// Draws every condition with its airspeed and the remaining cost of its constrained responses; a
/// click shows the condition.
pub fn conditions_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    region_ui(ui, Region::Conditions, |ui| {
        let older = if state.others_are_older() {
            " · of older settings"
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
        let map = Map::new(state, MAP[0], ui.available_width() - MAP[0] - 16.0);
        map.heads_ui(ui, palette, commands);
        for condition in state.dataset().conditions() {
            map.row_ui(ui, condition, palette, commands);
        }
        map.key_ui(ui, palette);
    });
}

/// Draws the list as a narrow strip: number, airspeed, constrained response with the highest cost;
/// buttons open the physics and the identified models.
pub fn rail_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = 0.0;
    pin_ui(ui, palette, commands);
    region_ui(ui, Region::Conditions, |ui| {
        let (head, heading) =
            ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
        for (right, words) in [(20.0, "no."), (50.0, "kt"), (64.0, "J")] {
            let upto = head.with_max_x(head.left() + right);
            painted_text(ui, upto, -0.01, words, small(), palette.dim_text);
        }
        table_menu_ui(ui, &heading, TableKind::Conditions, commands);
        let map = Map::rail(state);
        for condition in state.dataset().conditions() {
            map.row_ui(ui, condition, palette, commands);
        }
    });
    ui.add_space(12.0);
    region_ui(ui, Region::Models, |ui| {
        let suggested = match state.shown() {
            Some(shown) => state.open_suggestions(shown).len(),
            None => 0,
        };
        let physics = BundleButton {
            name: "Models",
            kept: state.kept_words(BundleKind::Physics),
            suggested,
            sheet: Sheet::Models,
        };
        physics.ui(ui, palette, commands);
        let identified = BundleButton {
            name: "Identified",
            kept: state.kept_words(BundleKind::Identified),
            suggested: 0,
            sheet: Sheet::Identified,
        };
        identified.ui(ui, palette, commands);
    });
}

/// Draws the pin that replaces the rail with the full panel.
fn pin_ui(ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
    let (rect, response) = ui.allocate_exact_size(vec2(32.0, 32.0), Sense::click());
    let symbol = Rect::from_center_size(rect.center(), vec2(14.0, 12.0));
    let color = if response.hovered() {
        palette.text
    } else {
        palette.dim_text
    };
    ui.painter()
        .rect_stroke(symbol, 2.0, Stroke::new(1.3, color), StrokeKind::Inside);
    ui.painter().vline(
        symbol.left() + 5.0,
        symbol.y_range(),
        Stroke::new(1.3, color),
    );
    let response = named(response, Role::Button, "Show the left panel");
    response
        .on_hover_text("Shows conditions, cost map and models beside the plots (Ctrl+B)")
        .asks(LayoutCommand::ShowLeft(true), commands);
}

/// Button in the rail that opens a bundle in a sheet.
struct BundleButton {
    name: &'static str,
    /// "16 of 19".
    kept: String,
    /// Models suggested as outliers and not rejected.
    suggested: usize,
    sheet: Sheet,
}

impl BundleButton {
    fn ui(self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        let height = if self.suggested > 0 { 58.0 } else { 42.0 };
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
        if response.hovered() {
            ui.painter().rect_filled(rect, 4.0, palette.raised);
        }
        let first = Rect::from_min_size(rect.min + vec2(4.0, 4.0), vec2(rect.width(), 17.0));
        let second = first.translate(vec2(0.0, 17.0));
        let third = first.translate(vec2(0.0, 34.0));
        painted_text(ui, first, 0.0, self.name, medium(BODY_SIZE), palette.text);
        painted_text(ui, second, 0.0, &self.kept, small(), palette.dim_text);
        if self.suggested > 0 {
            let words = format!("{} suggested", self.suggested);
            painted_text(ui, third, 0.0, &words, small(), palette.warning);
        }
        named(
            response,
            Role::Button,
            format!("Open the list: {}", self.name),
        )
        .on_hover_text(format!("{}: {} kept", self.name, self.kept))
        .asks(LayoutCommand::ShowSheet(Some(self.sheet)), commands);
    }
}

/// "60 kt, low altitude, high weight".
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

/// Columns of the cost map and their positions in the current frame.
struct Map<'a> {
    state: &'a State,
    classes: Classes,
    columns: Vec<CostColumn>,
    /// Left edge \[pt from the row's left edge\] and spacing \[pt\] of the columns.
    left: f32,
    pitch: f32,
    is_rail: bool,
}

impl<'a> Map<'a> {
    /// Lays out the columns within a width of `room` \[pt\], beginning at `left`.
    fn new(state: &'a State, left: f32, room: f32) -> Self {
        let columns = columns(state);
        let pitch = (room / columns.len().max(1) as f32).min(MAP[1]);
        Self {
            state,
            classes: Classes::from_dataset(state.dataset()),
            columns,
            left,
            pitch,
            is_rail: false,
        }
    }

    fn rail(state: &'a State) -> Self {
        let pairs = state.study.settings.constrained.marked().collect();
        let columns = vec![CostColumn {
            head: "J".to_owned(),
            pairs,
            is_mean: false,
        }];
        Self {
            columns,
            left: 60.0,
            pitch: MAP[1],
            is_rail: true,
            ..Self::new(state, 0.0, 0.0)
        }
    }

    /// Returns a column's horizontal centre.
    fn center(&self, row: Rect, place: usize) -> f32 {
        row.left() + self.left + self.pitch * place as f32 + HALF_CELL[0]
    }

    /// Paints the mark of a condition as in the Net gain view: the shape shows the altitude class,
    /// the fill the weight class.
    fn paint_mark(&self, ui: &Ui, at: Pos2, flight_state: &FlightState, palette: &Palette) {
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

    fn heads_ui(&self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        let (row, heading) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::CLICK);
        for (end, words) in [(PLACES[0], "no."), (PLACES[2], "kt")] {
            painted_text(
                ui,
                row.with_max_x(row.left() + end),
                -0.01,
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

    fn row_ui(
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
        let name = format!(
            "Condition {id}: {}{}",
            flight_state_words(flight_state),
            marks.after_name()
        );
        let look = RowLook {
            is_selected: id == state.condition().id(),
            is_pointed: state.display.selection.hovered_condition == Some(id),
            height: ROWS[usize::from(self.is_rail)],
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
        let places = if self.is_rail {
            [20.0, 0.0, 50.0]
        } else {
            PLACES
        };
        painted_text(
            ui,
            row.with_max_x(row.left() + places[0]),
            -0.01,
            &id.to_string(),
            medium(BODY_SIZE),
            color,
        );
        painted_text(
            ui,
            row.with_max_x(row.left() + places[2]),
            -0.01,
            &flight_state.airspeed_kt.to_string(),
            body(),
            color,
        );
        if !self.is_rail {
            self.paint_mark(
                ui,
                pos2(row.left() + places[1], row.center().y),
                flight_state,
                palette,
            );
        }
        self.cells_ui(ui, row, &marks, palette, commands);
        marks.paint(ui, row, palette);
        response.asks(SelectionCommand::SelectCondition(id), commands);
        response.context_menu(|ui| marks.menu_ui(ui, commands));
        response.on_hover_ui(|ui| marks.tooltip_ui(ui, condition, palette));
    }

    /// Draws a condition's cells; a click on a cell shows the condition and the response.
    fn cells_ui(
        &self,
        ui: &mut Ui,
        row: Rect,
        marks: &Marks,
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let id = marks.condition;
        for (place, column) in self.columns.iter().enumerate() {
            let Some(worst) = cost_of_column(self.state, id, column) else {
                continue;
            };
            let corner = pos2(
                self.center(row, place) - HALF_CELL[0],
                row.center().y - 0.5 * HALF_CELL[1],
            );
            let width = HALF_CELL[0].min(0.5 * self.pitch - 1.5);
            let cell = Rect::from_min_size(corner, vec2(2.0 * width + 1.0, HALF_CELL[1]));
            paint_cost(ui, cell, worst.cost, palette);
            let is_focus = column.pairs.contains(&self.state.display.selection.pair)
                && id == self.state.condition().id();
            if is_focus && !self.is_rail {
                ui.painter().rect_stroke(
                    cell.expand(2.0),
                    4.0,
                    Stroke::new(1.5, palette.accent),
                    StrokeKind::Outside,
                );
            }
            let response = ui.interact(cell, ui.scope_id().with(("cost", id, place)), Sense::CLICK);
            let words = cost_words(self.state, id, column, &worst);
            let response = named(response, Role::Button, words.clone());
            response.context_menu(|ui| marks.menu_ui(ui, commands));
            if response.on_hover_text(words).clicked() {
                commands.extend([
                    Command::Selection(SelectionCommand::SelectCondition(id)),
                    Command::Selection(SelectionCommand::FocusPair(worst.pair)),
                ]);
            }
        }
    }

    /// Draws the key of the shades, below the list.
    fn key_ui(&self, ui: &mut Ui, palette: &Palette) {
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 32.0), Sense::hover());
        let lines = [
            rect.with_max_y(rect.center().y),
            rect.with_min_y(rect.center().y),
        ];
        let title = match self.state.display.judging.mapped_cost {
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
}

/// Returns the horizontal position of a cost on the shade bar.
fn position_on_key(bar: Rect, cost: f32) -> f32 {
    let most = HEAT_COSTS[HEAT_COSTS.len() - 1];
    bar.left() + bar.width() * cost / most
}

/// Paints the first twelve conditions as a picture without interaction: marks, airspeeds and costs.
pub fn cost_picture_ui(ui: &Ui, area: Rect, state: &State, palette: &Palette) {
    const ROW: f32 = 17.0;
    let map = Map::new(state, 48.0, area.width() - 48.0);
    for (place, column) in map.columns.iter().enumerate() {
        let at = pos2(map.center(area, place), area.top() + 8.0);
        ui.painter().text(
            at,
            Align2::CENTER_CENTER,
            &column.head,
            small(),
            palette.dim_text,
        );
    }
    for (number, condition) in state.dataset().conditions().iter().take(12).enumerate() {
        let row = Rect::from_min_size(
            area.min + vec2(0.0, 18.0 + ROW * number as f32),
            vec2(area.width(), ROW),
        );
        let flight_state = condition.flight_state();
        map.paint_mark(
            ui,
            pos2(row.left() + 6.0, row.center().y),
            flight_state,
            palette,
        );
        let airspeed = flight_state.airspeed_kt.to_string();
        painted_text(
            ui,
            row.with_max_x(row.left() + 40.0),
            -0.01,
            &airspeed,
            small(),
            palette.dim_text,
        );
        for (place, column) in map.columns.iter().enumerate() {
            let Some(worst) = cost_of_column(state, condition.id(), column) else {
                continue;
            };
            let at = pos2(map.center(row, place), row.center().y);
            let cell = Rect::from_center_size(at, vec2(2.0 * HALF_CELL[0] + 1.0, HALF_CELL[1]));
            paint_cost(ui, cell, worst.cost, palette);
        }
    }
}

/// Paints a cell: the magnitude part of the cost in the left half, the phase part in the right
/// half.
fn paint_cost(ui: &Ui, cell: Rect, cost: Cost, palette: &Palette) {
    let middle = cell.center().x;
    let halves = [
        (cell.with_max_x(middle - 0.5), cost.magnitude),
        (cell.with_min_x(middle + 0.5), cost.phase),
    ];
    for (half, cost) in halves {
        ui.painter()
            .rect_filled(half, CornerRadius::same(2), palette.heat_of(cost));
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
        let responses = column.pairs.len();
        return format!(
            "{responses} responses not held, condition {condition}: mean J of magnitude \
            {magnitude}, of phase {phase}; largest: {name}"
        );
    }
    format!("{name} of condition {condition}: J of magnitude {magnitude}, of phase {phase}")
}
