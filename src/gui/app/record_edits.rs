//! Undoable edits of the records of a condition: which records are used, their parts, manoeuvres,
//! remedies, and the settings of the identification.

use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::simulation::Signal;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels};

use super::GdcmApp;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::condition_records::ConditionRecords;
use crate::gui::state::records::RecordsBefore;

impl GdcmApp {
    /// Applies an edit to the records of a condition; it can be undone.
    pub(super) fn edit_records(&mut self, condition: ConditionId, command: RecordsCommand) {
        let channels = self.record_channels(condition);
        let before = self.state.records.before([condition]);
        let Some(records) = self.state.records.conditions.get_mut(&condition) else {
            return;
        };
        let label = format!("{} (condition {condition})", edit_label(records, &command));
        match apply_edit(records, command, &channels) {
            Ok(true) => {
                records.changed = true;
                self.record_edited(label, before);
                self.follow_band(condition);
            }
            Ok(false) => {}
            Err(problem) => self.notify_error(problem),
        }
    }

    /// Adds an edit of records to the undo history.
    pub(super) fn record_edited(&mut self, label: String, before: RecordsBefore) {
        let study = self.state.study.clone();
        self.state.history.record_beside(study, label, before);
        self.state.notice = None;
    }
}

/// Returns the label of an edit in the undo history.
fn edit_label(records: &ConditionRecords, command: &RecordsCommand) -> String {
    match command {
        RecordsCommand::SetKind(index, kind) => {
            format!("{} is a {}", record_name(records, *index), kind.word())
        }
        RecordsCommand::SetUsed(index, true) => format!("use {}", record_name(records, *index)),
        RecordsCommand::SetUsed(index, false) => {
            format!("leave {} out", record_name(records, *index))
        }
        RecordsCommand::SetHeldOut(index, true) => {
            format!("hold {} out", record_name(records, *index))
        }
        RecordsCommand::SetHeldOut(index, false) => format!("fit {}", record_name(records, *index)),
        RecordsCommand::SetDelay(signal, _) => format!("time skew of {}", signal.name),
        RecordsCommand::SetRemedies(index, _) => {
            format!("correct {}", record_name(records, *index))
        }
        RecordsCommand::SetHold(signal, _) => format!("hold of {}", signal.name),
        RecordsCommand::SetBand(_) => "identification band".to_owned(),
        RecordsCommand::SetSearch(_) => "identification search settings".to_owned(),
        RecordsCommand::SetReferences(_) => "references".to_owned(),
        RecordsCommand::AddPart(index, _) => format!("part of {}", record_name(records, *index)),
        RecordsCommand::RemovePart(index) => format!("remove {}", record_name(records, *index)),
        _ => "records".to_owned(),
    }
}

fn record_name(records: &ConditionRecords, index: usize) -> &str {
    match records.rows.get(index) {
        Some(row) => &row.table.name,
        None => "a record",
    }
}

/// Applies an edit to the records of a condition; returns false if the command is no such edit.
///
/// # Errors
/// A message, if the edit is impossible.
fn apply_edit(
    records: &mut ConditionRecords,
    command: RecordsCommand,
    channels: &RecordChannels,
) -> Result<bool, String> {
    match command {
        RecordsCommand::SetUsed(index, used) => return Ok(records.set_used(index, used)),
        RecordsCommand::AddPart(index, part_s) => records.add_part(index, part_s, channels)?,
        RecordsCommand::RemovePart(index) => return Ok(records.remove_part(index)),
        RecordsCommand::SetKind(index, kind) => {
            if let Some(row) = records.rows.get_mut(index) {
                row.guess.kind = kind;
            }
        }
        RecordsCommand::SetHeldOut(index, held_out) => {
            if let Some(row) = records.rows.get_mut(index) {
                row.guess.held_out = held_out;
            }
        }
        RecordsCommand::SetDelay(signal, delay_s) => {
            if let Some(channel) = records.channel_mut(&signal) {
                channel.delay_s = delay_s;
            }
        }
        RecordsCommand::SetRemedies(index, remedies) => {
            if let Some(row) = records.rows.get_mut(index) {
                set_remedies(row, &remedies, channels);
            }
        }
        RecordsCommand::SetHold(signal, hold) => {
            if let Some(channel) = records.channel_mut(&signal) {
                channel.hold = hold;
            }
        }
        RecordsCommand::SetBand(band) => records.band = band,
        RecordsCommand::SetSearch(search) => records.search = search,
        RecordsCommand::SetReferences(references) => records.references = references,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Sets the delays and factors of channels in a single record.
fn set_remedies(
    row: &mut LaidOutRecord,
    remedies: &[(Signal, ChannelRemedy)],
    channels: &RecordChannels,
) {
    let mut layout = row.layout.clone();
    for (signal, remedy) in remedies {
        if let Some(column) = layout.channel_mut(signal.role, signal.index) {
            column.remedy = *remedy;
        }
    }
    *row = row.laid_out(layout, channels);
}
