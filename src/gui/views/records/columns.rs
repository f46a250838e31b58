//! Page Columns: assignment of the displayed record's columns to the channels, with factor and time
//! skew (the delay with which a channel is logged). Columns and factors apply to all records with
//! the same columns, the common skew to all records, and the last two fields (a remedy) to the
//! displayed record.

use egui::{Grid, ScrollArea, Ui};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::number_format::counted;
use gdcm_model::simulation::Signal;
use gdcm_model::units::{ms_to_s, number, s_to_ms};
use gdcm_sysid::identification::ChannelPreparation;
use gdcm_sysid::records::column_use::UnitBasis;
use gdcm_sysid::records::time_base::TimeBase;
use gdcm_sysid::records::{ColumnUse, LaidOutRecord, RecordLayout};

use super::page::Page;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::column_groups::RecordPlace;
use crate::gui::widgets::choices::DropDown;
use crate::gui::widgets::controls::Asks;
use crate::gui::widgets::number_entry::number_entry_ui;

const FIELD_WIDTH: f32 = 90.0;
/// Width of fields that apply only to the displayed record \[pt\].
const RECORD_FIELD_WIDTH: f32 = 60.0;

const HEADINGS: [(&str, &str); 6] = [
    ("channel", "Channel of the dataset"),
    ("column of the file", "Column with the channel's samples"),
    (
        "factor",
        "Converts the unit of the file to the unit of the dataset",
    ),
    (
        "time skew [ms]",
        "Logging delay of the channel, in every record",
    ),
    (
        "skew, this record [ms]",
        "Additional logging delay in this record only",
    ),
    (
        "factor, this record",
        "Additional factor in this record only; -1 reverses the sign",
    ),
];

/// Shows a row for the time and for each channel.
pub(super) fn columns_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        records, palette, ..
    } = page;
    let Some(row) = records.rows.get(records.chosen) else {
        return;
    };
    scope_ui(ui, page, row, commands);
    ScrollArea::vertical()
        .id_salt("columns of a record")
        .auto_shrink(false)
        .show(ui, |ui| {
            Grid::new("columns of a record")
                .num_columns(6)
                .striped(true)
                .spacing([10.0, 4.0])
                .show(ui, |ui| {
                    for (heading, hint) in HEADINGS {
                        ui.label(palette.small(heading)).on_hover_text(hint);
                    }
                    ui.end_row();
                    time_row_ui(ui, records.chosen, row, commands);
                    channel_rows_ui(ui, page, row, commands);
                });
            for note in &row.table.notes {
                ui.label(palette.small(note));
            }
        });
}

/// Shows to which records the page applies, and a caution about their assumed units.
fn scope_ui(ui: &mut Ui, page: Page<'_>, row: &LaidOutRecord, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let place = RecordPlace {
        condition: state.condition().id(),
        row: records.chosen,
    };
    let group = state.records.group_of(place);
    let (count, conditions) = match &group {
        Some(group) => (group.records, group.conditions.len()),
        None => (1, 1),
    };
    let mut words = format!(
        "{}: these settings apply to {}",
        row.table.name,
        counted(count, "record")
    );
    if conditions > 1 {
        words.push_str(&format!(" of {conditions} conditions"));
    }
    words.push_str(
        " with the same file columns; \"skew, this record\" and \"factor, this record\" apply to \
        this record only",
    );
    ui.label(palette.small(words));
    if let Some(group) = &group
        && !group.assumed.is_empty()
    {
        ui.horizontal_wrapped(|ui| {
            let channels = group.assumed.join(", ");
            let text = format!("⚠ The files do not give the units of {channels}: choose them, or");
            ui.label(palette.small_warning(text));
            ui.button("Confirm the dataset's units")
                .on_hover_text("For the records of all conditions; can be undone in one step")
                .asks(RecordsCommand::ConfirmUnits, commands);
        });
    }
}

/// Shows the time column and its conversion factor to seconds.
fn time_row_ui(ui: &mut Ui, record: usize, row: &LaidOutRecord, commands: &mut Vec<Command>) {
    ui.label("time [s]");
    let (chosen, seconds) = match row.layout.time {
        Some(TimeBase::Column { column, seconds }) => (Some(column), seconds),
        _ => (None, 1.0),
    };
    if let Some(column) = column_ui(ui, "Column of the time", row, chosen) {
        commands.push(time_command(record, row, column, seconds));
    }
    let value = number(seconds);
    let name = "Seconds per unit of time";
    let typed = number_entry_ui(ui, name, &value, "1", FIELD_WIDTH, commands);
    if let Some(Some(seconds)) = typed
        && let Some(column) = chosen
    {
        commands.push(time_command(record, row, column, seconds));
    }
    ui.end_row();
}

fn time_command(record: usize, row: &LaidOutRecord, column: usize, seconds: f64) -> Command {
    let layout = RecordLayout {
        time: Some(TimeBase::Column { column, seconds }),
        ..row.layout.clone()
    };
    RecordsCommand::SetLayout(record, layout).into()
}

fn channel_rows_ui(ui: &mut Ui, page: Page<'_>, row: &LaidOutRecord, commands: &mut Vec<Command>) {
    let Page { state, records, .. } = page;
    let dataset = state.dataset();
    for (role, channels, preparations) in [
        (ChannelSide::Input, dataset.inputs(), &records.inputs),
        (ChannelSide::Output, dataset.outputs(), &records.outputs),
    ] {
        for (index, channel) in channels.iter().enumerate() {
            let uses = match role {
                ChannelSide::Input => &row.layout.inputs,
                ChannelSide::Output => &row.layout.outputs,
            };
            let channel_row = ChannelRow {
                record: records.chosen,
                row,
                signal: Signal {
                    role,
                    index,
                    name: channel.name.clone(),
                },
                unit: &channel.unit,
                column_use: uses.get(index).copied().flatten(),
                preparation: preparations.get(index),
            };
            channel_row.show(ui, commands);
        }
    }
}

/// Channel in the displayed record.
struct ChannelRow<'a> {
    record: usize,
    row: &'a LaidOutRecord,
    signal: Signal,
    /// Unit in the dataset.
    unit: &'a str,
    column_use: Option<ColumnUse>,
    preparation: Option<&'a ChannelPreparation>,
}

impl ChannelRow<'_> {
    fn show(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        ui.label(format!("{} [{}]", self.signal.name, self.unit));
        self.column_ui(ui, commands);
        self.factor_ui(ui, commands);
        self.skew_ui(ui, commands);
        if let Some(column_use) = self.column_use {
            self.remedy_ui(ui, column_use.remedy, commands);
        }
        ui.end_row();
    }

    fn column_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let name = format!("Column of {}", self.signal.name);
        let chosen = self.column_use.map(|column_use| column_use.column);
        if let Some(column) = column_ui(ui, &name, self.row, chosen) {
            let column_use = ColumnUse::by_unit(&self.row.table, column, self.unit);
            commands.push(self.use_command(column_use));
        }
    }

    /// Shows the conversion factor to the dataset's unit. If the file does not give the unit,
    /// shows the plausible units instead: "rad/s?" if the dataset's unit is assumed, "unit?"
    /// if none is.
    fn factor_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let name = &self.signal.name;
        let open_units = match self.column_use {
            Some(column_use) => column_use.open_units(&self.row.table, self.unit),
            None => Vec::new(),
        };
        if open_units.is_empty() {
            let factor = self.column_use.map_or(1.0, |column_use| column_use.factor);
            let label = format!("Unit conversion factor of {name}");
            let typed = number_entry_ui(ui, &label, &number(factor), "1", FIELD_WIDTH, commands);
            if let Some(Some(factor)) = typed
                && let Some(column_use) = self.column_use
            {
                commands.push(self.use_command(ColumnUse {
                    factor,
                    ..column_use
                }));
            }
        } else {
            let label = format!("Unit of the column of {name}");
            let is_assumed = self
                .column_use
                .is_some_and(|column_use| column_use.unit == UnitBasis::Assumed);
            let units = open_units.into_iter().map(|unit| {
                let is_selected = is_assumed && unit == self.unit;
                (unit, is_selected, unit.to_owned())
            });
            let text = if is_assumed {
                format!("{}?", self.unit)
            } else {
                "unit?".to_owned()
            };
            let list = DropDown {
                name: &label,
                width: FIELD_WIDTH,
                text: &text,
            };
            if let Some(unit) = list.ui(ui, units)
                && let Some(column_use) = self.column_use
            {
                commands.push(self.use_command(column_use.in_unit(unit, self.unit)));
            }
        }
    }

    /// Shows the time skew common to all records.
    fn skew_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let delay_s = match self.preparation {
            Some(preparation) => preparation.delay_s,
            None => 0.0,
        };
        let label = format!("Time skew of {}", self.signal.name);
        let value = number(s_to_ms(delay_s));
        if let Some(delay_ms) = number_entry_ui(ui, &label, &value, "0", FIELD_WIDTH, commands) {
            let delay_s = ms_to_s(delay_ms.unwrap_or(0.0));
            commands.push(RecordsCommand::SetDelay(self.signal.clone(), delay_s).into());
        }
    }

    /// Shows the time skew and the factor in the displayed record only.
    fn remedy_ui(&self, ui: &mut Ui, remedy: ChannelRemedy, commands: &mut Vec<Command>) {
        let name = &self.signal.name;
        let label = format!("Time skew of {name}, this record");
        let value = number(s_to_ms(remedy.delay_s));
        let typed = number_entry_ui(ui, &label, &value, "0", RECORD_FIELD_WIDTH, commands);
        if let Some(delay_ms) = typed {
            commands.push(self.remedy_command(ChannelRemedy {
                delay_s: ms_to_s(delay_ms.unwrap_or(0.0)),
                ..remedy
            }));
        }
        let label = format!("Factor of {name}, this record");
        let value = number(remedy.factor);
        let typed = number_entry_ui(ui, &label, &value, "1", RECORD_FIELD_WIDTH, commands);
        if let Some(factor) = typed {
            commands.push(self.remedy_command(ChannelRemedy {
                factor: factor.unwrap_or(1.0),
                ..remedy
            }));
        }
    }

    /// Returns the command that assigns a column to the channel.
    fn use_command(&self, column_use: ColumnUse) -> Command {
        let mut layout = self.row.layout.clone();
        let uses = match self.signal.role {
            ChannelSide::Input => &mut layout.inputs,
            ChannelSide::Output => &mut layout.outputs,
        };
        if let Some(place) = uses.get_mut(self.signal.index) {
            *place = Some(column_use);
        }
        RecordsCommand::SetLayout(self.record, layout).into()
    }

    fn remedy_command(&self, remedy: ChannelRemedy) -> Command {
        let remedies = vec![(self.signal.clone(), remedy)];
        RecordsCommand::SetRemedies(self.record, remedies).into()
    }
}

/// Draws a column selector; returns a changed selection.
fn column_ui(ui: &mut Ui, name: &str, row: &LaidOutRecord, chosen: Option<usize>) -> Option<usize> {
    let columns = (0..row.table.columns.len())
        .map(|column| (column, chosen == Some(column), column_text(row, column)));
    let text = match chosen {
        Some(column) => column_text(row, column),
        None => "?".to_owned(),
    };
    let list = DropDown {
        name,
        width: 150.0,
        text: &text,
    };
    list.ui(ui, columns)
}

/// Returns a column's name with its unit in the file; "?" if there is no such column.
fn column_text(row: &LaidOutRecord, index: usize) -> String {
    let Some(column) = row.table.columns.get(index) else {
        return "?".to_owned();
    };
    match &column.unit {
        Some(unit) => format!("{} [{unit}]", column.name),
        None => column.name.clone(),
    }
}
