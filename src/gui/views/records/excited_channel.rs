//! The input drawn over time: the one that the displayed record excites most.

use std::sync::Arc;

use egui::Ui;

use gdcm_model::simulation::FlightRecord;

use super::frame_cache::{Source, cached};
use super::page::Page;
use crate::gui::state::excited_input::excited_inputs;

/// Returns the index of the input that the displayed record excites most, compared with the other
/// records; the input in focus if no input moves.
pub(super) fn displayed_input(ui: &Ui, page: Page<'_>) -> usize {
    displayed_excited_input(ui, page).unwrap_or(page.state.display.selection.pair.input)
}

/// Returns the index of the input that the displayed record excites most; `None` if no input moves.
pub(super) fn displayed_excited_input(ui: &Ui, page: Page<'_>) -> Option<usize> {
    let records = page.records;
    let mut flights: Vec<Arc<FlightRecord>> = Vec::new();
    let mut displayed = None;
    for (index, row) in records.rows.iter().enumerate() {
        if let Some(flight) = &row.flight {
            if index == records.chosen {
                displayed = Some(flights.len());
            }
            flights.push(Arc::clone(flight));
        }
    }
    let mut sources: Vec<Source> = Vec::with_capacity(flights.len());
    for flight in &flights {
        sources.push(Arc::clone(flight) as _);
    }
    let excited = cached(ui, "excited inputs", &sources, (), || {
        excited_inputs(&flights)
    });
    excited.get(displayed?).copied().flatten()
}
