//! List of flight conditions with a map of the costs that the correction leaves in each; wide, or
//! as a rail.

use egui::{
    Align2, Color32, CornerRadius, Mesh, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui, pos2,
    vec2,
};

use gdcm_method::correction::solution::Unmatched;
use gdcm_method::fidelity::Cost;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Pair};
use gdcm_model::number_format::decimals;
use gdcm_plot::figure::gains::Classes;
use gdcm_study::Edit;
use gdcm_words::caution::failure_text;

use super::cost_map::{CostColumn, columns, cost_of_column};
use super::table_menu::{table_heading_ui, table_menu_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::mapped_cost::MappedCost;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::tables::TableKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, entries_ui, named, painted_text, row_of_height_ui};
use crate::gui::widgets::focus::{Region, region_ui};
use crate::gui::widgets::palette::{
    BODY_SIZE, HEAT_COSTS, Palette, SMALL_SIZE, body, medium, small,
};

/// Right edge of the number, centre of the mark, right edge of the airspeed \[pt from the row's
/// left edge\].
const PLACES: [f32; 3] = [20.0, 33.0, 70.0];
/// Left edge of the map, and largest spacing of its columns \[pt\].
const MAP: [f32; 2] = [88.0, 26.0];
/// Half size of a cell of the map \[pt\].
const HALF_CELL: [f32; 2] = [10.0, 12.0];
/// Row heights of the list and of the rail \[pt\].
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
        table_heading_ui(
            ui,
            palette,
            ("Conditions", &count),
            TableKind::Conditions,
            commands,
        );
        let map = Map::of(state, MAP[0], ui.available_width() - MAP[0] - 16.0);
        map.heads_ui(ui, palette, commands);
        for condition in state.dataset().conditions() {
            map.row_ui(ui, condition, palette, commands);
        }
        map.key_ui(ui, palette);
    });
}

/// Draws the same as a narrow strip: number, airspeed, worst constrained response; buttons open the
/// physics and the identified models.
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
        let open = state
            .shown()
            .map_or(0, |shown| state.open_suggestions(shown).len());
        let sheets = [
            (BundleKind::Physics, "Models", Sheet::Models, open),
            (BundleKind::Identified, "Identified", Sheet::Identified, 0),
        ];
        for (kind, name, sheet, open) in sheets {
            bundle_button_ui(
                ui,
                (name, &state.kept_words(kind), open),
                sheet,
                palette,
                commands,
            );
        }
    });
}

/// Draws the pin that replaces the rail by the full panel.
fn pin_ui(ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
    let (rect, response) = ui.allocate_exact_size(vec2(32.0, 32.0), Sense::click());
    let box_of = Rect::from_center_size(rect.center(), vec2(14.0, 12.0));
    let color = if response.hovered() {
        palette.text
    } else {
        palette.dim_text
    };
    ui.painter()
        .rect_stroke(box_of, 2.0, Stroke::new(1.3, color), StrokeKind::Inside);
    ui.painter().vline(
        box_of.left() + 5.0,
        box_of.y_range(),
        Stroke::new(1.3, color),
    );
    let response = named(response, Role::Button, "Show the left panel");
    response
        .on_hover_text("Conditions with their map and models beside the plots (Ctrl+B)")
        .asks(LayoutCommand::ShowLeft(true), commands);
}

fn bundle_button_ui(
    ui: &mut Ui,
    (name, kept, open): (&str, &str, usize),
    sheet: Sheet,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let height = if open > 0 { 58.0 } else { 42.0 };
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
    if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, palette.raised);
    }
    let line = |row: usize, size: f32| {
        Rect::from_min_size(
            rect.min + vec2(4.0, 4.0 + 17.0 * row as f32),
            vec2(rect.width(), size),
        )
    };
    painted_text(
        ui,
        line(0, 17.0),
        0.0,
        name,
        medium(BODY_SIZE),
        palette.text,
    );
    painted_text(ui, line(1, 17.0), 0.0, kept, small(), palette.dim_text);
    if open > 0 {
        painted_text(
            ui,
            line(2, 17.0),
            0.0,
            &format!("{open} suggested"),
            small(),
            palette.warning,
        );
    }
    let response = named(response, Role::Button, format!("Open the list: {name}"));
    if response
        .on_hover_text(format!("{name}: {kept} kept"))
        .clicked()
    {
        commands.push(LayoutCommand::ShowSheet(Some(sheet)).into());
    }
}

/// "60 kt, low altitude, high weight".
fn in_words(state: &FlightState) -> String {
    let altitude = state
        .altitude
        .as_ref()
        .map_or(String::new(), |altitude| format!(", {altitude} altitude"));
    let weight = state
        .weight
        .as_ref()
        .map_or(String::new(), |weight| format!(", {weight} weight"));
    format!("{} kt{altitude}{weight}", state.airspeed_kt)
}

/// Layout of the list for one frame: its columns and their places.
struct Map<'a> {
    state: &'a State,
    classes: Classes,
    columns: Vec<CostColumn>,
    /// Left edge of the columns \[pt from the row's left edge\], and their spacing.
    left: f32,
    pitch: f32,
    is_rail: bool,
}

impl<'a> Map<'a> {
    /// Lays out the columns in a row from `left` on, within `room`.
    fn of(state: &'a State, left: f32, room: f32) -> Self {
        let columns = columns(state);
        let pitch = (room / columns.len().max(1) as f32).min(MAP[1]);
        Self {
            state,
            classes: Classes::of(state.dataset()),
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
            ..Self::of(state, 0.0, 0.0)
        }
    }

    /// Returns the centre of a column.
    fn center(&self, row: Rect, place: usize) -> f32 {
        row.left() + self.left + self.pitch * place as f32 + HALF_CELL[0]
    }

    /// Paints the dot of a condition as in Net gain.
    fn paint_mark(&self, ui: &Ui, at: Pos2, flight_state: &FlightState, palette: &Palette) {
        let is_filled = self.classes.is_first_weight(flight_state);
        let (fill, stroke) = match is_filled {
            true => (palette.perturbed, Stroke::NONE),
            false => (Color32::TRANSPARENT, Stroke::new(1.6, palette.perturbed)),
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
            .map(|by| at + by);
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
            let is_of_focus = column.pairs.contains(&self.state.display.selection.pair);
            let color = if is_of_focus {
                palette.text
            } else {
                palette.dim_text
            };
            let font = if is_of_focus {
                medium(SMALL_SIZE)
            } else {
                small()
            };
            let at = pos2(self.center(row, place), row.center().y);
            ui.painter()
                .text(at, Align2::CENTER_CENTER, &column.head, font, color);
        }
        let heading = named(heading, Role::Label, "Heading of the map of costs");
        heading.context_menu(|ui| {
            let entry = |mapped: MappedCost| {
                (
                    format!("Map J of {}", mapped.name()),
                    Command::Display(DisplayCommand::MapCost(mapped)),
                )
            };
            entries_ui(ui, MappedCost::ALL.map(entry), commands);
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
        let marks = Marks::of(state, id);
        let flight_state = condition.flight_state();
        let name = format!(
            "Condition {id}: {}{}",
            in_words(flight_state),
            marks.after_name()
        );
        let is_shown = id == state.condition().id();
        let is_pointed = state.display.selection.hovered_condition == Some(id);
        let height = ROWS[usize::from(self.is_rail)];
        let (row, response) = row_of_height_ui(ui, palette, (is_shown, is_pointed, height), &name);
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
        let at = |right: f32| row.with_max_x(row.left() + right);
        painted_text(
            ui,
            at(places[0]),
            -0.01,
            &id.to_string(),
            medium(BODY_SIZE),
            color,
        );
        painted_text(
            ui,
            at(places[2]),
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
        self.cells_ui(ui, row, (id, &marks), palette, commands);
        marks.paint(ui, row, palette);
        response.asks(SelectionCommand::SelectCondition(id), commands);
        response.context_menu(|ui| menu_ui(ui, id, &marks, commands));
        response.on_hover_ui(|ui| tooltip_ui(ui, condition, &marks, palette));
    }

    /// Draws the cells of a condition; a click on a cell shows the condition and the response.
    fn cells_ui(
        &self,
        ui: &mut Ui,
        row: Rect,
        (id, marks): (ConditionId, &Marks),
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        for (place, column) in self.columns.iter().enumerate() {
            let Some((pair, cost)) = cost_of_column(self.state, id, column) else {
                continue;
            };
            let corner = pos2(
                self.center(row, place) - HALF_CELL[0],
                row.center().y - 0.5 * HALF_CELL[1],
            );
            let width = HALF_CELL[0].min(0.5 * self.pitch - 1.5);
            let cell = Rect::from_min_size(corner, vec2(2.0 * width + 1.0, HALF_CELL[1]));
            paint_cost(ui, cell, cost, palette);
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
            let words = cost_words(self.state, id, (column, pair), cost);
            let response = named(response, Role::Button, words.clone());
            response.context_menu(|ui| menu_ui(ui, id, marks, commands));
            if response.on_hover_text(words).clicked() {
                commands.extend([
                    Command::Selection(SelectionCommand::SelectCondition(id)),
                    Command::Selection(SelectionCommand::FocusPair(pair)),
                ]);
            }
        }
    }

    /// Draws the key of the shades.
    fn key_ui(&self, ui: &mut Ui, palette: &Palette) {
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 32.0), Sense::hover());
        let lines = [
            rect.with_max_y(rect.center().y),
            rect.with_min_y(rect.center().y),
        ];
        let of = match self.state.display.judging.mapped_cost {
            MappedCost::Before => "J before, held responses",
            MappedCost::Own => "J of the held responses",
            MappedCost::Scheduled => "J under the schedule",
        };
        painted_text(ui, lines[0], 0.0, of, small(), palette.dim_text);
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
        let most = HEAT_COSTS[HEAT_COSTS.len() - 1];
        let at = |cost: f32| bar.left() + bar.width() * cost / most;
        let mut mesh = Mesh::default();
        for (cost, color) in HEAT_COSTS.into_iter().zip(palette.heat) {
            mesh.colored_vertex(pos2(at(cost), bar.top()), color);
            mesh.colored_vertex(pos2(at(cost), bar.bottom()), color);
        }
        for step in 0..HEAT_COSTS.len() as u32 - 1 {
            mesh.add_triangle(2 * step, 2 * step + 1, 2 * step + 2);
            mesh.add_triangle(2 * step + 1, 2 * step + 2, 2 * step + 3);
        }
        ui.painter().add(mesh);
        for cost in [0.0, 50.0, 100.0] {
            let place = pos2(at(cost), lines[1].center().y);
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

/// Paints the list as a static picture: marks, airspeeds and costs.
pub fn cost_picture_ui(ui: &Ui, area: Rect, state: &State, palette: &Palette) {
    const ROW: f32 = 17.0;
    let map = Map::of(state, 48.0, area.width() - 48.0);
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
            let Some((_, cost)) = cost_of_column(state, condition.id(), column) else {
                continue;
            };
            let at = pos2(map.center(row, place), row.center().y);
            let cell = Rect::from_center_size(at, vec2(2.0 * HALF_CELL[0] + 1.0, HALF_CELL[1]));
            paint_cost(ui, cell, cost, palette);
        }
    }
}

/// Paints magnitude in the left half, phase in the right half.
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
    (column, worst): (&CostColumn, Pair),
    cost: Cost,
) -> String {
    let [magnitude, phase] = [cost.magnitude, cost.phase].map(|cost| decimals(cost, 1));
    let name = state.dataset().pair_name(worst);
    if column.is_mean {
        let responses = column.pairs.len();
        return format!(
            "{responses} responses not held, condition {condition}: mean J of magnitude {magnitude}, of phase {phase}; most: {name}"
        );
    }
    format!("{name} of condition {condition}: J of magnitude {magnitude}, of phase {phase}")
}

/// Draws the context menu of a condition.
fn menu_ui(ui: &mut Ui, condition: ConditionId, marks: &Marks, commands: &mut Vec<Command>) {
    let hold_out = if marks.held_out {
        "No longer hold out"
    } else {
        "Hold out, to judge the schedule"
    };
    let schedule = if marks.left_out {
        "Include in the schedule"
    } else {
        "Leave out of the schedule"
    };
    let entries = [
        (
            hold_out,
            Edit::SetHeldOut {
                condition,
                held_out: !marks.held_out,
            },
        ),
        (
            schedule,
            Edit::SetScheduled {
                condition,
                scheduled: marks.left_out,
            },
        ),
    ];
    entries_ui(
        ui,
        entries.map(|(text, edit)| (format!("{text}: condition {condition}"), edit.into())),
        commands,
    );
}

/// Open tasks of a condition, as marked in the list.
#[derive(Default)]
struct Marks {
    /// Models suggested as outliers and not rejected.
    suggested: usize,
    /// Constrained gains that are not matched.
    unmatched_gains: usize,
    /// Constrained delays that are not matched although a decision could match them; excludes
    /// delays that need lead while leads are not requested.
    unmatched_delays: usize,
    left_out: bool,
    held_out: bool,
    failure: Option<String>,
}

impl Marks {
    fn of(state: &State, condition: ConditionId) -> Self {
        let choice = state.study.choice(condition);
        let mut marks = Self {
            left_out: !choice.scheduled,
            held_out: choice.held_out,
            ..Self::default()
        };
        match state
            .analysis()
            .and_then(|analysis| analysis.conditions.get(&condition))
        {
            None => {}
            Some(Err(failure)) => marks.failure = Some(failure_text(failure, state.dataset())),
            Some(Ok(result)) => {
                marks.suggested = state.open_suggestions(result).len();
                marks.unmatched_gains = result.gains.unmatched.len();
                let is_open =
                    |missed: &&Unmatched| result.compensated.is_some() || missed.delta >= 0.0;
                marks.unmatched_delays = result.delays.unmatched.iter().filter(is_open).count();
            }
        }
        marks
    }

    /// Returns the part of the row's accessible name that follows the flight state.
    fn after_name(&self) -> &'static str {
        match (self.held_out, self.left_out) {
            (true, _) => ", held out",
            (false, true) => ", left out of the schedule",
            (false, false) => "",
        }
    }

    /// Paints ⚠ for an open decision, a stroke through an excluded condition, an accent on a
    /// held-out condition.
    fn paint(&self, ui: &Ui, row: Rect, palette: &Palette) {
        if self.failure.is_some()
            || self.suggested + self.unmatched_gains + self.unmatched_delays > 0
        {
            painted_text(ui, row, -4.0, "⚠", small(), palette.warning);
        }
        if self.held_out {
            ui.painter().vline(
                row.left() + 1.0,
                row.shrink(3.0).y_range(),
                Stroke::new(2.0, palette.accent),
            );
        } else if self.left_out {
            ui.painter().hline(
                row.left() + 4.0..=row.left() + 22.0,
                row.center().y,
                Stroke::new(1.0, palette.quiet_text),
            );
        }
    }

    /// Describes the open tasks, the state in the schedule and the reason for a missing result: at
    /// most three sentences.
    fn sentences(&self) -> Vec<String> {
        let counted = [
            (self.suggested, "suggested as outliers, not rejected"),
            (self.unmatched_gains, "held gains not matched"),
            (
                self.unmatched_delays,
                "held delays not matched (without those that need lead)",
            ),
        ];
        let counted = counted.into_iter().filter(|(count, _)| *count > 0);
        let counted: Vec<String> = counted
            .map(|(count, words)| format!("{count} {words}"))
            .collect();
        let counted = (!counted.is_empty()).then(|| counted.join("; "));
        let held_out =
            "Held out: analysed, and the schedule is judged by it; right-click ends that";
        let left_out = "Left out of the schedule; right-click includes it";
        let states = [(self.held_out, held_out), (self.left_out, left_out)];
        let states = states
            .into_iter()
            .find(|(is_so, _)| *is_so)
            .map(|(_, words)| words.to_owned());
        counted
            .into_iter()
            .chain(states)
            .chain(self.failure.clone())
            .collect()
    }
}

fn tooltip_ui(ui: &mut Ui, condition: &Condition, marks: &Marks, palette: &Palette) {
    let state = condition.flight_state();
    ui.label(
        egui::RichText::new(&state.name)
            .font(medium(BODY_SIZE))
            .color(palette.text),
    );
    let mut values = vec![format!("{} kt true airspeed", state.airspeed_kt)];
    values.extend(state.altitude_ft.map(|feet| format!("{feet} ft")));
    values.extend(state.mass_kg.map(|mass| format!("{mass} kg")));
    ui.label(values.join(" · "));
    for sentence in marks.sentences() {
        ui.label(sentence);
    }
}
