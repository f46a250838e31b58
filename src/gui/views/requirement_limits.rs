//! Editable tables of the requirements: tolerances of time histories and of modes, limits of the
//! overview (M17).

use std::sync::Arc;

use egui::{Button, Grid, Ui};

use gdcm_method::requirements::{ModeToleranceTable, ToleranceTable};
use gdcm_model::units::number;
use gdcm_study::Edit;
use gdcm_study::decisions::requirement_settings::{OverviewLimits, RequirementSettings};

use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::forms::RequirementTable;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{button_ui, number_entry_ui};
use crate::gui::widgets::palette::Palette;

/// Width of a field \[pt\].
const FIELD: f32 = 56.0;

/// Rounds away the last digits introduced by a unit conversion.
fn shown(value: f64) -> String {
    number((1e9 * value).round() / 1e9)
}

/// Factors from the stored to the displayed number, and to the typed number.
const AS_IT_IS: [f64; 2] = [1.0, 1.0];
const IN_PERCENT: [f64; 2] = [100.0, 0.01];
const IN_MILLISECONDS: [f64; 2] = [1e3, 1e-3];

/// Draws a number field; returns the typed number.
fn field_ui(
    ui: &mut Ui,
    name: &str,
    value: &mut f64,
    [to, from]: [f64; 2],
    commands: &mut Vec<Command>,
) {
    if let Some(typed) =
        number_entry_ui(ui, name, &shown(to * *value), "", FIELD, commands).flatten()
    {
        *value = from * typed;
    }
}

/// As `field_ui`, for a field that may be empty.
fn optional_field_ui(
    ui: &mut Ui,
    name: &str,
    value: &mut Option<f64>,
    [to, from]: [f64; 2],
    commands: &mut Vec<Command>,
) {
    let text = value.map_or_else(String::new, |value| shown(to * value));
    if let Some(typed) = number_entry_ui(ui, name, &text, "none", FIELD, commands) {
        *value = typed.map(|typed| from * typed);
    }
}

/// Draws every row of the tolerances of time histories.
pub fn tolerances_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let table = &state.study.requirements.tolerances;
    let to = |tolerances: ToleranceTable| {
        decided(state, "tolerances", |settings| {
            settings.tolerances = tolerances
        })
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(palette.small(format!("Source: {}", table.source())));
        let is_default = *table == ToleranceTable::default();
        if ui
            .add_enabled(!is_default, Button::new("Default tolerances").small())
            .clicked()
        {
            commands.push(to(ToleranceTable::default()));
        }
        let hint = "Take the tolerances of a file into the study";
        let ask = Command::File(FileCommand::AskRequirementTable(
            RequirementTable::Tolerances,
        ));
        button_ui(
            ui,
            Button::new("Open tolerances…").small(),
            hint,
            ask,
            commands,
        );
        let hint = "Write them to a file of their own, for other studies";
        button_ui(
            ui,
            Button::new("Save tolerances…").small(),
            hint,
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
                field_ui(
                    ui,
                    &format!("Absolute tolerance {place}"),
                    &mut row.absolute,
                    AS_IT_IS,
                    commands,
                );
                ui.label(palette.small(&row.unit));
                optional_field_ui(
                    ui,
                    &format!("Relative tolerance {place}"),
                    &mut row.relative,
                    IN_PERCENT,
                    commands,
                );
                ui.label(palette.small(format!("% of the change · {}", row.entry)));
                ui.end_row();
            }
        });
    if rows != table.rows() {
        commands.push(match ToleranceTable::new("edited", rows) {
            Ok(table) => to(table),
            Err(why) => Command::Form(FormCommand::Refuse(why.to_string())),
        });
    }
}

/// Draws every row of the tolerances of modes.
pub fn mode_tolerances_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let table = &state.study.requirements.mode_tolerances;
    let to = |table: ModeToleranceTable| {
        decided(state, "tolerances of modes", |settings| {
            settings.mode_tolerances = table
        })
    };
    let is_default = *table == ModeToleranceTable::default();
    if ui
        .add_enabled(
            !is_default,
            Button::new("Default tolerances of modes").small(),
        )
        .clicked()
    {
        commands.push(to(ModeToleranceTable::default()));
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
                field_ui(
                    ui,
                    &format!("Tolerance of the period {place}"),
                    &mut row.period,
                    IN_PERCENT,
                    commands,
                );
                let name = format!("Tolerance of the period {place} in seconds");
                optional_field_ui(ui, &name, &mut row.period_s, AS_IT_IS, commands);
                let name = format!("Tolerance of the time to half {place}");
                field_ui(ui, &name, &mut row.amplitude_time, IN_PERCENT, commands);
                let name = format!("Tolerance of the damping ratio {place}");
                field_ui(ui, &name, &mut row.damping_ratio, AS_IT_IS, commands);
                ui.end_row();
            }
        });
    if rows != table.rows() {
        commands.push(match ModeToleranceTable::try_from(rows) {
            Ok(table) => to(table),
            Err(why) => Command::Form(FormCommand::Refuse(why.to_string())),
        });
    }
}

/// Draws the limits beyond which the overview reports that a corrected model is far from the
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
        ui.label(palette.small("Of no standard: bandwidth ±"));
        field_ui(
            ui,
            "Limit of the bandwidth",
            &mut changed.bandwidth,
            IN_PERCENT,
            commands,
        );
        ui.label(palette.small("%, phase delay ±"));
        field_ui(
            ui,
            "Limit of the phase delay",
            &mut changed.phase_delay_s,
            IN_MILLISECONDS,
            commands,
        );
        ui.label(palette.small("ms, time inside at least"));
        field_ui(
            ui,
            "Least time inside",
            &mut changed.share_inside,
            IN_PERCENT,
            commands,
        );
        ui.label(palette.small("%"));
    });
    if changed != limits {
        commands.push(match changed.checked() {
            Ok(limits) => decided(state, "limits of the overview", |settings| {
                settings.overview = limits
            }),
            Err(why) => Command::Form(FormCommand::Refuse(why.to_string())),
        });
    }
    if limits != OverviewLimits::default() && ui.small_button("Default limits").clicked() {
        commands.push(decided(state, "limits of the overview", |settings| {
            settings.overview = OverviewLimits::default()
        }));
    }
}

/// Returns the command that changes the inputs of the requirements.
pub fn decided(
    state: &State,
    what: &'static str,
    change: impl FnOnce(&mut RequirementSettings),
) -> Command {
    let mut settings = RequirementSettings::clone(&state.study.requirements);
    change(&mut settings);
    Edit::SetRequirements(what, Arc::new(settings)).into()
}
