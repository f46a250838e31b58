//! Page Fit: the displayed record over time, above the response in focus.

use egui::{Align2, Rect, Role, Sense, Stroke, Ui, UiBuilder, vec2};

use super::fit_layout::FitLayout;
use super::histories::{histories_ui, shown_outputs};
use super::page::Page;
use super::parts_lane::parts_lane_ui;
use super::record_span::RecordSpan;
use super::response::response_ui;
use super::role_chips::role_chips_ui;
use super::simulation::simulated;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::BodeCurve;
use crate::gui::state::records::RecordsPage;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::palette::body;

/// Draws the page; `curves` are those from `plain_curves` for the response in focus: every model's
/// response, whatever the engineer has hidden in other views.
pub(super) fn fit_ui(
    ui: &mut Ui,
    page: Page<'_>,
    curves: &[BodeCurve],
    commands: &mut Vec<Command>,
) {
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, Sense::hover());
    if page.records.rows.is_empty() {
        message_ui(ui, page, area, &no_records_text(page));
        return;
    }
    let more_outputs = shown_outputs(page).len() - 1;
    let layout = FitLayout::new(area, more_outputs);
    let models = simulated(page.state);
    role_chips_ui(ui, page, &models, layout.chips, commands);
    match RecordSpan::new(page) {
        Some(record) => {
            if let Some(view) = histories_ui(ui, page, &record, &models, &layout.time) {
                parts_lane_ui(ui, page, &record, layout.lane, &view, commands);
            }
        }
        None => unassigned_ui(ui, page, &layout, commands),
    }
    let line = Stroke::new(1.0, page.palette.line);
    ui.painter().hline(area.x_range(), layout.separator, line);
    response_ui(ui, page, curves, layout.heading, &layout.response);
}

fn no_records_text(page: Page<'_>) -> String {
    match &page.state.records.reading {
        Some(reading) => format!("Reading {reading} …"),
        None => "No flight records of this condition: add files or folders, or drop them here"
            .to_owned(),
    }
}

fn message_ui(ui: &Ui, page: Page<'_>, area: Rect, text: &str) {
    let color = page.palette.dim_text;
    ui.painter()
        .text(area.center(), Align2::CENTER_CENTER, text, body(), color);
    let response = ui.interact(area, ui.scope_id().with("message"), Sense::hover());
    named(response, Role::Label, text);
}

/// Draws, instead of the time charts, a message that the record's columns are not assigned.
fn unassigned_ui(ui: &mut Ui, page: Page<'_>, layout: &FitLayout, commands: &mut Vec<Command>) {
    let mut area = layout.lane;
    for place in &layout.time {
        area = area.union(*place);
    }
    let text = "The columns of this record are not yet assigned to channels";
    message_ui(ui, page, area.translate(vec2(0.0, -16.0)), text);
    let button = Rect::from_center_size(area.center() + vec2(0.0, 12.0), vec2(140.0, 24.0));
    ui.scope_builder(UiBuilder::new().max_rect(button), |ui| {
        ui.vertical_centered(|ui| {
            ui.button("Assign columns")
                .asks(RecordsCommand::ShowPage(RecordsPage::Columns), commands);
        });
    });
}
