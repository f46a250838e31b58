//! Selection of the input drawn over time, from the displayed record's excitation.

use std::sync::Arc;

use egui::Ui;

use gdcm_model::simulation::FlightRecord;

use super::frame_cache::{Source, cached};
use super::page::Page;
use crate::gui::state::excited_input::Excitation;

/// Returns the index of the input in focus if the displayed record excites it or moves no input,
/// otherwise the input that it excites most, compared with the other records.
pub(super) fn displayed_input(ui: &Ui, page: Page<'_>) -> usize {
    displayed_excited_input(ui, page).unwrap_or(page.state.display.selection.pair.input)
}

/// Like [`displayed_input`]; `None` if no input moves.
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
    let excitations = cached(ui, "excited inputs", &sources, (), || {
        Excitation::compare_records(&flights)
    });
    let focus = page.state.display.selection.pair.input;
    let excitation = excitations.get(displayed?)?;
    excitation.excited_input(focus)
}
