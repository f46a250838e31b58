//! Record list: a row for each record with its use and fit; below, manoeuvre and problems of the
//! displayed record.

use egui::{Align, Checkbox, Color32, Grid, Label, Layout, RichText, Role, Sense, Ui, vec2};

use gdcm_io::Example;
use gdcm_model::dataset::condition::RecordKind;
use gdcm_sysid::records::LaidOutRecord;

use super::page::Page;
use super::record_problems::problem_texts;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::widgets::choices::DropDown;
use crate::gui::widgets::controls::{Asks, named, named_switch};
use crate::gui::widgets::elision::elided_among;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE};

/// Width of all columns except the names \[pt\].
const OTHER_COLUMNS: f32 = 124.0;
/// Minimum width of the names \[pt\].
const LEAST_NAME: f32 = 60.0;
/// Tooltip of fit costs.
pub(super) const CHI_SQUARED: &str =
    "Cost per degree of freedom of the recommended model; 1 if only noise remains (M14, section 6)";
/// Limit of χ²/dof above which the fit of a record is bad (M14, section 6).
pub(super) const BAD_FIT: f64 = 1.5;

const HEADINGS: [(&str, &str); 4] = [
    ("use", "Use the record for identification or validation"),
    (
        "hold",
        "Held out: not fitted, so that it can test the model",
    ),
    ("record", "Click to display"),
    ("χ²/dof", CHI_SQUARED),
];

/// Shows a row for each record: whether it is used or held out, and the model's fit.
pub(super) fn record_list_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        records, palette, ..
    } = page;
    if records.rows.is_empty() {
        no_records_ui(ui, page);
        return;
    }
    let name_width = (ui.available_width() - OTHER_COLUMNS).max(LEAST_NAME);
    Grid::new("flight records")
        .num_columns(4)
        .spacing([6.0, 2.0])
        .striped(true)
        .show(ui, |ui| {
            for (heading, hint) in HEADINGS {
                ui.label(palette.small(heading)).on_hover_text(hint);
            }
            ui.end_row();
            for index in 0..records.rows.len() {
                use_ui(ui, page, index, commands);
                name_ui(ui, page, index, name_width, commands);
                ui.horizontal(|ui| fit_ui(ui, page, index));
                ui.end_row();
            }
        });
    let Some(row) = records.rows.get(records.chosen) else {
        return;
    };
    kind_ui(ui, records.chosen, row, palette, commands);
    for problem in problem_texts(&row.problems) {
        note_ui(ui, problem, palette.warning);
    }
    for caution in &row.cautions {
        note_ui(ui, caution.to_string(), palette.dim_text);
    }
}

fn no_records_ui(ui: &mut Ui, page: Page<'_>) {
    let Page { state, palette, .. } = page;
    let text = "No flight records of this condition yet. Add files or a folder above, or drop \
                them here: CSV, text, .mat, .npz or .zip, with column names.";
    ui.add(Label::new(palette.small(text)).wrap());
    if state.records.example == Some(Example::Simulated) {
        let text = "The example includes the records of conditions 3 and 10; the records of all \
                    conditions are in assets/example-records.zip of the sources.";
        ui.add(Label::new(palette.small(text)).wrap());
    }
}

fn note_ui(ui: &mut Ui, text: String, color: Color32) {
    let text = RichText::new(text).size(SMALL_SIZE).color(color);
    ui.add(Label::new(text).wrap());
}

/// Draws two check boxes: whether a record is used, and whether it is held out for validation.
fn use_ui(ui: &mut Ui, page: Page<'_>, index: usize, commands: &mut Vec<Command>) {
    let row = &page.records.rows[index];
    let name = &row.table.name;
    let is_usable = row.flight.is_some();
    if let Some(used) = box_ui(ui, is_usable, row.used, format!("Use {name}")) {
        commands.push(RecordsCommand::SetUsed(index, used).into());
    }
    let label = format!("Hold out {name}");
    if let Some(held_out) = box_ui(ui, is_usable, row.guess.held_out, label) {
        commands.push(RecordsCommand::SetHeldOut(index, held_out).into());
    }
}

/// Draws a check box without text; returns a changed value.
fn box_ui(ui: &mut Ui, is_enabled: bool, is_checked: bool, label: String) -> Option<bool> {
    let mut value = is_checked;
    let response = ui.add_enabled(is_enabled, Checkbox::without_text(&mut value));
    if named_switch(response, Role::CheckBox, value, label).changed() {
        Some(value)
    } else {
        None
    }
}

/// Shows the name of a record, shortened so that it differs from its neighbours; a click displays
/// the record.
fn name_ui(ui: &mut Ui, page: Page<'_>, index: usize, width: f32, commands: &mut Vec<Command>) {
    let Page {
        records, palette, ..
    } = page;
    let row = &records.rows[index];
    let name = &row.table.name;
    let neighbours = [index.checked_sub(1), index.checked_add(1)]
        .map(|neighbour| Some(records.rows.get(neighbour?)?.table.name.as_str()));
    let elided_name = elided_among(ui, name, neighbours, width, BODY_SIZE);
    let color = if row.problems.is_empty() {
        palette.text
    } else {
        palette.warning
    };
    let mut text = RichText::new(&elided_name).size(BODY_SIZE).color(color);
    let is_chosen = index == records.chosen;
    if is_chosen {
        text = text.strong().background_color(palette.selected);
    }
    let size = vec2(width, ui.spacing().interact_size.y);
    let line = ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_width(width);
        ui.add(Label::new(text).truncate().sense(Sense::click()))
    });
    let mut response = named_switch(
        line.inner,
        Role::Button,
        is_chosen,
        format!("Record {name}"),
    );
    if elided_name != *name {
        response = response.on_hover_text(name);
    }
    response.asks(RecordsCommand::Choose(index), commands);
}

/// Shows the fit cost of a record, and a warning sign if cautions concern the record.
fn fit_ui(ui: &mut Ui, page: Page<'_>, index: usize) {
    let Page {
        records, palette, ..
    } = page;
    ui.label(match fit_cost(page, index) {
        Some(cost) => cost_text(cost, palette),
        None => RichText::new(""),
    });
    let cautions: Vec<String> = records
        .cautions()
        .filter(|(rows, _)| rows.contains(&index))
        .map(|(_, note)| note.text)
        .collect();
    if !cautions.is_empty() {
        let mark = ui.label(palette.small_warning("⚠"));
        named(
            mark.on_hover_text(cautions.join("\n\n")),
            Role::Label,
            format!("Cautions of {}", records.rows[index].table.name),
        );
    }
}

/// Returns χ²/dof of the recommended model for a record; `None` without a current identification.
fn fit_cost(page: Page<'_>, index: usize) -> Option<f64> {
    let found = page.current_identification()?;
    let fit = found
        .record_fits
        .iter()
        .find(|fit| page.records.row_of_record(fit.record) == Some(index))?;
    Some(fit.cost)
}

/// Formats χ²/dof, in the warning colour if the fit is bad.
pub(super) fn cost_text(cost: f64, palette: &Palette) -> RichText {
    let color = if cost <= BAD_FIT {
        palette.text
    } else {
        palette.warning
    };
    RichText::new(format!("{cost:.2}")).color(color)
}

/// Draws the selector of a record's manoeuvre, as the end of the sentence "name: a sweep", and for
/// a part of a record also the button that removes the part.
fn kind_ui(
    ui: &mut Ui,
    index: usize,
    row: &LaidOutRecord,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        ui.label(palette.small(format!("{}: a", row.table.name)));
        let chosen = row.guess.kind;
        let kinds = RecordKind::ALL.map(|kind| (kind, kind == chosen, kind.word().to_owned()));
        let list = DropDown {
            name: "Manoeuvre of the record",
            width: 90.0,
            text: chosen.word(),
        };
        if let Some(kind) = list.ui(ui, kinds) {
            commands.push(RecordsCommand::SetKind(index, kind).into());
        }
        if row.table.part_s.is_some() && ui.small_button("Remove part").clicked() {
            commands.push(RecordsCommand::RemovePart(index).into());
        }
    });
}
