//! Parts of a condition's flight records: time spans that are used as records of their own.
//!
//! Each record and each part is a row; the parts follow their record and have the same source. A
//! part replaces its whole record, so that no sample counts twice: once the first part is added,
//! the whole record is no longer used; once the last part is removed, it is used again. A record
//! that the engineer left out stays out.

use std::sync::Arc;

use gdcm_model::units::{number, telling};
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, RecordSource};

use super::condition_records::ConditionRecords;
use crate::message::Message;

impl ConditionRecords {
    /// Adds a part after its record and the earlier parts, and displays it. The whole record is no
    /// longer used, so that no sample counts twice. A part cut from a part belongs to the whole
    /// record.
    ///
    /// # Errors
    /// A message, if there is no such record, or if it has fewer than two samples in this time
    /// span.
    pub fn add_part(
        &mut self,
        index: usize,
        part_s: [f64; 2],
        channels: &RecordChannels,
    ) -> Result<(), Message> {
        let index = self.whole_index(index);
        let Some(whole) = self.rows.get_mut(index) else {
            return Err(Message::new(
                "unknown-record",
                "the record is no longer in the list",
            ));
        };
        let part = part_of(whole, part_s, channels)?;
        let source = whole.table.source.clone();
        let was_used = whole.used;
        if whole.table.part_s.is_none() {
            whole.used = false;
            // Without parts, an unused record was left out, for example because it is a copy;
            // removing its parts must not use it.
            if !was_used && !self.has_parts(&source) && !self.left_out.contains(&source) {
                self.left_out.push(source);
            }
        }
        // Insert after the record's earlier parts.
        let mut position = index + 1;
        while self.is_part(position) {
            position += 1;
        }
        self.rows.insert(position, part);
        self.chosen = position;
        self.is_chosen = true;
        Ok(())
    }

    /// Returns the index of the row's whole record, or of the row itself if the whole is not
    /// loaded.
    fn whole_index(&self, index: usize) -> usize {
        let Some(row) = self.rows.get(index) else {
            return index;
        };
        let source = &row.table.source;
        let whole = self
            .rows
            .iter()
            .position(|other| other.table.part_s.is_none() && other.table.source == *source);
        whole.unwrap_or(index)
    }

    /// Moves the ends of the part in a row \[s\]; its use, manoeuvre and layout are kept.
    ///
    /// # Errors
    /// A message, if the row is no part, or if the record has fewer than two samples in that time
    /// span.
    pub fn move_part(
        &mut self,
        index: usize,
        part_s: [f64; 2],
        channels: &RecordChannels,
    ) -> Result<(), Message> {
        let row = match self.rows.get(index) {
            Some(row) if row.table.part_s.is_some() => row,
            _ => {
                return Err(Message::new(
                    "unknown-record",
                    "the part is no longer in the list",
                ));
            }
        };
        let whole = &self.rows[self.whole_index(index)];
        let mut part = part_of(whole, part_s, channels)?;
        part.used = row.used;
        part.guess = row.guess.clone();
        // The part's columns may differ from those of the whole record, by a remedy for example.
        self.rows[index] = part.laid_out(row.layout.clone(), channels);
        Ok(())
    }

    /// Returns whether a row exists and is only a part.
    fn is_part(&self, index: usize) -> bool {
        match self.rows.get(index) {
            Some(row) => row.table.part_s.is_some(),
            None => false,
        }
    }

    fn has_parts(&self, source: &RecordSource) -> bool {
        self.rows
            .iter()
            .any(|row| row.table.part_s.is_some() && row.table.source == *source)
    }

    /// Removes a part; returns whether the row is a part. If it was the record's last part, the
    /// whole record is used again, unless the engineer left it out.
    pub fn remove_part(&mut self, index: usize) -> bool {
        if !self.is_part(index) {
            return false;
        }
        let source = self.rows.remove(index).table.source.clone();
        if !self.has_parts(&source) && !self.left_out.contains(&source) {
            for row in &mut self.rows {
                if row.table.source == source {
                    row.used = true;
                }
            }
        }
        self.choose(self.chosen);
        true
    }

    /// Cuts the parts of the record `old` from `whole`, which has replaced it; a part whose time
    /// span has no samples any more is removed. If the engineer left `old` out, `whole` counts as
    /// left out too.
    pub(super) fn cut_parts_anew(
        &mut self,
        old: &RecordSource,
        whole: &LaidOutRecord,
        channels: &RecordChannels,
    ) {
        for source in &mut self.left_out {
            if source == old {
                *source = whole.table.source.clone();
            }
        }
        for index in (0..self.rows.len()).rev() {
            let row = &self.rows[index];
            let Some(part_s) = row.table.part_s else {
                continue;
            };
            if row.table.source != *old {
                continue;
            }
            match part_of(whole, part_s, channels) {
                Ok(mut part) => {
                    part.used = row.used;
                    part.guess = row.guess.clone();
                    self.rows[index] = part;
                }
                Err(_) => {
                    self.rows.remove(index);
                }
            }
        }
    }
}

/// Cuts the part between two times \[s\] from a record.
///
/// # Errors
/// A message, if the record has fewer than two samples in that time span.
fn part_of(
    whole: &LaidOutRecord,
    part_s: [f64; 2],
    channels: &RecordChannels,
) -> Result<LaidOutRecord, Message> {
    // A pointer gives more digits than anyone can read: hundredths of a second are enough.
    let part_s = part_s.map(|time_s| (100.0 * time_s).round() / 100.0);
    let table = Arc::new(whole.table.part_of_time(part_s));
    let part = LaidOutRecord::new(table, whole.layout.clone(), whole.guess.clone(), channels);
    if let Some(flight) = &part.flight
        && flight.time_s.len() < 2
    {
        return Err(Message::new("no-samples", no_samples(whole, part_s)));
    }
    Ok(part)
}

/// Returns the message for the part `part_s` \[s\] of a record, which has fewer than the two
/// samples that a record needs.
fn no_samples(whole: &LaidOutRecord, part_s: [f64; 2]) -> String {
    let [from, to] = part_s.map(number);
    let mut message = format!(
        "{}: fewer than 2 samples from {from} to {to} s",
        whole.table.name
    );
    if let Some(span_s) = whole.span_s() {
        let [first, last] = span_s.map(|time_s| telling(time_s, 2));
        message.push_str(&format!(
            "; the record runs from {first} s to {last} s (write +{from} and +{to} to count from \
            its start)"
        ));
    }
    message
}
