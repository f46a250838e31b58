//! The records of a condition, line by line.

use egui::{Align, ComboBox, Grid, Label, Layout, RichText, Role, Sense, Ui, WidgetInfo};

use crate::view::command::Command;
use crate::view::palette::{BODY_SIZE, Palette, SMALL_SIZE};
use crate::view::row::elided_among;
use gdcm_core::dataset::RecordKind;

use super::bench::{ConditionRecords, RecordRow, RecordsCommand};

/// Width of all columns but the names \[pt\].
const OTHER_COLUMNS: f32 = 124.0;
/// Least width of the names \[pt\].
const LEAST_NAME: f32 = 60.0;
/// Cost per degree of freedom up to which a record is fitted well, and from which it is not (M14, section 6).
pub(super) const GOOD: f64 = 1.2;
/// See [`GOOD`].
pub(super) const BAD: f64 = 1.5;

/// A line a record: whether it is used and held out, and how well the model fits it.
pub(super) fn record_list_ui(
    ui: &mut Ui,
    (records, is_example): (&ConditionRecords, bool),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let small = |text: &str| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    if records.rows.is_empty() {
        let text = "No flight records of this condition yet. Add files or a folder above, or drop them here: CSV, text, .mat, \
                    .npz or .zip, with names for the columns.";
        ui.add(Label::new(small(text)).wrap());
        if is_example {
            let text = "Of the example, the program holds the records of conditions 3 and 10; those of all are in \
                        assets/example-records.zip of its source.";
            ui.add(Label::new(small(text)).wrap());
        }
        return;
    }
    let width = (ui.available_width() - OTHER_COLUMNS).max(LEAST_NAME);
    Grid::new("flight records").num_columns(4).spacing([6.0, 2.0]).striped(true).show(ui, |ui| {
        for (heading, hint) in [
            ("use", "Whether anything is done with the record"),
            ("hold", "Held out: kept from the fit, to judge the model by"),
            ("record", "A click shows it"),
            ("J", "Cost per degree of freedom of the recommended model; 1 is what noise explains"),
        ] {
            ui.label(small(heading)).on_hover_text(hint);
        }
        ui.end_row();
        for index in 0..records.rows.len() {
            row_ui(ui, records, (index, width), palette, commands);
            ui.end_row();
        }
    });
    let Some(row) = records.rows.get(records.chosen) else { return };
    kind_ui(ui, records.chosen, row, palette, commands);
    for (words, color) in row
        .problems
        .iter()
        .map(|words| (words, palette.warning))
        .chain(row.cautions.iter().map(|words| (words, palette.dim_text)))
    {
        ui.add(Label::new(RichText::new(words).size(SMALL_SIZE).color(color)).wrap());
    }
}

fn row_ui(
    ui: &mut Ui,
    records: &ConditionRecords,
    (index, width): (usize, f32),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let row = &records.rows[index];
    let name = &row.table.name;
    for (label, before, command) in [
        (format!("Use {name}"), row.used, RecordsCommand::SetUsed as fn(usize, bool) -> RecordsCommand),
        (format!("Hold out {name}"), row.guess.held_out, RecordsCommand::SetHeldOut),
    ] {
        let mut value = before;
        let enabled = row.flight.is_some();
        let shown = ui.add_enabled(enabled, egui::Checkbox::without_text(&mut value));
        shown.widget_info(|| WidgetInfo::selected(Role::CheckBox, enabled, value, &label));
        if shown.changed() {
            commands.push(command(index, value).into());
        }
    }
    let is_chosen = index == records.chosen;
    let color = if row.problems.is_empty() { palette.text } else { palette.warning };
    let neighbour = |at: Option<usize>| Some(records.rows.get(at?)?.table.name.as_str());
    let neighbours = [neighbour(index.checked_sub(1)), neighbour(index.checked_add(1))];
    let shown_name = elided_among(ui, name, neighbours, width, BODY_SIZE);
    let text = RichText::new(&shown_name).size(BODY_SIZE).color(color);
    let text = if is_chosen { text.strong().background_color(palette.selected) } else { text };
    let label = format!("Record {name}");
    let size = egui::vec2(width, ui.spacing().interact_size.y);
    let layout = Layout::left_to_right(Align::Center);
    let shown = ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_width(width);
        ui.add(Label::new(text).truncate().sense(Sense::click()))
    });
    let shown = shown.inner;
    shown.widget_info(|| WidgetInfo::selected(Role::Button, true, is_chosen, &label));
    let shown = if shown_name == *name { shown } else { shown.on_hover_text(name) };
    if shown.clicked() {
        commands.push(RecordsCommand::Choose(index).into());
    }
    match cost_of(records, index) {
        Some(cost) => {
            let color = match cost {
                cost if cost <= GOOD => palette.good,
                cost if cost <= BAD => palette.text,
                _ => palette.warning,
            };
            ui.label(RichText::new(format!("{cost:.2}")).color(color))
        }
        None => ui.label(""),
    };
}

/// Which manoeuvre a record is of.
fn kind_ui(ui: &mut Ui, index: usize, row: &RecordRow, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("{}: a", row.table.name)).size(SMALL_SIZE).color(palette.dim_text));
        let kinds = ComboBox::from_id_salt("kind of a record").width(90.0).selected_text(row.guess.kind.word());
        let kinds = kinds.show_ui(ui, |ui| {
            for kind in RecordKind::ALL {
                if ui.selectable_label(kind == row.guess.kind, kind.word()).clicked() {
                    commands.push(RecordsCommand::SetKind(index, kind).into());
                }
            }
        });
        kinds.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, "Manoeuvre of the record"));
    });
}

/// Cost per degree of freedom of a row under the recommended model.
fn cost_of(records: &ConditionRecords, index: usize) -> Option<f64> {
    let found = records.identification().filter(|_| !records.changed)?;
    let fit = found.record_fits.iter().find(|fit| records.row_of_record(fit.record) == Some(index))?;
    Some(fit.cost)
}
