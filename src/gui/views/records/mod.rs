//! Flight records of all conditions and the models identified from them: records in the left panel
//! of the window (`list_panel.rs`), outcome and a page about them in the middle.

mod autospectra;
mod caution_remedies;
mod columns;
mod columns_fold;
mod condition_table;
mod drawn_response;
mod fit_page;
mod fold_summary;
pub mod frame_cache;
mod header;
mod histories;
mod history_spans;
mod identified_poles;
mod input_charts;
mod list_panel;
mod next_flight;
mod offered_models;
mod outcome;
pub mod page;
mod record_details;
mod record_files;
mod record_list;
mod record_parts;
mod record_problems;
mod references;
mod response;
mod response_legend;
mod search_settings;
mod simulation;
mod spectrogram;
mod typed_lists;
mod unassigned_records;

use egui::scroll_area::ScrollBarVisibility;
use egui::{Frame, Margin, Panel, ScrollArea, Ui};

use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::records::{ConditionRecords, RecordsPage};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::page_tab_ui;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::panel_layout::restore_panel_size;
use columns::columns_ui;
use fit_page::fit_ui;
use histories::histories_ui;
use identified_poles::{identified_poles_ui, stabilisation_ui};
use input_charts::inputs_ui;
use outcome::outcome_ui;
use page::Page;
use response::response_ui;

pub use condition_table::condition_table;
pub use header::records_header_ui;
pub use list_panel::{records_panel_ui, records_sheet_ui};
pub use simulation::simulation_jobs;

/// Initial width of the record list \[pt\].
const LIST_WIDTH: f32 = 340.0;

/// Draws the records and their results.
pub fn records_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let condition = state.condition().id();
    let nothing = ConditionRecords::default();
    let records = state.records.conditions.get(&condition).unwrap_or(&nothing);
    let page = Page {
        state,
        records,
        palette,
    };
    let width = LIST_WIDTH.min(0.4 * ui.available_width());
    restore_panel_size(ui, "records");
    Panel::left("records")
        .resizable(true)
        .default_size(width)
        .size_range(180.0..=480.0)
        .show(ui, |ui| {
            ScrollArea::vertical()
                .id_salt("records")
                .auto_shrink(false)
                .show(ui, |ui| {
                    outcome_ui(ui, page, commands);
                });
        });
    // The margin keeps the content away from the line between list and page.
    let margin = Margin {
        left: 6,
        ..Margin::ZERO
    };
    Frame::new().inner_margin(margin).show(ui, |ui| {
        page_tabs_ui(ui, state.records.page, commands);
        match state.records.page {
            RecordsPage::Histories => histories_ui(ui, page, commands),
            RecordsPage::Inputs => inputs_ui(ui, page),
            RecordsPage::Response => response_ui(ui, page),
            RecordsPage::Stabilisation => stabilisation_ui(ui, page),
            RecordsPage::Poles => identified_poles_ui(ui, page),
            RecordsPage::Fit => fit_ui(ui, page, commands),
            RecordsPage::Columns => columns_ui(ui, page, commands),
        }
    });
}

/// Shows a tab for each page, in a line that scrolls if it is too long.
fn page_tabs_ui(ui: &mut Ui, displayed: RecordsPage, commands: &mut Vec<Command>) {
    let tabs = ScrollArea::horizontal()
        .id_salt("pages")
        .scroll_bar_visibility(ScrollBarVisibility::AlwaysHidden);
    tabs.show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for page in RecordsPage::ALL {
                let is_displayed = page == displayed;
                let (tab, is_clicked) = page_tab_ui(ui, is_displayed, page.words());
                if tab.gained_focus() {
                    tab.scroll_to_me(None);
                }
                if is_clicked {
                    commands.push(RecordsCommand::Show(page).into());
                }
            }
        });
    });
}
