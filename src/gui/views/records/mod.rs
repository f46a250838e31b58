//! Flight records of the displayed condition and the models identified from them: records and
//! search settings on the left, a page about them beside, and the fit in the right panel.

mod autospectra;
mod caution_list;
mod caution_marks;
mod caution_remedies;
mod columns;
mod condition_table;
mod drawn_response;
mod excited_channel;
mod fit_layout;
mod fit_page;
mod fit_summary;
pub mod frame_cache;
mod header;
mod histories;
mod history_readout;
mod history_spans;
mod identified_grid;
mod identified_poles;
mod input_charts;
mod next_flight;
mod offered_models;
mod order_fits;
mod order_page;
pub mod page;
mod parts_lane;
mod record_files;
mod record_list;
mod record_parts;
mod record_problems;
mod record_span;
mod recorded_lines;
mod references;
mod response;
mod role_chips;
mod search_settings;
mod side_column;
mod simulation;
mod small_plots;
mod spectrogram;
mod time_charts;
mod typed_lists;
mod value_range;

use egui::{Frame, Margin, Panel, ScrollArea, Ui};

use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::records::{ConditionRecords, RecordsPage};
use crate::gui::state::window_state::State;
use crate::gui::views::PageEntry;
use crate::gui::views::frequency_curves::plain_curves;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::panel_layout::restore_panel_size;
use columns::columns_ui;
use fit_page::fit_ui;
use input_charts::inputs_ui;
use order_page::order_ui;
use page::Page;
use record_files::source_ui;
use record_list::record_list_ui;
use search_settings::search_settings_ui;

pub use condition_table::condition_table;
pub use header::records_header_ui;
pub use side_column::records_side_ui;
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
    let curves = match state.records.page {
        RecordsPage::Fit => plain_curves(state, state.display.selection.pair),
        _ => Vec::new(),
    };
    // The page borrows the state, so the fields that widgets change are taken out of it meanwhile.
    let mut path = std::mem::take(&mut state.records.path);
    let mut focused = state.records.advanced_field;
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
                    source_ui(ui, page, &mut path, commands);
                    record_list_ui(ui, page, commands);
                    search_settings_ui(ui, page, &mut focused, commands);
                });
        });
    // The margin keeps the content away from the line between list and page.
    let margin = Margin {
        left: 6,
        ..Margin::ZERO
    };
    Frame::new()
        .inner_margin(margin)
        .show(ui, |ui| match state.records.page {
            RecordsPage::Fit => fit_ui(ui, page, &curves, commands),
            RecordsPage::Inputs => inputs_ui(ui, page),
            RecordsPage::Order => order_ui(ui, page),
            RecordsPage::Columns => columns_ui(ui, page, commands),
        });
    state.records.path = path;
    state.records.advanced_field = focused;
}

/// Returns the pages, in display order.
pub fn records_pages(state: &State) -> Vec<PageEntry> {
    let mut pages = Vec::with_capacity(RecordsPage::ALL.len());
    for page in RecordsPage::ALL {
        pages.push(PageEntry {
            words: page.words(),
            is_shown: page == state.records.page,
            command: RecordsCommand::Show(page).into(),
        });
    }
    pages
}
