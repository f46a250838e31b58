//! Definitions common to all charts over time: their axis, and the margins beside their frames.

use std::sync::Arc;

use egui::Id;

use super::record_span::RecordSpan;

/// Width for the read-out at the right of a chart \[pt\].
pub(super) const READOUT_WIDTH: f32 = 150.0;
/// Width of the value axis \[pt\].
pub(super) const VALUE_AXIS: f32 = 46.0;

/// Returns the id of the time axis that all charts of a record share; a zoomed axis does not carry
/// over to another record.
pub(super) fn time_axis(record: &RecordSpan) -> Id {
    Id::unique(("flight record", Arc::as_ptr(&record.flight) as usize))
}
