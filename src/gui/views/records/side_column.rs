//! Right column of the Records view, below the verdict: the displayed condition's fit, identified
//! responses, cautions, and small plots of orders and poles.

use egui::{ScrollArea, Ui, vec2};

use super::caution_list::caution_list_ui;
use super::fit_summary::fit_summary_ui;
use super::identified_grid::identified_grid_ui;
use super::page::Page;
use super::small_plots::{SMALL_PLOTS_HEIGHT, small_plots_ui};
use crate::gui::commands::command::Command;
use crate::gui::state::records::ConditionRecords;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Column height below which there are no small plots \[pt\].
const LEAST_WITH_PLOTS: f32 = 540.0;
/// Gap between sections \[pt\].
const GAP: f32 = 8.0;
/// Height reserved for the cautions \[pt\].
const LEAST_CAUTIONS: f32 = 90.0;

/// Draws the column from top to bottom; the identified responses leave at least `LEAST_CAUTIONS`
/// for the cautions, which scroll.
pub fn records_side_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let nothing = ConditionRecords::default();
    let condition = state.condition().id();
    let page = Page {
        state,
        records: state.records.conditions.get(&condition).unwrap_or(&nothing),
        palette,
    };
    let height = ui.available_height();
    ui.spacing_mut().item_spacing = vec2(6.0, 0.0);
    let plots = if height >= LEAST_WITH_PLOTS {
        SMALL_PLOTS_HEIGHT + GAP
    } else {
        0.0
    };
    let upper = height - plots;
    ui.allocate_ui(vec2(ui.available_width(), upper), |ui| {
        ui.set_min_height(upper);
        let top = ui.cursor().top();
        fit_summary_ui(ui, page, commands);
        ui.add_space(GAP);
        let rest = upper - (ui.cursor().top() - top);
        identified_grid_ui(ui, page, rest - LEAST_CAUTIONS, commands);
        ui.add_space(GAP);
        let rest = (upper - (ui.cursor().top() - top)).max(LEAST_CAUTIONS);
        ScrollArea::vertical()
            .id_salt("cautions about identified models")
            .max_height(rest)
            .auto_shrink([false, true])
            .show(ui, |ui| caution_list_ui(ui, page, commands));
    });
    if plots > 0.0 {
        ui.add_space(GAP);
        small_plots_ui(ui, page, commands);
    }
}
