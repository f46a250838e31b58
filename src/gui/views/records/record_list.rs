//! The list of a condition's records, and the assignment of a record's columns to channels.

use egui::{
    Align, Checkbox, Grid, Label, Layout, RichText, Role as AccessRole, ScrollArea, Sense, Ui, vec2,
};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::{ChannelRemedy, RecordKind};
use gdcm_model::simulation::Signal;
use gdcm_model::units::{ms_to_s, number, s_to_ms};
use gdcm_sysid::records::record_table::TimeBase;
use gdcm_sysid::records::{ColumnUse, LaidOutRecord, LayoutProblem, RecordLayout};

use super::page::Page;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::records::ConditionRecords;
use crate::gui::widgets::choices::list_ui;
use crate::gui::widgets::controls::{Asks, elided_among, named, named_switch, number_entry_ui};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE};

/// Width of all columns except the names \[pt\].
const OTHER_COLUMNS: f32 = 124.0;
/// Minimum width of the names \[pt\].
const LEAST_NAME: f32 = 60.0;
/// Explanation of the cost of a fit.
pub(super) const CHI_SQUARED: &str = "Cost per degree of freedom of the recommended model; 1 is what noise explains (M14, section 6)";
/// Cost per degree of freedom above which the fit of a record is bad (M14, section 6).
pub(super) const BAD: f64 = 1.5;

/// Shows one line for each record: whether it is used or held out, and the fit of the model.
pub(super) fn record_list_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    if records.rows.is_empty() {
        let text = "No flight records of this condition yet. Add files or a folder above, or drop them here: CSV, text, .mat, \
                    .npz or .zip, with names for the columns.";
        ui.add(Label::new(palette.small(text)).wrap());
        if state.records.is_example {
            let text = "Of the example, the program holds the records of conditions 3 and 10; those of all are in \
                        assets/example-records.zip of its source.";
            ui.add(Label::new(palette.small(text)).wrap());
        }
        return;
    }
    let width = (ui.available_width() - OTHER_COLUMNS).max(LEAST_NAME);
    Grid::new("flight records")
        .num_columns(4)
        .spacing([6.0, 2.0])
        .striped(true)
        .show(ui, |ui| {
            for (heading, hint) in [
                ("use", "Whether anything is done with the record"),
                ("hold", "Held out: kept from the fit, to judge the model by"),
                ("record", "A click shows it"),
                ("χ²/dof", CHI_SQUARED),
            ] {
                ui.label(palette.small(heading)).on_hover_text(hint);
            }
            ui.end_row();
            for index in 0..records.rows.len() {
                row_ui(ui, page, index, width, commands);
                ui.end_row();
            }
        });
    let Some(row) = records.rows.get(records.chosen) else {
        return;
    };
    kind_ui(ui, records.chosen, row, palette, commands);
    for (words, color) in problem_words(&row.problems)
        .into_iter()
        .map(|words| (words, palette.warning))
        .chain(
            row.cautions
                .iter()
                .map(|caution| (caution.to_string(), palette.dim_text)),
        )
    {
        ui.add(Label::new(RichText::new(words).size(SMALL_SIZE).color(color)).wrap());
    }
}

/// Describes problems; those repairable on the Columns page share one sentence for each kind if
/// they concern several channels.
fn problem_words(problems: &[LayoutProblem]) -> Vec<String> {
    let mut missing = Vec::new();
    let mut unsaid = Vec::new();
    let mut others = Vec::new();
    let mut columns = "";
    for problem in problems {
        match problem {
            LayoutProblem::NoColumn { channel, found, .. } => {
                columns = found;
                missing.push((channel.as_str(), problem));
            }
            LayoutProblem::UnsaidUnit { channel, .. } => unsaid.push((channel.as_str(), problem)),
            _ => others.push(problem.to_string()),
        }
    }
    let told = |kind: Vec<(&str, &LayoutProblem)>, sentence: &dyn Fn(String) -> String| match kind[..]
    {
        [] => None,
        [(_, problem)] => Some(problem.to_string()),
        _ => Some(sentence(
            kind.iter()
                .map(|(channel, _)| *channel)
                .collect::<Vec<_>>()
                .join(", "),
        )),
    };
    let missing = told(missing, &|names| {
        format!("no column is {names}; page Columns says which are (columns: {columns})")
    });
    let unsaid = told(unsaid, &|names| {
        format!(
            "the file does not say the units of {names}, and their samples can be in several; page Columns says them"
        )
    });
    missing.into_iter().chain(unsaid).chain(others).collect()
}

fn row_ui(ui: &mut Ui, page: Page<'_>, index: usize, width: f32, commands: &mut Vec<Command>) {
    let Page {
        records, palette, ..
    } = page;
    let row = &records.rows[index];
    let name = &row.table.name;
    for (label, before, command) in [
        (
            format!("Use {name}"),
            row.used,
            RecordsCommand::SetUsed as fn(usize, bool) -> RecordsCommand,
        ),
        (
            format!("Hold out {name}"),
            row.guess.held_out,
            RecordsCommand::SetHeldOut,
        ),
    ] {
        let mut value = before;
        let shown = ui.add_enabled(row.flight.is_some(), Checkbox::without_text(&mut value));
        if named_switch(shown, AccessRole::CheckBox, value, label).changed() {
            commands.push(command(index, value).into());
        }
    }
    let is_chosen = index == records.chosen;
    let color = if row.problems.is_empty() {
        palette.text
    } else {
        palette.warning
    };
    let neighbour = |at: Option<usize>| Some(records.rows.get(at?)?.table.name.as_str());
    let neighbours = [
        neighbour(index.checked_sub(1)),
        neighbour(index.checked_add(1)),
    ];
    let shown_name = elided_among(ui, name, neighbours, width, BODY_SIZE);
    let text = RichText::new(&shown_name).size(BODY_SIZE).color(color);
    let text = if is_chosen {
        text.strong().background_color(palette.selected)
    } else {
        text
    };
    let size = vec2(width, ui.spacing().interact_size.y);
    let shown = ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_width(width);
        ui.add(Label::new(text).truncate().sense(Sense::click()))
    });
    let shown = named_switch(
        shown.inner,
        AccessRole::Button,
        is_chosen,
        format!("Record {name}"),
    );
    let shown = if shown_name == *name {
        shown
    } else {
        shown.on_hover_text(name)
    };
    shown.asks(RecordsCommand::Choose(index), commands);
    ui.horizontal(|ui| {
        ui.label(
            cost_of(records, index).map_or(RichText::new(""), |cost| cost_text(cost, palette)),
        );
        let of_it: Vec<String> = records
            .cautions()
            .filter(|(rows, _)| rows.contains(&index))
            .map(|(_, note)| note.text)
            .collect();
        if !of_it.is_empty() {
            let mark = ui.label(palette.small_warning("⚠"));
            named(
                mark.on_hover_text(of_it.join("\n\n")),
                AccessRole::Label,
                format!("Cautions of {name}"),
            );
        }
    });
}

/// Formats a cost per degree of freedom, with a warning if the fit is bad.
pub(super) fn cost_text(cost: f64, palette: &Palette) -> RichText {
    let color = match cost {
        cost if cost <= BAD => palette.text,
        _ => palette.warning,
    };
    RichText::new(format!("{cost:.2}")).color(color)
}

/// Selects the manoeuvre of a record.
fn kind_ui(
    ui: &mut Ui,
    index: usize,
    row: &LaidOutRecord,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        ui.label(palette.small(format!("{}: a", row.table.name)));
        let kinds =
            RecordKind::ALL.map(|kind| (kind, kind == row.guess.kind, kind.word().to_owned()));
        let kind = list_ui(
            ui,
            "Manoeuvre of the record",
            (90.0, row.guess.kind.word()),
            kinds,
        );
        commands.extend(kind.map(|kind| RecordsCommand::SetKind(index, kind).into()));
        if row.table.part_s.is_some() && ui.small_button("Remove part").clicked() {
            commands.push(RecordsCommand::RemovePart(index).into());
        }
    });
}

/// Returns the cost per degree of freedom of a row with the recommended model.
fn cost_of(records: &ConditionRecords, index: usize) -> Option<f64> {
    let found = records.identification().filter(|_| !records.changed)?;
    let fit = found
        .record_fits
        .iter()
        .find(|fit| records.row_of_record(fit.record) == Some(index))?;
    Some(fit.cost)
}

const FIELD_WIDTH: f32 = 90.0;
/// Width of the values that apply to the displayed record only \[pt\].
const HERE_WIDTH: f32 = 60.0;

/// Shows a line for the time and for each channel: column, factor, time skew.
pub(super) fn columns_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let Some(row) = records.rows.get(records.chosen) else {
        return;
    };
    let is_named = row.table.entry_of_dataset(state.dataset()).is_some();
    let of = if is_named {
        "of the condition"
    } else {
        "that was added, of all conditions,"
    };
    ui.label(palette.small(format!(
        "What is set here holds for every record {of} that has columns of these names."
    )));
    ScrollArea::vertical().id_salt("columns of a record").auto_shrink(false).show(ui, |ui| {
        Grid::new("columns of a record").num_columns(6).striped(true).spacing([10.0, 4.0]).show(ui, |ui| {
            for (heading, hint) in [
                ("channel", "Of the dataset"),
                ("column of the file", "Which holds it"),
                ("factor", "From the unit of the file to that of the dataset"),
                ("time skew [ms]", "How much later the channel is logged than it happened"),
                (
                    "skew, this record [ms]",
                    "How much later it is logged in this record than in the others: taken out of it alone",
                ),
                ("factor, this record", "What its samples are multiplied by in this record alone: -1 turns its sign"),
            ] {
                ui.label(palette.small(heading)).on_hover_text(hint);
            }
            ui.end_row();
            time_row_ui(ui, records.chosen, row, commands);
            let dataset = state.dataset();
            for (role, channels) in [(ChannelSide::Input, dataset.inputs()), (ChannelSide::Output, dataset.outputs())] {
                for (index, channel) in channels.iter().enumerate() {
                    let signal = Signal { role, index, name: channel.name.clone() };
                    channel_row_ui(ui, records, &signal, &channel.unit, commands);
                }
            }
        });
        for note in &row.table.notes {
            ui.label(palette.small(note));
        }
    });
}

fn time_row_ui(ui: &mut Ui, record: usize, row: &LaidOutRecord, commands: &mut Vec<Command>) {
    ui.label("time [s]");
    let (chosen, seconds) = match row.layout.time {
        Some(TimeBase::Column { column, seconds }) => (Some(column), seconds),
        _ => (None, 1.0),
    };
    let with = |column, seconds| {
        let time = Some(TimeBase::Column { column, seconds });
        RecordsCommand::SetLayout(
            record,
            RecordLayout {
                time,
                ..row.layout.clone()
            },
        )
        .into()
    };
    commands.extend(
        column_ui(ui, "Column of the time", row, chosen).map(|column| with(column, seconds)),
    );
    let typed = number_entry_ui(
        ui,
        "Seconds of a unit of time",
        &number(seconds),
        "1",
        FIELD_WIDTH,
        commands,
    );
    commands.extend(
        typed
            .flatten()
            .zip(chosen)
            .map(|(seconds, column)| with(column, seconds)),
    );
    ui.end_row();
}

fn channel_row_ui(
    ui: &mut Ui,
    records: &ConditionRecords,
    signal: &Signal,
    unit: &str,
    commands: &mut Vec<Command>,
) {
    let row = &records.rows[records.chosen];
    let name = &signal.name;
    ui.label(format!("{name} [{unit}]"));
    let (uses, channels) = match signal.role {
        ChannelSide::Input => (&row.layout.inputs, &records.inputs),
        ChannelSide::Output => (&row.layout.outputs, &records.outputs),
    };
    let used = uses.get(signal.index).copied().flatten();
    let with = |used: ColumnUse| {
        let mut layout = row.layout.clone();
        let uses = match signal.role {
            ChannelSide::Input => &mut layout.inputs,
            ChannelSide::Output => &mut layout.outputs,
        };
        if let Some(place) = uses.get_mut(signal.index) {
            *place = Some(used);
        }
        RecordsCommand::SetLayout(records.chosen, layout).into()
    };
    let factor = used.map_or(1.0, |used| used.factor);
    let column = column_ui(
        ui,
        &format!("Column of {name}"),
        row,
        used.map(|used| used.column),
    );
    commands.extend(column.map(|column| with(ColumnUse::by_unit(&row.table, column, unit))));
    let open_units = used.map_or_else(Vec::new, |used| used.open_units(&row.table, unit));
    if open_units.is_empty() {
        let label = format!("Factor of the column of {name}");
        let typed = number_entry_ui(ui, &label, &number(factor), "1", FIELD_WIDTH, commands);
        commands.extend(
            typed
                .flatten()
                .zip(used)
                .map(|(factor, used)| with(ColumnUse { factor, ..used })),
        );
    } else {
        // Possible units of the samples, none of them selected.
        let units = open_units
            .into_iter()
            .map(|unit| (unit, false, unit.to_owned()));
        let said = list_ui(
            ui,
            &format!("Unit of the column of {name}"),
            (FIELD_WIDTH, "unit?"),
            units,
        );
        commands.extend(
            said.zip(used)
                .map(|(said, used)| with(used.in_unit(said, unit))),
        );
    }
    let delay_s = channels
        .get(signal.index)
        .map_or(0.0, |channel| channel.delay_s);
    let label = format!("Time skew of {name}");
    let typed = number_entry_ui(
        ui,
        &label,
        &number(s_to_ms(delay_s)),
        "0",
        FIELD_WIDTH,
        commands,
    );
    let set = |delay_ms: Option<f64>| {
        RecordsCommand::SetDelay(signal.clone(), ms_to_s(delay_ms.unwrap_or(0.0))).into()
    };
    commands.extend(typed.map(set));
    if let Some(used) = used {
        let set = |remedy: ChannelRemedy| {
            RecordsCommand::SetRemedies(records.chosen, vec![(signal.clone(), remedy)]).into()
        };
        let ChannelRemedy { delay_s, factor } = used.remedy;
        let label = format!("Delay of {name} in this record");
        let typed = number_entry_ui(
            ui,
            &label,
            &number(s_to_ms(delay_s)),
            "0",
            HERE_WIDTH,
            commands,
        );
        commands.extend(typed.map(|ms| {
            set(ChannelRemedy {
                delay_s: ms_to_s(ms.unwrap_or(0.0)),
                factor,
            })
        }));
        let label = format!("Multiplier of {name} in this record");
        let typed = number_entry_ui(ui, &label, &number(factor), "1", HERE_WIDTH, commands);
        commands.extend(typed.map(|factor| {
            set(ChannelRemedy {
                delay_s,
                factor: factor.unwrap_or(1.0),
            })
        }));
    }
    ui.end_row();
}

/// Selects a column of a record; returns a changed selection.
fn column_ui(ui: &mut Ui, name: &str, row: &LaidOutRecord, chosen: Option<usize>) -> Option<usize> {
    let words = |column: usize| {
        row.table
            .columns
            .get(column)
            .map_or("?".to_owned(), |of| match &of.unit {
                Some(unit) => format!("{} [{unit}]", of.name),
                None => of.name.clone(),
            })
    };
    let columns =
        (0..row.table.columns.len()).map(|column| (column, chosen == Some(column), words(column)));
    list_ui(
        ui,
        name,
        (150.0, &chosen.map_or("?".to_owned(), words)),
        columns,
    )
}
