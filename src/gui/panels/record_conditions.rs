//! Condition list while the view *Records* is in front: record counts, fit costs and fit state.
//!
//! χ²/dof is the cost of a fit per degree of freedom; it is near 1 if the residual is noise (M14:
//! docs/identification.md). Held-out records are not fitted, but test the model.

use egui::{Color32, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};

use gdcm_model::dataset::Condition;
use gdcm_model::number_format::counted;

use super::condition_marks::Marks;
use super::condition_rows::{ConditionRows, airspeed_room, airspeed_text, condition_name};
use super::table_menu::{TableHeading, table_menu_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::condition_fit::{BAD_FIT, ConditionFit, FitStatus};
use crate::gui::state::panel_tables::TableKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, hint_right_of};
use crate::gui::widgets::list_row::{ROW_HEIGHT, RowLook};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Positions in a row \[pt from its left edge\].
struct Columns {
    number_end: f32,
    /// Centre of the flight-state symbol; `None` in the rail.
    symbol_center: Option<f32>,
    airspeed_end: f32,
    /// Right edges of the columns that the rail omits; `None` in the rail.
    list_only: Option<ListColumns>,
    held_out_end: f32,
    /// Left edge of the fit state.
    status_left: f32,
    height: f32,
}

/// Columns of the full list.
#[derive(Clone, Copy)]
struct ListColumns {
    /// Right edge of the record counts.
    records_end: f32,
    /// Right edge of χ²/dof for the fitted records.
    cost_end: f32,
}

const LIST_ONLY: ListColumns = ListColumns {
    records_end: 112.0,
    cost_end: 152.0,
};

const LIST: Columns = Columns {
    number_end: 20.0,
    symbol_center: Some(33.0),
    airspeed_end: 68.0,
    list_only: Some(LIST_ONLY),
    held_out_end: 190.0,
    status_left: 200.0,
    height: ROW_HEIGHT,
};

const RAIL: Columns = Columns {
    number_end: 16.0,
    symbol_center: None,
    airspeed_end: 45.0,
    list_only: None,
    held_out_end: 78.0,
    status_left: 81.0,
    height: 24.0,
};

/// Draws every condition with its record counts, fit costs and fit state; a click shows the
/// condition.
pub fn record_conditions_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    region_ui(ui, Region::Conditions, |ui| {
        let heading = TableHeading {
            title: "Conditions",
            value: &state.dataset().conditions().len().to_string(),
            kind: TableKind::Conditions,
        };
        heading.ui(ui, palette, commands);
        let heads = [
            (LIST.number_end, "no."),
            (LIST.airspeed_end, "kt"),
            (LIST_ONLY.records_end, "rec."),
            (LIST_ONLY.cost_end, "χ²/dof"),
            (LIST.held_out_end, "held"),
        ];
        let row = heads_ui(ui, &heads, palette);
        painted_text(ui, row, LIST.status_left, "fit", small(), palette.dim_text);
        rows_ui(ui, state, &LIST, palette, commands);
        key_ui(ui, palette);
    });
}

/// Draws the conditions as a narrow strip: number, airspeed, χ²/dof for the held-out records.
pub(super) fn record_rail_rows_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    region_ui(ui, Region::Conditions, |ui| {
        let heads = [
            (RAIL.number_end, "no."),
            (RAIL.airspeed_end, "kt"),
            (RAIL.held_out_end, "held"),
        ];
        let row = heads_ui(ui, &heads, palette);
        let heading = ui.interact(row, ui.scope_id().with("held"), Sense::hover());
        table_menu_ui(ui, &heading, TableKind::Conditions, commands);
        rows_ui(ui, state, &RAIL, palette, commands);
    });
}

fn heads_ui(ui: &mut Ui, heads: &[(f32, &str)], palette: &Palette) -> Rect {
    let size = vec2(ui.available_width(), 18.0);
    let (row, _) = ui.allocate_exact_size(size, Sense::hover());
    for (end, words) in heads {
        let upto = row.with_max_x(row.left() + end);
        painted_text(ui, upto, AT_RIGHT_END, words, small(), palette.dim_text);
    }
    row
}

/// Draws two lines that explain the columns.
fn key_ui(ui: &mut Ui, palette: &Palette) {
    let size = vec2(ui.available_width(), 32.0);
    let (row, _) = ui.allocate_exact_size(size, Sense::hover());
    let lines = [
        (
            row.with_max_y(row.center().y),
            "rec.: used + held out. held: χ²/dof on the",
        ),
        (
            row.with_min_y(row.center().y),
            "held-out records. Near 1: residual is noise",
        ),
    ];
    for (line, words) in lines {
        painted_text(ui, line, 0.0, words, small(), palette.dim_text);
    }
}

fn rows_ui(
    ui: &mut Ui,
    state: &State,
    columns: &Columns,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let usual_rows = ConditionRows::list(state, ui.available_width());
    for condition in state.dataset().conditions() {
        let row = RecordsRow {
            state,
            condition,
            fit: state.condition_fit(condition.id()),
            columns,
        };
        row.ui(ui, &usual_rows, palette, commands);
    }
}

struct RecordsRow<'a> {
    state: &'a State,
    condition: &'a Condition,
    fit: ConditionFit,
    columns: &'a Columns,
}

impl RecordsRow<'_> {
    /// Draws the row; `usual_rows` paint the flight-state symbol as in the usual list.
    fn ui(
        &self,
        ui: &mut Ui,
        usual_rows: &ConditionRows<'_>,
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let id = self.condition.id();
        let columns = self.columns;
        let marks = Marks::new(self.state, id);
        let flight_state = self.condition.flight_state();
        let look = RowLook {
            is_selected: id == self.state.condition().id(),
            is_pointed: self.state.display.selection.hovered_condition == Some(id),
            height: columns.height,
        };
        let name = condition_name(self.condition, &marks);
        let (row, response) = look.row_ui(ui, palette, &name);
        if response.contains_pointer() {
            commands.push(SelectionCommand::HoverCondition(id).into());
        }
        let number = row.with_max_x(row.left() + columns.number_end);
        let number_font = medium(BODY_SIZE);
        painted_text(
            ui,
            number,
            AT_RIGHT_END,
            &id.to_string(),
            number_font,
            palette.text,
        );
        let room = airspeed_room(
            columns.number_end,
            columns.symbol_center,
            columns.airspeed_end,
        );
        let airspeed = airspeed_text(ui, flight_state.airspeed_kt, room);
        self.paint_cell(ui, row, columns.airspeed_end, &airspeed, palette.text);
        if let Some(center) = columns.symbol_center {
            let at = pos2(row.left() + center, row.center().y);
            usual_rows.paint_symbol(ui, at, flight_state, palette);
        }
        self.paint_fit(ui, row, palette);
        self.paint_status(ui, row, palette);
        response.asks(SelectionCommand::SelectCondition(id), commands);
        response.context_menu(|ui| marks.menu_ui(ui, commands));
        let hint = format!("{}\n{}", flight_state.name, status_words(&self.fit));
        hint_right_of(response, row, &hint);
    }

    fn paint_cell(&self, ui: &Ui, row: Rect, end: f32, words: &str, color: Color32) {
        let upto = row.with_max_x(row.left() + end);
        painted_text(ui, upto, AT_RIGHT_END, words, body(), color);
    }

    /// Paints record counts and costs, in the rail only χ²/dof for the held-out records.
    fn paint_fit(&self, ui: &Ui, row: Rect, palette: &Palette) {
        let costs = self.fit.costs;
        if let Some(ListColumns {
            records_end,
            cost_end,
        }) = self.columns.list_only
        {
            let counts = match (self.fit.counts.fitted, self.fit.counts.held_out) {
                (0, 0) => NO_VALUE.to_owned(),
                (fitted, 0) => fitted.to_string(),
                (fitted, held_out) => format!("{fitted} + {held_out}"),
            };
            self.paint_cell(ui, row, records_end, &counts, palette.dim_text);
            let fitted = costs.map(|costs| costs.fitted);
            let is_bad = fitted.is_some_and(|cost| cost > BAD_FIT);
            let color = self.cost_color(is_bad, palette);
            self.paint_cell(ui, row, cost_end, &cost_text(fitted), color);
        }
        let held_out = costs.and_then(|costs| costs.held_out);
        let is_bad = costs.is_some_and(|costs| costs.is_held_out_bad);
        let color = self.cost_color(is_bad, palette);
        let end = self.columns.held_out_end;
        self.paint_cell(ui, row, end, &cost_text(held_out), color);
    }

    /// Returns the colour of a cost: dim unless the fit is finished and up to date.
    fn cost_color(&self, is_bad: bool, palette: &Palette) -> Color32 {
        if !matches!(self.fit.status, FitStatus::Finished { .. }) {
            palette.quiet_text
        } else if is_bad {
            palette.warning
        } else {
            palette.text
        }
    }

    /// Paints the fit state: progress, "queued", "failed", "outdated", or for a finished fit ✓ and,
    /// with cautions, ⚠ and their count; in the rail, a single short mark.
    fn paint_status(&self, ui: &Ui, row: Rect, palette: &Palette) {
        let left = self.columns.status_left;
        let is_rail = self.columns.list_only.is_none();
        let center = pos2(row.left() + left + 6.0, row.center().y);
        match self.fit.status {
            FitStatus::None => {}
            FitStatus::Queued if is_rail => {
                painted_text(ui, row, left, "…", small(), palette.dim_text);
            }
            FitStatus::Queued => {
                painted_text(ui, row, AT_RIGHT_END, "queued", small(), palette.dim_text);
            }
            FitStatus::Running { percent } => {
                paint_progress(ui, center, percent, palette);
                if !is_rail {
                    let words = format!("{percent} %");
                    painted_text(ui, row, AT_RIGHT_END, &words, small(), palette.text);
                }
            }
            FitStatus::Failed if is_rail => {
                painted_text(ui, row, left + 2.0, "⚠", small(), palette.warning);
            }
            FitStatus::Failed => {
                painted_text(ui, row, AT_RIGHT_END, "failed", small(), palette.warning);
            }
            FitStatus::Outdated if is_rail => {
                painted_text(ui, row, left + 2.0, "old", small(), palette.warning);
            }
            FitStatus::Outdated => {
                painted_text(ui, row, AT_RIGHT_END, "outdated", small(), palette.warning);
            }
            FitStatus::Finished { cautions } => {
                if cautions == 0 || !is_rail {
                    paint_tick(ui, center, palette.dim_text);
                }
                if cautions > 0 {
                    let words = if is_rail {
                        "⚠".to_owned()
                    } else {
                        format!("⚠ {cautions}")
                    };
                    painted_text(ui, row, AT_RIGHT_END, &words, small(), palette.warning);
                }
            }
        }
    }
}

/// Text for a missing count or cost.
const NO_VALUE: &str = "–";

/// Formats a cost with two decimals.
fn cost_text(cost: Option<f64>) -> String {
    match cost {
        Some(cost) => format!("{cost:.2}"),
        None => NO_VALUE.to_owned(),
    }
}

fn paint_tick(ui: &Ui, center: egui::Pos2, color: Color32) {
    let corners = [vec2(-3.5, 0.2), vec2(-1.0, 2.8), vec2(3.5, -2.8)];
    let points = corners.map(|corner| center + corner).to_vec();
    ui.painter().line(points, Stroke::new(1.4, color));
}

/// Paints a ring that closes as the share \[%\] grows.
fn paint_progress(ui: &Ui, center: egui::Pos2, percent: usize, palette: &Palette) {
    const RADIUS: f32 = 4.5;
    const STEPS: usize = 32;
    ui.painter()
        .circle_stroke(center, RADIUS, Stroke::new(2.0, palette.line));
    let last = (STEPS * percent.min(100) / 100).max(1);
    let mut points = Vec::with_capacity(last + 1);
    for step in 0..=last {
        let angle = std::f32::consts::TAU * step as f32 / STEPS as f32;
        points.push(center + RADIUS * vec2(angle.sin(), -angle.cos()));
    }
    ui.painter()
        .add(Shape::line(points, Stroke::new(2.0, palette.accent)));
}

/// Describes the fit state, for the tooltip.
fn status_words(fit: &ConditionFit) -> String {
    match fit.status {
        FitStatus::None if fit.counts.fitted + fit.counts.held_out == 0 => {
            "No record is used".to_owned()
        }
        FitStatus::None => "Not identified yet".to_owned(),
        FitStatus::Queued => "Waiting for other conditions".to_owned(),
        FitStatus::Running { percent } => format!("Identifying, {percent} %"),
        FitStatus::Failed => "The identification failed; the reason is beside the plots".to_owned(),
        FitStatus::Outdated => {
            "Outdated: records or settings have changed since; identify again".to_owned()
        }
        FitStatus::Finished { cautions: 0 } => "Identified".to_owned(),
        FitStatus::Finished { cautions } => {
            format!("Identified, with {}", counted(cautions, "caution"))
        }
    }
}
