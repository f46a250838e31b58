//! Ranking of the physics parameters: change with its interval, position on an axis of plausible
//! changes, share of the misfit that each explains, and verdict (M18.4: docs/physics.md).
//!
//! The unit of that axis is the parameter's *plausible* standard deviation, the engineer's prior
//! for its change; `z` is a change in this unit. A parameter is *named* if the diagnosis proposes
//! its change.

use egui::{Align2, Color32, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};

use gdcm_method::physics::problem::GREATEST_VALUE;
use gdcm_method::physics::verdict::WhyNotNamed;
use gdcm_study::results::physics_findings::{DiagnosedParameter, PhysicsFindings};
use gdcm_words::physics::{change_text, naming_words};

use super::fit_box::fit_box_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::widgets::controls::{Asks, hint_right_of};
use crate::gui::widgets::list_row::RowLook;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, Room, painted_text, row_text_within};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};

/// Row height \[pt\].
pub(super) const ROW: f32 = 24.0;
/// Height of the headings \[pt\].
const HEADINGS: f32 = 20.0;
/// Bar length for the parameter that explains most alone \[pt\].
const FULL_BAR: f32 = 56.0;
/// Minimum share that a full bar represents, so that bars for negligible shares stay short.
const LEAST_FULL: f32 = 0.1;
/// Axis length on each side of the nominal value, in plausible standard deviations; the fit bounds
/// the changes there.
const AXIS_END: f32 = GREATEST_VALUE as f32;
/// Radius of the dot at the value \[pt\].
const DOT: f32 = 3.5;

/// Horizontal positions of the columns \[pt\]; left edges unless noted.
#[derive(Clone, Copy, Debug)]
struct Columns {
    check: f32,
    number: f32,
    name: Room,
    /// Right edge of the column with the change.
    change: f32,
    half_width: f32,
    /// Centre and half-length of the axis in plausible standard deviations.
    axis: [f32; 2],
    bar: f32,
    percent: f32,
    verdict: Room,
}

impl Columns {
    /// Divides the row width among the columns.
    fn new(width: f32) -> Self {
        let name = Room {
            left: 42.0,
            right: (0.30 * width).max(120.0),
        };
        let change = name.right + 62.0;
        let half_width = change + 6.0;
        let axis_left = half_width + 58.0;
        let axis_half = 40.0;
        let bar = axis_left + 2.0 * axis_half + 16.0;
        let percent = bar + FULL_BAR + 26.0;
        Self {
            check: 6.0,
            number: 24.0,
            name,
            change,
            half_width,
            axis: [axis_left + axis_half, axis_half],
            bar,
            percent,
            verdict: Room {
                left: percent + 10.0,
                right: width - 4.0,
            },
        }
    }
}

/// Axis in plausible standard deviations, in a row.
#[derive(Clone, Copy, Debug)]
struct SdAxis {
    /// Horizontal screen position for the nominal value \[pt\].
    middle: f32,
    /// Length per plausible standard deviation \[pt\].
    per_sd: f32,
}

impl SdAxis {
    fn new(row: Rect, columns: Columns) -> Self {
        let [middle, half] = columns.axis;
        Self {
            middle: row.left() + middle,
            per_sd: half / AXIS_END,
        }
    }

    /// Returns the horizontal screen position for a change of `z` plausible standard deviations,
    /// clamped to the axis.
    fn place(self, z: f32) -> f32 {
        self.middle + self.per_sd * z.clamp(-AXIS_END, AXIS_END)
    }
}

/// Ranking of the parameters that are switched on, then those that are off.
pub(super) struct Ranking<'a> {
    pub(super) findings: &'a PhysicsFindings,
    /// Index of the selected parameter among those switched on.
    pub(super) selected: usize,
    /// Whether the rows have the boxes that switch parameters on and off; the parameter list at the
    /// left has them if it is shown.
    pub(super) has_boxes: bool,
    pub(super) palette: &'a Palette,
}

impl Ranking<'_> {
    /// Returns the height of the ranking \[pt\].
    pub(super) fn height(&self) -> f32 {
        let rows = self.findings.parameters.len() + self.findings.off.len();
        HEADINGS + ROW * rows as f32
    }

    /// Draws the headings and a row for each parameter; a click on the row of a parameter that is
    /// switched on selects it.
    pub(super) fn ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        ui.spacing_mut().item_spacing.y = 0.0;
        let columns = Columns::new(ui.available_width());
        self.headings_ui(ui, columns);
        for (place, parameter) in self.findings.ranked().into_iter().enumerate() {
            let rank = place + 1;
            self.row_ui(ui, columns, rank, parameter, commands);
        }
        for parameter in &self.findings.off {
            self.off_row_ui(ui, columns, &parameter.name, commands);
        }
    }

    fn headings_ui(&self, ui: &mut Ui, columns: Columns) {
        let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), HEADINGS), Sense::hover());
        let color = self.palette.dim_text;
        painted_text(ui, row, columns.name.left, "parameter", small(), color);
        let right = row.with_max_x(row.left() + columns.change);
        painted_text(ui, right, AT_RIGHT_END, "change", small(), color);
        painted_text(ui, row, columns.half_width, "±", small(), color);
        let [middle, _] = columns.axis;
        let title = format!("±{AXIS_END} plausible sd");
        let at = pos2(row.left() + middle, row.center().y);
        ui.painter()
            .text(at, Align2::CENTER_CENTER, title, small(), color);
        painted_text(ui, row, columns.bar, "explained, %", small(), color);
    }

    /// Draws the row of the parameter with the index `parameter`; its rank counts from 1.
    fn row_ui(
        &self,
        ui: &mut Ui,
        columns: Columns,
        rank: usize,
        parameter: usize,
        commands: &mut Vec<Command>,
    ) {
        let diagnosed = DiagnosedParameter {
            parameter: &self.findings.parameters[parameter],
            diagnosis: &self.findings.diagnosis.parameters[parameter],
        };
        let name = &diagnosed.parameter.name;
        let look = RowLook {
            is_selected: parameter == self.selected,
            is_pointed: false,
            height: ROW,
        };
        let (row, response) = look.row_ui(ui, self.palette, &format!("Parameter {name}"));
        hint_right_of(response, row, &diagnosed.parameter.description)
            .asks(DisplayCommand::ShowParameter(name.clone()), commands);
        if self.has_boxes {
            let left = row.left() + columns.check;
            let is_on = true;
            fit_box_ui(ui, row, left, name, is_on, self.palette, commands);
        }
        let is_named = diagnosed.diagnosis.is_named();
        let color = if is_named {
            self.palette.text
        } else {
            self.palette.dim_text
        };
        let number = rank.to_string();
        painted_text(
            ui,
            row,
            columns.number,
            &number,
            body(),
            self.palette.dim_text,
        );
        row_text_within(ui, row, columns.name, name, BODY_SIZE, color);
        let right = row.with_max_x(row.left() + columns.change);
        let font = if is_named { medium(BODY_SIZE) } else { body() };
        let change = change_text(
            diagnosed.parameter,
            diagnosed.change(),
            diagnosed.half_width(),
        );
        let (value, interval) = match change.split_once(" ± ") {
            Some((value, interval)) => (value, format!("± {interval}")),
            None => (change.as_str(), String::new()),
        };
        painted_text(ui, right, AT_RIGHT_END, value, font, color);
        painted_text(
            ui,
            row,
            columns.half_width,
            &interval,
            small(),
            self.palette.dim_text,
        );
        self.axis_ui(ui, row, columns, &diagnosed);
        self.explained_ui(ui, row, columns, parameter);
        let words = naming_words(diagnosed.diagnosis.why_not_named);
        let color = verdict_color(&diagnosed, self.palette);
        row_text_within(ui, row, columns.verdict, words, BODY_SIZE, color);
    }

    /// Draws the axis in plausible standard deviations: shaded within ± 1, and with the value and
    /// its interval. A parameter that is named has a filled dot, another a ring.
    fn axis_ui(&self, ui: &Ui, row: Rect, columns: Columns, diagnosed: &DiagnosedParameter<'_>) {
        let axis = SdAxis::new(row, columns);
        let plausible = Rect::from_x_y_ranges(
            axis.place(-1.0)..=axis.place(1.0),
            row.shrink(1.0).y_range(),
        );
        ui.painter()
            .rect_filled(plausible, 0.0, self.palette.text.gamma_multiply(0.08));
        ui.painter().vline(
            axis.place(0.0),
            row.y_range(),
            Stroke::new(1.0, self.palette.line),
        );
        let z = diagnosed.diagnosis.z as f32;
        let is_named = diagnosed.diagnosis.is_named();
        let color = if is_named {
            self.palette.perturbed
        } else {
            self.palette.dim_text
        };
        if let Some(half_width) = diagnosed.diagnosis.half_width {
            let half_width = half_width as f32;
            ui.painter().hline(
                axis.place(z - half_width)..=axis.place(z + half_width),
                row.center().y,
                Stroke::new(1.5, color),
            );
        }
        let at: Pos2 = pos2(axis.place(z), row.center().y);
        if is_named {
            ui.painter().circle_filled(at, DOT, color);
        } else {
            ui.painter()
                .circle(at, DOT, self.palette.panel, Stroke::new(1.3, color));
        }
    }

    /// Returns the share that a full bar represents: the largest that a parameter explains alone,
    /// at least [`LEAST_FULL`].
    fn full_share(&self) -> f32 {
        let mut full = LEAST_FULL;
        for parameter in &self.findings.diagnosis.parameters {
            if let Some(remaining_share) = parameter.ratio_alone {
                full = full.max((1.0 - remaining_share) as f32);
            }
        }
        full
    }

    /// Draws the share of the misfit that a parameter explains: alone (pale, and in numbers), and
    /// by its step in the stepwise list, in which each step adds the parameter that explains most
    /// of the rest (solid). Nothing for a parameter without a share: its value is set by hand, or
    /// there are too few conditions.
    fn explained_ui(&self, ui: &Ui, row: Rect, columns: Columns, parameter: usize) {
        let diagnosis = &self.findings.diagnosis.parameters[parameter];
        let Some(remaining_share) = diagnosis.ratio_alone else {
            return;
        };
        let alone = (1.0 - remaining_share).clamp(0.0, 1.0) as f32;
        let by_step = diagnosis.gain.unwrap_or(0.0).clamp(0.0, 1.0) as f32;
        let left = row.left() + columns.bar;
        let full = self.full_share();
        for (share, strength) in [(alone, 0.45), (by_step, 1.0)] {
            let bar = Rect::from_min_size(
                pos2(left, row.center().y - 4.0),
                vec2(FULL_BAR * (share / full).min(1.0), 8.0),
            );
            let color = self.palette.perturbed.gamma_multiply(strength);
            ui.painter().rect_filled(bar, 1.0, color);
        }
        let percent = format!("{:.0}", 100.0 * alone);
        let right = row.with_max_x(row.left() + columns.percent);
        painted_text(ui, right, AT_RIGHT_END, &percent, body(), self.palette.text);
    }

    fn off_row_ui(&self, ui: &mut Ui, columns: Columns, name: &str, commands: &mut Vec<Command>) {
        let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
        if self.has_boxes {
            let left = row.left() + columns.check;
            let is_on = false;
            fit_box_ui(ui, row, left, name, is_on, self.palette, commands);
        }
        let color = self.palette.dim_text;
        row_text_within(ui, row, columns.name, name, BODY_SIZE, color);
        row_text_within(ui, row, columns.verdict, "off", BODY_SIZE, color);
    }
}

/// Returns the colour for a parameter's verdict: the warning colour if the change is at its bound,
/// the text colour if the parameter is named, otherwise the dim colour.
fn verdict_color(diagnosed: &DiagnosedParameter<'_>, palette: &Palette) -> Color32 {
    match diagnosed.diagnosis.why_not_named {
        None => palette.text,
        Some(WhyNotNamed::AtBound { .. }) => palette.warning,
        Some(_) => palette.dim_text,
    }
}
