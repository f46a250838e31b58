//! Marks for a channel's cautions: for its time chart's accessible name, and its read-out's
//! tooltip.

use super::page::Page;

/// Returns short marks for the cautions about a channel, in the displayed record or in all records.
pub(super) fn channel_caution_marks(page: Page<'_>, channel: &str) -> Vec<String> {
    let records = page.records;
    let mut marks = Vec::new();
    for (rows, note) in records.cautions() {
        let is_of_record = rows.is_empty() || rows.contains(&records.chosen);
        if is_of_record && note.channel.as_deref() == Some(channel) {
            marks.push(format!("⚠ {}", note.mark()));
        }
    }
    marks
}
