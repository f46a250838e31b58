//! Flight records for all conditions and the models identified from them: records in the left panel
//! (`list_panel.rs`), a page about the displayed condition in the middle, and its fit in the right
//! panel (`side_column.rs`).
//!
//! A *record* is a flight record as read from its file, a *part* a time span of it that is used as
//! a record of its own; each has a *row* in the list. An identification first finds a model by
//! CT-PBSID and then *refines* it; the refined model is the *recommended* one (M14:
//! docs/identification.md). `Page` is the context for drawing: state, records of the displayed
//! condition, palette.

mod autospectra;
mod caution_list;
mod caution_marks;
mod caution_remedies;
mod columns;
mod columns_fold;
mod condition_table;
mod drawn_response;
mod excited_channel;
mod fit_layout;
mod fit_page;
mod fit_summary;
mod fold_summary;
pub mod frame_cache;
mod header;
mod histories;
mod history_readout;
mod history_spans;
mod identified_grid;
mod identified_poles;
mod input_charts;
mod list_panel;
mod next_flight;
mod offered_models;
mod order_fits;
mod order_page;
pub mod page;
mod parts_lane;
mod record_details;
mod record_files;
mod record_list;
mod record_parts;
mod record_problems;
mod record_span;
mod recorded_lines;
mod references;
mod response;
mod response_cautions;
mod response_marks;
mod role_chips;
mod search_settings;
mod side_column;
mod simulation;
mod small_plots;
mod spectrogram;
mod time_charts;
mod time_lines;
mod typed_lists;
mod unassigned_records;
mod value_range;

use egui::Ui;

use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::records::{ConditionRecords, RecordsPage};
use crate::gui::state::window_state::State;
use crate::gui::views::PageEntry;
use crate::gui::views::frequency_curves::plain_curves;
use crate::gui::widgets::palette::Palette;
use columns::columns_ui;
use fit_page::fit_ui;
use input_charts::inputs_ui;
use order_page::order_ui;
use page::Page;

pub use condition_table::condition_table;
pub use header::records_header_ui;
pub use list_panel::{records_panel_ui, records_sheet_ui};
pub use side_column::records_side_ui;
pub use simulation::simulation_jobs;

/// Draws a page about the displayed condition.
pub fn records_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let condition = state.condition().id();
    let curves = match state.records.page {
        RecordsPage::Fit => plain_curves(state, state.display.selection.pair),
        _ => Vec::new(),
    };
    let nothing = ConditionRecords::default();
    let page = Page {
        state,
        records: state.records.conditions.get(&condition).unwrap_or(&nothing),
        palette,
    };
    match state.records.page {
        RecordsPage::Fit => fit_ui(ui, page, &curves, commands),
        RecordsPage::Inputs => inputs_ui(ui, page),
        RecordsPage::Order => order_ui(ui, page),
        RecordsPage::Columns => columns_ui(ui, page, commands),
    }
}

/// Returns the pages, in display order.
pub fn records_pages(state: &State) -> Vec<PageEntry> {
    let mut pages = Vec::with_capacity(RecordsPage::ALL.len());
    for page in RecordsPage::ALL {
        pages.push(PageEntry {
            words: page.words(),
            is_shown: page == state.records.page,
            command: RecordsCommand::ShowPage(page).into(),
        });
    }
    pages
}
