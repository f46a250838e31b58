//! Editor for the limit of a requirement, in a popup beside the grid's limit column (M17:
//! docs/requirements.md), and the commands that change limits. `requirement_limits_menu` has the
//! menu for all limits.

use egui::{Grid, Popup, PopupCloseBehavior, Response, RichText, Ui};

use gdcm_method::requirements::mode_comparison::ModeTolerance;
use gdcm_method::requirements::{ModeName, ModeToleranceTable, Tolerance, ToleranceTable};
use gdcm_study::decisions::requirement_settings::{OverviewLimits, RequirementPart};
use gdcm_study::results::grid_requirement::Requirement;

use super::limit_field::LimitField;
use super::requirement_edits::requirement_edit;
use super::requirement_selection::requirement_names;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::requirements_display::RequirementsDisplay;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};
use crate::message::Message;

/// Draws the fields for a row's limit in a popup; a click beside the popup or Escape closes it.
pub(super) fn limit_editor_ui(
    limit: &Response,
    state: &State,
    requirement: Requirement,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut is_open = true;
    let name = requirement_names(state).name(requirement);
    let popup = Popup::from_response(limit)
        .open_bool(&mut is_open)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .accessible_name(format!("Edit the limit of {name}"));
    popup.show(|ui| {
        ui.label(RichText::new(&name).font(medium(BODY_SIZE)));
        let editor = LimitEditor { state, palette };
        editor.ui(ui, requirement, commands);
    });
    if !is_open {
        let display = RequirementsDisplay {
            edited_limit: None,
            ..state.display.judging.requirements
        };
        commands.push(DisplayCommand::ShowRequirements(display).into());
    }
}

/// Fields for the limit of one requirement. The fields for bandwidth and phase delay change the
/// limits for every axis.
struct LimitEditor<'a> {
    state: &'a State,
    palette: &'a Palette,
}

impl LimitEditor<'_> {
    fn ui(&self, ui: &mut Ui, requirement: Requirement, commands: &mut Vec<Command>) {
        let mut limits = self.state.study.requirements.overview;
        match requirement {
            Requirement::Bandwidth(_) => {
                let field = LimitField::in_percent("Limit of the bandwidth");
                self.field_ui(ui, &field, "\u{b1}", &mut limits.bandwidth, "%", commands);
                self.note_ui(ui, "of the identified model's bandwidth, for every axis");
            }
            Requirement::PhaseDelay(_) => {
                let field = LimitField::in_ms("Limit of the phase delay");
                self.field_ui(
                    ui,
                    &field,
                    "\u{b1}",
                    &mut limits.phase_delay_s,
                    "ms",
                    commands,
                );
                self.note_ui(
                    ui,
                    "from the identified model's phase delay, for every axis",
                );
            }
            Requirement::Level(_) => {
                self.note_ui(ui, "met if the level equals that of the identified model");
                self.note_ui(ui, "set the levels in the limits menu");
            }
            Requirement::MeanJOnAxis => {
                let field = LimitField::new("Limit of J");
                self.field_ui(ui, &field, "\u{2264}", &mut limits.mean_j, "", commands);
                self.note_ui(ui, "mean over the on-axis responses");
            }
            Requirement::MuadShareOnAxis => {
                let field = LimitField::in_percent("Minimum share inside MUAD");
                self.field_ui(
                    ui,
                    &field,
                    "\u{2265}",
                    &mut limits.muad_share,
                    "%",
                    commands,
                );
                self.note_ui(ui, "of the band, mean over the on-axis responses");
            }
            Requirement::MeanJAll => self.note_ui(ui, "no limit: shown for information"),
            Requirement::PeakError(row) => self.tolerance_ui(ui, row, commands),
            Requirement::ModeFrequency(name) => self.mode_ui(ui, name, commands),
        }
        if limits != self.state.study.requirements.overview {
            commands.push(set_limits(self.state, limits));
        }
    }

    fn note_ui(&self, ui: &mut Ui, text: &str) {
        ui.label(self.palette.small(text));
    }

    fn field_ui(
        &self,
        ui: &mut Ui,
        field: &LimitField,
        sign: &str,
        value: &mut f64,
        unit: &str,
        commands: &mut Vec<Command>,
    ) {
        ui.horizontal(|ui| {
            ui.label(sign);
            field.ui(ui, value, commands);
            ui.label(self.palette.dim(unit));
        });
    }

    /// Draws the fields for a row in the tolerance table.
    fn tolerance_ui(&self, ui: &mut Ui, index: usize, commands: &mut Vec<Command>) {
        let table = &self.state.study.requirements.tolerances;
        let mut rows = table.rows().to_vec();
        if let Some(row) = rows.get_mut(index) {
            self.tolerance_row_ui(ui, row, index + 1, commands);
        }
        if rows != table.rows() {
            commands.push(match ToleranceTable::new("edited", rows) {
                Ok(table) => set_tolerances(self.state, table),
                Err(why) => FormCommand::Refuse(Message::new(why.code(), why.to_string())).into(),
            });
        }
    }

    /// Draws the fields for a tolerance; `place` counts the rows from 1.
    fn tolerance_row_ui(
        &self,
        ui: &mut Ui,
        row: &mut Tolerance,
        place: usize,
        commands: &mut Vec<Command>,
    ) {
        ui.horizontal(|ui| {
            ui.label("\u{b1}");
            let absolute = LimitField::new(format!("Absolute tolerance {place}"));
            absolute.ui(ui, &mut row.absolute, commands);
            ui.label(self.palette.dim(&row.unit));
            ui.label("or \u{b1}");
            let relative = LimitField::in_percent(format!("Relative tolerance {place}"));
            relative.optional_ui(ui, &mut row.relative, commands);
            ui.label(self.palette.dim("% of the change"));
        });
        self.note_ui(ui, "the wider of the two, about the flown value");
        if !row.entry.is_empty() {
            self.note_ui(ui, &format!("entry {}", row.entry));
        }
    }

    /// Draws the fields for a mode's tolerances.
    fn mode_ui(&self, ui: &mut Ui, name: ModeName, commands: &mut Vec<Command>) {
        let table = &self.state.study.requirements.mode_tolerances;
        let mut rows = table.rows().to_vec();
        let Some(index) = rows.iter().position(|row| row.modes.contains(&name)) else {
            self.note_ui(ui, "the tolerance table has no entry for this mode");
            return;
        };
        self.mode_row_ui(ui, &mut rows[index], index + 1, commands);
        if rows != table.rows() {
            commands.push(match ModeToleranceTable::try_from(rows) {
                Ok(table) => set_mode_tolerances(self.state, table),
                Err(why) => {
                    let message = Message::new("mode-tolerance-not-positive", why.to_string());
                    FormCommand::Refuse(message).into()
                }
            });
        }
    }

    /// Draws the fields for a row of mode tolerances; `place` counts the rows from 1.
    fn mode_row_ui(
        &self,
        ui: &mut Ui,
        row: &mut ModeTolerance,
        place: usize,
        commands: &mut Vec<Command>,
    ) {
        let dim = |text: &str| self.palette.dim(text);
        Grid::new("tolerances of a mode")
            .num_columns(5)
            .show(ui, |ui| {
                ui.label("period \u{b1}");
                let period = LimitField::in_percent(format!("Tolerance of the period {place}"));
                period.ui(ui, &mut row.period, commands);
                ui.label(dim("% or \u{b1}"));
                let name = format!("Tolerance of the period {place} in seconds");
                LimitField::new(name).optional_ui(ui, &mut row.period_s, commands);
                ui.label(dim("s, and"));
                ui.end_row();
                ui.label("time to half \u{b1}");
                let name = format!("Tolerance of the time to half {place}");
                LimitField::in_percent(name).ui(ui, &mut row.amplitude_time, commands);
                ui.label(dim("% or \u{b1}"));
                let name = format!("Tolerance of the damping ratio {place}");
                LimitField::new(name).ui(ui, &mut row.damping_ratio, commands);
                ui.label(dim("damping ratio"));
                ui.end_row();
            });
        self.note_ui(ui, &format!("{}, entry {}", row.response, row.entry));
    }
}

/// Returns the command that changes the time-history tolerances.
pub(super) fn set_tolerances(state: &State, tolerances: ToleranceTable) -> Command {
    requirement_edit(state, RequirementPart::Tolerances, |settings| {
        settings.tolerances = tolerances;
    })
}

/// Returns the command that changes the mode tolerances.
pub(super) fn set_mode_tolerances(state: &State, tolerances: ModeToleranceTable) -> Command {
    requirement_edit(state, RequirementPart::ModeTolerances, |settings| {
        settings.mode_tolerances = tolerances;
    })
}

/// Returns the command that changes the limits for bandwidth, phase delay and summary, or that
/// refuses a limit that is not positive.
pub(super) fn set_limits(state: &State, limits: OverviewLimits) -> Command {
    match limits.checked() {
        Ok(limits) => requirement_edit(state, RequirementPart::OverviewLimits, |settings| {
            settings.overview = limits;
        }),
        Err(why) => FormCommand::Refuse(Message::new("limit-not-positive", why.to_string())).into(),
    }
}
