//! Which columns of a record are its time and its channels, and how late each is logged.

use egui::{ComboBox, Grid, RichText, Role as AccessRole, ScrollArea, Ui, WidgetInfo};

use crate::view::assembling::{entry_ui, typed_number};
use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::state::State;
use gdcm_core::identification::{Role, Signal};
use gdcm_core::records::{ColumnUse, RecordLayout, TimeBase};
use gdcm_core::units::{ms_to_s, number, s_to_ms};

use super::bench::{ConditionRecords, RecordRow, RecordsCommand};

const FIELD_WIDTH: f32 = 90.0;

/// A line for the time and for each channel: column, factor, delay.
pub(super) fn columns_ui(
    ui: &mut Ui,
    state: &State,
    records: &ConditionRecords,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(row) = records.rows.get(records.chosen) else { return };
    let small = |text: &str| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    ui.label(small("What is said here holds for every record of the condition that has columns of these names."));
    ScrollArea::vertical().id_salt("columns of a record").auto_shrink(false).show(ui, |ui| {
        Grid::new("columns of a record").num_columns(4).striped(true).spacing([10.0, 4.0]).show(ui, |ui| {
            for heading in ["channel", "column of the file", "times", "logged late [ms]"] {
                ui.label(small(heading));
            }
            ui.end_row();
            time_row_ui(ui, records.chosen, row, commands);
            let dataset = state.dataset();
            for (role, channels) in [(Role::Input, dataset.inputs()), (Role::Output, dataset.outputs())] {
                for (index, channel) in channels.iter().enumerate() {
                    let signal = Signal { role, index, name: channel.name.clone() };
                    channel_row_ui(ui, records, &signal, &channel.unit, commands);
                }
            }
        });
        for note in &row.table.notes {
            ui.label(small(note));
        }
    });
}

fn time_row_ui(ui: &mut Ui, record: usize, row: &RecordRow, commands: &mut Vec<Command>) {
    ui.label("time [s]");
    let (chosen, seconds) = match row.layout.time {
        Some(TimeBase::Column { column, seconds }) => (Some(column), seconds),
        _ => (None, 1.0),
    };
    if let Some(column) = column_ui(ui, "Column of the time", row, chosen) {
        let layout = RecordLayout { time: Some(TimeBase::Column { column, seconds }), ..row.layout.clone() };
        commands.push(RecordsCommand::SetLayout(record, layout).into());
    }
    let typed = entry_ui(ui, "Seconds of a unit of time", &number(seconds), "1", FIELD_WIDTH);
    match (typed.map(|text| typed_number(&text)), chosen) {
        (Some(Ok(Some(seconds))), Some(column)) => {
            let layout = RecordLayout { time: Some(TimeBase::Column { column, seconds }), ..row.layout.clone() };
            commands.push(RecordsCommand::SetLayout(record, layout).into());
        }
        (Some(Err(why)), _) => commands.push(Command::Refuse(why)),
        _ => {}
    }
    ui.end_row();
}

fn channel_row_ui(ui: &mut Ui, records: &ConditionRecords, signal: &Signal, unit: &str, commands: &mut Vec<Command>) {
    let record = records.chosen;
    let row = &records.rows[record];
    let name = &signal.name;
    ui.label(format!("{name} [{unit}]"));
    let uses = match signal.role {
        Role::Input => &row.layout.inputs,
        Role::Output => &row.layout.outputs,
    };
    let used = uses.get(signal.index).copied().flatten();
    let with = |used: ColumnUse| {
        let mut layout = row.layout.clone();
        let uses = match signal.role {
            Role::Input => &mut layout.inputs,
            Role::Output => &mut layout.outputs,
        };
        if let Some(place) = uses.get_mut(signal.index) {
            *place = Some(used);
        }
        RecordsCommand::SetLayout(record, layout)
    };
    let factor = used.map_or(1.0, |used| used.factor);
    if let Some(column) = column_ui(ui, &format!("Column of {name}"), row, used.map(|used| used.column)) {
        commands.push(with(ColumnUse { column, factor }).into());
    }
    let typed = entry_ui(ui, &format!("Factor of the column of {name}"), &number(factor), "1", FIELD_WIDTH);
    match (typed.map(|text| typed_number(&text)), used) {
        (Some(Ok(Some(factor))), Some(used)) => commands.push(with(ColumnUse { factor, ..used }).into()),
        (Some(Err(why)), _) => commands.push(Command::Refuse(why)),
        _ => {}
    }
    let channels = match signal.role {
        Role::Input => &records.inputs,
        Role::Output => &records.outputs,
    };
    let delay_s = channels.get(signal.index).map_or(0.0, |channel| channel.delay_s);
    let label = format!("Delay of {name}");
    match entry_ui(ui, &label, &number(s_to_ms(delay_s)), "0", FIELD_WIDTH).map(|text| typed_number(&text)) {
        Some(Ok(delay)) => {
            commands.push(RecordsCommand::SetDelay(signal.clone(), ms_to_s(delay.unwrap_or(0.0))).into());
        }
        Some(Err(why)) => commands.push(Command::Refuse(why)),
        None => {}
    }
    ui.end_row();
}

/// A choice among the columns of a record; what was chosen anew.
fn column_ui(ui: &mut Ui, name: &str, row: &RecordRow, chosen: Option<usize>) -> Option<usize> {
    let words = |column: usize| {
        row.table.columns.get(column).map_or("?".to_owned(), |of| match &of.unit {
            Some(unit) => format!("{} [{unit}]", of.name),
            None => of.name.clone(),
        })
    };
    let mut taken = None;
    let shown = ComboBox::from_id_salt(name).width(150.0).selected_text(chosen.map_or("?".to_owned(), words));
    let shown = shown.show_ui(ui, |ui| {
        for column in 0..row.table.columns.len() {
            if ui.selectable_label(chosen == Some(column), words(column)).clicked() {
                taken = Some(column);
            }
        }
    });
    shown.response.widget_info(|| WidgetInfo::labeled(AccessRole::ComboBox, true, name));
    taken
}
