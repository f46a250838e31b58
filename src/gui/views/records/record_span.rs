//! The displayed record as a whole, and its parts.

use std::sync::Arc;

use gdcm_model::simulation::FlightRecord;

use super::page::Page;

/// Part of the displayed record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RecordPart {
    /// Row index.
    pub(super) row: usize,
    /// Start and end \[s\].
    pub(super) ends_s: [f64; 2],
    pub(super) is_used: bool,
    /// Whether the part is the displayed row.
    pub(super) is_chosen: bool,
}

/// The displayed record as a whole.
#[derive(Clone, Debug)]
pub(super) struct RecordSpan {
    /// Samples in the whole record.
    pub(super) flight: Arc<FlightRecord>,
    /// Row index of the whole record, or of the displayed part if the whole record is not loaded.
    pub(super) whole_row: usize,
    pub(super) is_whole_used: bool,
    /// Times of the first and last sample \[s\].
    pub(super) span_s: [f64; 2],
    /// Parts, in row order.
    pub(super) parts: Vec<RecordPart>,
}

impl RecordSpan {
    /// Returns the displayed record; `None` without a record, or if its columns are not assigned.
    pub(super) fn new(page: Page<'_>) -> Option<Self> {
        let rows = &page.records.rows;
        let chosen = rows.get(page.records.chosen)?;
        let mut parts = Vec::new();
        let mut whole_row = page.records.chosen;
        for (row, record) in rows.iter().enumerate() {
            // The rows of a record, which are the whole record and its parts, have the same source.
            if record.table.source != chosen.table.source {
                continue;
            }
            match record.table.part_s {
                None => whole_row = row,
                Some(ends_s) => parts.push(RecordPart {
                    row,
                    ends_s,
                    is_used: record.used,
                    is_chosen: row == page.records.chosen,
                }),
            }
        }
        let whole = &rows[whole_row];
        Some(Self {
            flight: Arc::clone(whole.flight.as_ref()?),
            whole_row,
            is_whole_used: whole.used,
            span_s: whole.span_s()?,
            parts,
        })
    }

    /// Returns the time spans \[s\] drawn at full opacity: the displayed part. If the whole record
    /// is displayed: all of it if it is used or none of its parts is, otherwise its used parts.
    pub(super) fn bright_s(&self) -> Vec<[f64; 2]> {
        if let Some(part) = self.parts.iter().find(|part| part.is_chosen) {
            return vec![part.ends_s];
        }
        let used: Vec<[f64; 2]> = self
            .parts
            .iter()
            .filter(|part| part.is_used)
            .map(|part| part.ends_s)
            .collect();
        if self.is_whole_used || used.is_empty() {
            return vec![self.span_s];
        }
        used
    }
}
