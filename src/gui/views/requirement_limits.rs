//! Tables of editable limits: tolerances of time histories, tolerances of modes, limits of the
//! overview (M17); and the command for each change.

use std::sync::Arc;

use egui::{Button, Grid, Ui};

use gdcm_method::requirements::{ModeToleranceTable, ToleranceTable};
use gdcm_study::Edit;
use gdcm_study::decisions::requirement_settings::{
    OverviewLimits, RequirementPart, RequirementSettings,
};

use super::limit_field::LimitField;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::forms::RequirementTable;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::button_ui;
use crate::gui::widgets::palette::Palette;
use crate::message::Message;

/// Draws the tolerances of time histories, row by row.
pub fn tolerances_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let table = &state.study.requirements.tolerances;
    ui.horizontal_wrapped(|ui| {
        ui.label(palette.small(format!("Source: {}", table.source())));
        let is_default = *table == ToleranceTable::default();
        if ui
            .add_enabled(!is_default, Button::new("Default tolerances").small())
            .clicked()
        {
            commands.push(set_tolerances(state, ToleranceTable::default()));
        }
        button_ui(
            ui,
            Button::new("Open tolerances…").small(),
            "Reads the tolerances from a file into the study",
            FileCommand::AskRequirementTable(RequirementTable::Tolerances),
            commands,
        );
        button_ui(
            ui,
            Button::new("Save tolerances…").small(),
            "Writes the tolerances to a file for other studies",
            FileCommand::AskWriteTolerances,
            commands,
        );
    });
    let mut rows = table.rows().to_vec();
    Grid::new("tolerances in fields")
        .num_columns(5)
        .show(ui, |ui| {
            for (row, place) in rows.iter_mut().zip(1..) {
                ui.label(palette.small(format!("{} of {}", row.quantity, row.channel)));
                let absolute = LimitField::new(format!("Absolute tolerance {place}"));
                absolute.ui(ui, &mut row.absolute, commands);
                ui.label(palette.small(&row.unit));
                let relative = LimitField::in_percent(format!("Relative tolerance {place}"));
                relative.optional_ui(ui, &mut row.relative, commands);
                ui.label(palette.small(format!("% of the change · {}", row.entry)));
                ui.end_row();
            }
        });
    if rows != table.rows() {
        commands.push(match ToleranceTable::new("edited", rows) {
            Ok(table) => set_tolerances(state, table),
            Err(why) => FormCommand::Refuse(Message::new(why.code(), why.to_string())).into(),
        });
    }
}

/// Returns the command that changes the tolerances of time histories.
fn set_tolerances(state: &State, tolerances: ToleranceTable) -> Command {
    requirement_edit(state, RequirementPart::Tolerances, |settings| {
        settings.tolerances = tolerances;
    })
}

/// Draws the tolerances of modes, row by row.
pub fn mode_tolerances_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let table = &state.study.requirements.mode_tolerances;
    let is_default = *table == ModeToleranceTable::default();
    let button = Button::new("Default tolerances of modes").small();
    if ui.add_enabled(!is_default, button).clicked() {
        commands.push(set_mode_tolerances(state, ModeToleranceTable::default()));
    }
    let mut rows = table.rows().to_vec();
    Grid::new("tolerances of modes in fields")
        .num_columns(5)
        .show(ui, |ui| {
            for heading in [
                "response",
                "period [%]",
                "or [s]",
                "time to half [%]",
                "or damping ratio",
            ] {
                ui.label(palette.small(heading));
            }
            ui.end_row();
            for (row, place) in rows.iter_mut().zip(1..) {
                ui.label(palette.small(format!("{} · {}", row.response, row.entry)));
                let period = LimitField::in_percent(format!("Tolerance of the period {place}"));
                period.ui(ui, &mut row.period, commands);
                let period_s =
                    LimitField::new(format!("Tolerance of the period {place} in seconds"));
                period_s.optional_ui(ui, &mut row.period_s, commands);
                let amplitude_time =
                    LimitField::in_percent(format!("Tolerance of the time to half {place}"));
                amplitude_time.ui(ui, &mut row.amplitude_time, commands);
                let damping = LimitField::new(format!("Tolerance of the damping ratio {place}"));
                damping.ui(ui, &mut row.damping_ratio, commands);
                ui.end_row();
            }
        });
    if rows != table.rows() {
        commands.push(match ModeToleranceTable::try_from(rows) {
            Ok(table) => set_mode_tolerances(state, table),
            Err(why) => {
                FormCommand::Refuse(Message::new("mode-tolerance-not-positive", why.to_string()))
                    .into()
            }
        });
    }
}

/// Returns the command that changes the tolerances of modes.
fn set_mode_tolerances(state: &State, tolerances: ModeToleranceTable) -> Command {
    requirement_edit(state, RequirementPart::ModeTolerances, |settings| {
        settings.mode_tolerances = tolerances;
    })
}

/// Draws the limits beyond which the overview marks a corrected model as too far from the
/// identified model.
pub fn overview_limits_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let limits = state.study.requirements.overview;
    let mut changed = limits;
    ui.horizontal_wrapped(|ui| {
        ui.label(palette.small("Limits of this program, not of a standard: bandwidth ±"));
        let bandwidth = LimitField::in_percent("Limit of the bandwidth");
        bandwidth.ui(ui, &mut changed.bandwidth, commands);
        ui.label(palette.small("%, phase delay ±"));
        let phase_delay = LimitField::in_ms("Limit of the phase delay");
        phase_delay.ui(ui, &mut changed.phase_delay_s, commands);
        ui.label(palette.small("ms, time within tolerance at least"));
        let share_inside = LimitField::in_percent("Minimum time within tolerance");
        share_inside.ui(ui, &mut changed.share_inside, commands);
        ui.label(palette.small("%"));
    });
    if changed != limits {
        commands.push(match changed.checked() {
            Ok(limits) => set_overview_limits(state, limits),
            Err(why) => {
                FormCommand::Refuse(Message::new("limit-not-positive", why.to_string())).into()
            }
        });
    }
    if limits != OverviewLimits::default() && ui.small_button("Default limits").clicked() {
        commands.push(set_overview_limits(state, OverviewLimits::default()));
    }
}

/// Returns the command that changes the limits of the overview.
fn set_overview_limits(state: &State, limits: OverviewLimits) -> Command {
    requirement_edit(state, RequirementPart::OverviewLimits, |settings| {
        settings.overview = limits;
    })
}

/// Returns the command that changes a part of the settings of the requirements.
pub fn requirement_edit(
    state: &State,
    part: RequirementPart,
    change: impl FnOnce(&mut RequirementSettings),
) -> Command {
    let mut settings = RequirementSettings::clone(&state.study.requirements);
    change(&mut settings);
    Edit::SetRequirements(part, Arc::new(settings)).into()
}
