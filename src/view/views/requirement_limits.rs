//! The tables that requirements are asked with, in fields: tolerances of time histories and of modes, limits of the overview (M17).

use egui::{Button, Grid, Ui};
use gdcm_core::requirements::{ModeToleranceTable, ToleranceTable};
use gdcm_core::study::OverviewLimits;
use gdcm_core::units::{number, s_to_ms};

use super::decided;
use crate::view::command::{Command, RequirementTable};
use crate::view::controls::{button_ui, number_entry_ui};
use crate::view::palette::Palette;
use crate::view::state::State;

/// Width of a field \[pt\].
const FIELD: f32 = 56.0;

/// A number without the last digits that a unit left behind.
fn shown(value: f64) -> String {
    number((1e9 * value).round() / 1e9)
}

/// A field of a number; what was typed where that is another one.
fn field_ui(ui: &mut Ui, name: &str, value: f64, commands: &mut Vec<Command>) -> Option<f64> {
    number_entry_ui(ui, name, &shown(value), "", FIELD, commands).flatten()
}

/// The same that may stay empty.
fn optional_field_ui(ui: &mut Ui, name: &str, value: Option<f64>, commands: &mut Vec<Command>) -> Option<Option<f64>> {
    number_entry_ui(ui, name, &value.map_or_else(String::new, shown), "none", FIELD, commands)
}

/// Every row of the table of tolerances of time histories.
pub fn tolerances_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let table = &state.study.requirements.tolerances;
    let to = |tolerances: ToleranceTable| decided(state, "tolerances", |settings| settings.tolerances = tolerances);
    ui.horizontal_wrapped(|ui| {
        ui.label(palette.small(format!("Source: {}", table.source())));
        let is_default = *table == ToleranceTable::default();
        if ui.add_enabled(!is_default, Button::new("Default tolerances").small()).clicked() {
            commands.push(to(ToleranceTable::default()));
        }
        let hint = "Take the tolerances of a file into the study";
        let ask = Command::AskRequirementTable(RequirementTable::Tolerances);
        button_ui(ui, Button::new("Open tolerances…").small(), hint, ask, commands);
        let hint = "Write them to a file of their own, for other studies";
        button_ui(ui, Button::new("Save tolerances…").small(), hint, Command::AskWriteTolerances, commands);
    });
    let mut rows = table.rows().to_vec();
    let mut is_changed = false;
    Grid::new("tolerances in fields").num_columns(5).show(ui, |ui| {
        for (row, place) in rows.iter_mut().zip(1..) {
            ui.label(palette.small(format!("{} of {}", row.quantity, row.channel)));
            if let Some(value) = field_ui(ui, &format!("Absolute tolerance {place}"), row.absolute, commands) {
                (row.absolute, is_changed) = (value, true);
            }
            ui.label(palette.small(&row.unit));
            let percent = row.relative.map(|part| 100.0 * part);
            if let Some(value) = optional_field_ui(ui, &format!("Relative tolerance {place}"), percent, commands) {
                (row.relative, is_changed) = (value.map(|percent| 0.01 * percent), true);
            }
            ui.label(palette.small(format!("% of the change · {}", row.entry)));
            ui.end_row();
        }
    });
    if is_changed {
        commands.push(match ToleranceTable::new("edited", rows) {
            Ok(table) => to(table),
            Err(why) => Command::Refuse(why.to_string()),
        });
    }
}

/// Every row of the table of tolerances of modes.
pub fn mode_tolerances_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let table = &state.study.requirements.mode_tolerances;
    let to =
        |table: ModeToleranceTable| decided(state, "tolerances of modes", |settings| settings.mode_tolerances = table);
    let is_default = *table == ModeToleranceTable::default();
    if ui.add_enabled(!is_default, Button::new("Default tolerances of modes").small()).clicked() {
        commands.push(to(ModeToleranceTable::default()));
    }
    let mut rows = table.rows().to_vec();
    let mut is_changed = false;
    Grid::new("tolerances of modes in fields").num_columns(5).show(ui, |ui| {
        for heading in ["response", "period [%]", "or [s]", "time to half [%]", "or damping ratio"] {
            ui.label(palette.small(heading));
        }
        ui.end_row();
        for (row, place) in rows.iter_mut().zip(1..) {
            ui.label(palette.small(format!("{} · {}", row.response, row.entry)));
            if let Some(percent) =
                field_ui(ui, &format!("Tolerance of the period {place}"), 100.0 * row.period, commands)
            {
                (row.period, is_changed) = (0.01 * percent, true);
            }
            let name = format!("Tolerance of the period {place} in seconds");
            if let Some(seconds) = optional_field_ui(ui, &name, row.period_s, commands) {
                (row.period_s, is_changed) = (seconds, true);
            }
            let name = format!("Tolerance of the time to half {place}");
            if let Some(percent) = field_ui(ui, &name, 100.0 * row.amplitude_time, commands) {
                (row.amplitude_time, is_changed) = (0.01 * percent, true);
            }
            let name = format!("Tolerance of the damping ratio {place}");
            if let Some(ratio) = field_ui(ui, &name, row.damping_ratio, commands) {
                (row.damping_ratio, is_changed) = (ratio, true);
            }
            ui.end_row();
        }
    });
    if is_changed {
        commands.push(match ModeToleranceTable::try_from(rows) {
            Ok(table) => to(table),
            Err(why) => Command::Refuse(why.to_string()),
        });
    }
}

/// From where on the overview says that a corrected model is far from the identified one.
pub fn overview_limits_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let limits = state.study.requirements.overview;
    let mut changed = limits;
    ui.horizontal_wrapped(|ui| {
        ui.label(palette.small("Of no standard: bandwidth ±"));
        if let Some(percent) = field_ui(ui, "Limit of the bandwidth", 100.0 * limits.bandwidth, commands) {
            changed.bandwidth = 0.01 * percent;
        }
        ui.label(palette.small("%, phase delay ±"));
        if let Some(delay_ms) = field_ui(ui, "Limit of the phase delay", s_to_ms(limits.phase_delay_s), commands) {
            changed.phase_delay_s = 1e-3 * delay_ms;
        }
        ui.label(palette.small("ms, time inside at least"));
        if let Some(percent) = field_ui(ui, "Least time inside", 100.0 * limits.share_inside, commands) {
            changed.share_inside = 0.01 * percent;
        }
        ui.label(palette.small("%"));
    });
    if changed != limits {
        commands.push(match changed.checked() {
            Ok(limits) => decided(state, "limits of the overview", |settings| settings.overview = limits),
            Err(why) => Command::Refuse(why.to_string()),
        });
    }
    if limits != OverviewLimits::default() && ui.small_button("Default limits").clicked() {
        let default =
            |settings: &mut gdcm_core::study::RequirementSettings| settings.overview = OverviewLimits::default();
        commands.push(decided(state, "limits of the overview", default));
    }
}
