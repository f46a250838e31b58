//! Lower part of the left panel in the Records view: the displayed condition's records, details
//! about the displayed record, and folded sections.
//!
//! A *fold* is a section that is unfolded by a click on its line; at most one is open.

use egui::{Align, Label, Layout, RichText, Role, ScrollArea, Sense, Ui, UiBuilder, pos2, vec2};

use super::columns_fold::{columns_fold_ui, columns_summary};
use super::page::Page;
use super::record_details::record_details_ui;
use super::record_files::{other_channels_ui, source_ui};
use super::record_list::record_rows_ui;
use super::search_settings::{search_settings_ui, settings_summary};
use super::unassigned_records::unassigned_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::records::{ConditionRecords, RecordsFold};
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, named_switch};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, chevron, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium, small};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Height of a line that folds and unfolds a section \[pt\].
const FOLD: f32 = 32.0;
/// Maximum height of an unfolded section \[pt\].
const OPEN: f32 = 230.0;
const FOLDS: [RecordsFold; 2] = [RecordsFold::Columns, RecordsFold::Settings];

/// Draws the records in the left panel, with the folded sections pinned at its foot.
pub fn records_panel_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let nothing = ConditionRecords::default();
    let page = page_of(state, &nothing, palette);
    region_ui(ui, Region::Models, |ui| {
        let room = ui.available_rect_before_wrap();
        let mut height = FOLD * FOLDS.len() as f32;
        if state.records.open_fold.is_some() {
            height += OPEN.min(0.5 * room.height());
        }
        let (above, below) = room.split_top_bottom_at_y(ui.max_rect().bottom() - height);
        let records = UiBuilder::new().id_salt("records").max_rect(above);
        ui.scope_builder(records, |ui| {
            heading_ui(ui, page);
            ScrollArea::vertical()
                .id_salt("records")
                .auto_shrink(false)
                .show(ui, |ui| content_ui(ui, page, commands));
        });
        let folds = UiBuilder::new().id_salt("record folds").max_rect(below);
        ui.scope_builder(folds, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for fold in FOLDS {
                fold_ui(ui, page, fold, commands);
                if state.records.open_fold == Some(fold) {
                    ScrollArea::vertical()
                        .id_salt(fold)
                        .auto_shrink(false)
                        .max_height(height - FOLD * FOLDS.len() as f32)
                        .show(ui, |ui| fold_content_ui(ui, page, fold, commands));
                }
            }
        });
    });
}

/// Draws the records in a sheet beside the rail.
pub fn records_sheet_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let nothing = ConditionRecords::default();
    let page = page_of(state, &nothing, palette);
    region_ui(ui, Region::Models, |ui| {
        heading_ui(ui, page);
        content_ui(ui, page, commands);
        ui.add_space(6.0);
        for fold in FOLDS {
            fold_ui(ui, page, fold, commands);
            if state.records.open_fold == Some(fold) {
                fold_content_ui(ui, page, fold, commands);
            }
        }
    });
}

fn page_of<'a>(state: &'a State, nothing: &'a ConditionRecords, palette: &'a Palette) -> Page<'a> {
    let condition = state.condition().id();
    Page {
        state,
        records: state.records.conditions.get(&condition).unwrap_or(nothing),
        palette,
    }
}

/// Draws the heading: "Records, condition 10", and at the right "8 used, 1 held out".
fn heading_ui(ui: &mut Ui, page: Page<'_>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let counts = records.counts();
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        let title = format!("Records, condition {}", state.condition().id());
        ui.label(RichText::new(title).font(medium(BODY_SIZE)));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let words = match (counts.fitted, counts.held_out) {
                (0, 0) => "none used".to_owned(),
                (fitted, 0) => format!("{fitted} used"),
                (fitted, held_out) => format!("{fitted} used, {held_out} held out"),
            };
            ui.label(palette.small(words));
        });
    });
}

fn content_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = 4.0;
    source_ui(ui, page, commands);
    unassigned_ui(ui, page, commands);
    other_channels_ui(ui, page, commands);
    if page.records.rows.is_empty() {
        no_records_ui(ui, page);
        return;
    }
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        record_rows_ui(ui, page, commands);
    });
    record_details_ui(ui, page, commands);
}

fn no_records_ui(ui: &mut Ui, page: Page<'_>) {
    let Page { state, palette, .. } = page;
    if state.records.reading.is_some() {
        return;
    }
    let text = "No flight records of this condition yet: CSV, text, .mat, .npz, .zip or logs, with \
                column names.";
    ui.add(Label::new(palette.small(text)).wrap());
    if state.records.example == Some(gdcm_io::Example::Simulated) {
        let text = "The example includes the records of conditions 3 and 10; the records of all \
                    conditions are in assets/example-records.zip of the sources.";
        ui.add(Label::new(palette.small(text)).wrap());
    }
}

/// Draws the line that folds and unfolds a section, with its summary at the right.
fn fold_ui(ui: &mut Ui, page: Page<'_>, fold: RecordsFold, commands: &mut Vec<Command>) {
    let Page { state, palette, .. } = page;
    let is_open = state.records.open_fold == Some(fold);
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), FOLD), Sense::click());
    ui.painter().hline(
        row.expand2(vec2(12.0, 0.0)).x_range(),
        row.top(),
        ui.visuals().widgets.noninteractive.bg_stroke,
    );
    chevron(ui, pos2(row.left() + 6.0, row.center().y), is_open, palette);
    let (name, summary) = match fold {
        RecordsFold::Columns => ("Columns and units", columns_summary(state)),
        RecordsFold::Settings => ("Identification settings", settings_summary(page)),
    };
    painted_text(ui, row, 16.0, name, medium(BODY_SIZE), palette.text);
    let color = if summary.is_doubtful {
        palette.warning
    } else {
        palette.dim_text
    };
    painted_text(ui, row, AT_RIGHT_END, &summary.text, small(), color);
    let wanted = if is_open { None } else { Some(fold) };
    named_switch(response, Role::Button, is_open, name)
        .asks(RecordsCommand::ShowFold(wanted), commands);
}

fn fold_content_ui(ui: &mut Ui, page: Page<'_>, fold: RecordsFold, commands: &mut Vec<Command>) {
    match fold {
        RecordsFold::Columns => columns_fold_ui(ui, page, commands),
        RecordsFold::Settings => search_settings_ui(ui, page, commands),
    }
}
