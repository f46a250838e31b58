//! Editors for requirement limits: the fields for one grid row, and the menu with everything that
//! determines the limits (M17: docs/requirements.md).

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, Grid, Popup, PopupCloseBehavior, Response, Ui};

use gdcm_method::requirements::mode_comparison::ModeTolerance;
use gdcm_method::requirements::{ModeName, ModeToleranceTable, Tolerance, ToleranceTable};
use gdcm_study::decisions::requirement_settings::{OverviewLimits, RequirementPart};
use gdcm_study::results::grid_requirement::Requirement;

use super::bandwidth_settings::{bandwidth_inputs_ui, standard_levels_ui};
use super::limit_field::LimitField;
use super::requirement_edits::requirement_edit;
use super::requirement_selection::requirement_names;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::forms::RequirementTable;
use crate::gui::state::requirements_display::RequirementsDisplay;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{button_ui, named};
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
        ui.label(egui::RichText::new(&name).font(medium(BODY_SIZE)));
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
                let field = LimitField::in_percent("Least share inside MUAD");
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

/// Draws the limits menu: tolerance tables, axes with attitude command, level boundaries.
pub(super) fn limits_menu_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let settings = &state.study.requirements;
    let is_default = settings.tolerances == ToleranceTable::default()
        && settings.mode_tolerances == ModeToleranceTable::default()
        && settings.overview == OverviewLimits::default();
    let text = if is_default {
        "limits: default \u{23f7}"
    } else {
        "limits: edited \u{23f7}"
    };
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) = MenuButton::from_button(Button::new(text))
        .config(config)
        .ui(ui, |ui| {
            ui.set_max_width(420.0);
            menu_content_ui(ui, state, palette, commands);
        });
    named(button, egui::Role::Button, "Limits of the requirements");
}

fn menu_content_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let settings = &state.study.requirements;
    let source = settings.tolerances.source();
    ui.label(palette.small(format!("Tolerances in time: {source}")));
    ui.label(
        palette
            .small("Bandwidth, phase delay and summary: limits of this program, not of a standard"),
    );
    ui.label(palette.small("Double click on a limit of the grid to edit it"));
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        let is_default = settings.tolerances == ToleranceTable::default();
        let button = Button::new("Default tolerances").small();
        if ui.add_enabled(!is_default, button).clicked() {
            commands.push(set_tolerances(state, ToleranceTable::default()));
        }
        let is_default = settings.mode_tolerances == ModeToleranceTable::default();
        let button = Button::new("Default tolerances of modes").small();
        if ui.add_enabled(!is_default, button).clicked() {
            commands.push(set_mode_tolerances(state, ModeToleranceTable::default()));
        }
        let is_default = settings.overview == OverviewLimits::default();
        let button = Button::new("Default limits").small();
        if ui.add_enabled(!is_default, button).clicked() {
            commands.push(set_limits(state, OverviewLimits::default()));
        }
    });
    ui.horizontal_wrapped(|ui| {
        button_ui(
            ui,
            Button::new("Open tolerances…").small(),
            "Reads the tolerances in time from a file into the study",
            FileCommand::AskRequirementTable(RequirementTable::Tolerances),
            commands,
        );
        button_ui(
            ui,
            Button::new("Save tolerances…").small(),
            "Writes the tolerances in time to a file for other studies",
            FileCommand::AskWriteTolerances,
            commands,
        );
    });
    ui.separator();
    bandwidth_inputs_ui(ui, state, palette, commands);
    standard_levels_ui(ui, state, commands);
}

/// Returns the command that changes the time-history tolerances.
fn set_tolerances(state: &State, tolerances: ToleranceTable) -> Command {
    requirement_edit(state, RequirementPart::Tolerances, |settings| {
        settings.tolerances = tolerances;
    })
}

/// Returns the command that changes the mode tolerances.
fn set_mode_tolerances(state: &State, tolerances: ModeToleranceTable) -> Command {
    requirement_edit(state, RequirementPart::ModeTolerances, |settings| {
        settings.mode_tolerances = tolerances;
    })
}

/// Returns the command that changes the limits for bandwidth, phase delay and summary, or that
/// refuses a limit that is not positive.
fn set_limits(state: &State, limits: OverviewLimits) -> Command {
    match limits.checked() {
        Ok(limits) => requirement_edit(state, RequirementPart::OverviewLimits, |settings| {
            settings.overview = limits;
        }),
        Err(why) => FormCommand::Refuse(Message::new("limit-not-positive", why.to_string())).into(),
    }
}
