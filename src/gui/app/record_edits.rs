//! Undoable edits to a condition's records: which records are used, their parts, manoeuvres,
//! remedies, and the identification settings.
//!
//! A *row* is a record as it was read, with the columns assigned to its channels (its layout); its
//! *guess* holds manoeuvre and hold-out, guessed from names until the engineer sets them. A *part*
//! is a time span cut from a record, with a row of its own. *Topics* are a log's tables with clocks
//! of their own, resampled to a common clock, which depends on the upper end of the identification
//! band (`follow_band`).

use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::simulation::Signal;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, leave_out_copies};

use super::GdcmApp;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::condition_records::{AddedRecord, ConditionRecords};
use crate::gui::state::record_change::{ConditionRecordChange, RecordChange};
use crate::gui::state::records::RecordsSnapshot;
use crate::message::Message;

impl GdcmApp {
    /// Applies an edit to a condition's records, after which the identification is outdated; the
    /// edit can be undone.
    pub(super) fn edit_records(&mut self, condition: ConditionId, command: RecordsCommand) {
        let channels = self.record_channels(condition);
        let before = self.state.records.before([condition]);
        let Some(records) = self.state.records.conditions.get_mut(&condition) else {
            return;
        };
        let change = RecordChange::InCondition {
            condition,
            change: described_edit(records, &command),
        };
        match apply_edit(records, command, &channels) {
            Ok(true) => {
                records.changed_since_fit = true;
                self.record_edited(change, before);
                self.follow_band(condition);
            }
            Ok(false) => {}
            Err(problem) => self.notify_error(problem),
        }
    }

    /// Moves added records without a condition to a condition; this can be undone.
    pub(super) fn assign_records(&mut self, indices: &[usize], condition: ConditionId) {
        let mut before = self.state.records.before([condition]);
        before.unassigned = Some(self.state.records.unassigned.clone());
        let mut rows = Vec::new();
        let mut others = Vec::new();
        for (index, row) in std::mem::take(&mut self.state.records.unassigned)
            .into_iter()
            .enumerate()
        {
            if indices.contains(&index) {
                rows.push(row);
            } else {
                others.push(row);
            }
        }
        self.state.records.unassigned = others;
        if rows.is_empty() {
            return;
        }
        let read_from = self.state.records.read_from.clone();
        let channels = self.record_channels(condition);
        let records = self.records_of(condition);
        let count = rows.len();
        let mut is_changed = false;
        for row in rows {
            let outcome = records.add_row(row, &read_from, &channels);
            is_changed |= outcome != AddedRecord::KnownAlready;
        }
        if is_changed {
            leave_out_copies(&mut records.rows);
            records.changed_since_fit = true;
            // The topics' common clock was chosen for another condition; `follow_band` chooses it
            // anew.
            records.clock_band_end = None;
        }
        let change = RecordChange::Assign {
            records: count,
            condition,
        };
        self.record_edited(change, before);
        self.follow_band(condition);
    }

    /// Removes an added record without a condition; this can be undone.
    pub(super) fn discard_record(&mut self, index: usize) {
        let mut before = self.state.records.before([]);
        before.unassigned = Some(self.state.records.unassigned.clone());
        if index >= self.state.records.unassigned.len() {
            return;
        }
        let row = self.state.records.unassigned.remove(index);
        let record = row.table.name.clone();
        self.record_edited(RecordChange::Discard { record }, before);
    }

    /// Adds a record edit to the undo history, which holds it beside the unchanged study, and
    /// removes toasts that it makes obsolete.
    pub(super) fn record_edited(&mut self, change: RecordChange, before: RecordsSnapshot) {
        let study = self.state.study.clone();
        self.state.history.record_outside(study, change, before);
        self.state.notices.drop_obsolete_toasts();
    }
}

/// Describes an edit for the undo history.
fn described_edit(records: &ConditionRecords, command: &RecordsCommand) -> ConditionRecordChange {
    match command {
        RecordsCommand::SetKind(index, kind) => ConditionRecordChange::Kind {
            record: record_name(records, *index),
            kind: *kind,
        },
        RecordsCommand::SetUsed(index, used) => ConditionRecordChange::Use {
            record: record_name(records, *index),
            used: *used,
        },
        RecordsCommand::SetHeldOut(index, held_out) => ConditionRecordChange::HoldOut {
            record: record_name(records, *index),
            held_out: *held_out,
        },
        RecordsCommand::SetDelay(signal, _) => ConditionRecordChange::TimeSkew {
            channel: signal.name.clone(),
        },
        RecordsCommand::SetRemedies(index, _) => ConditionRecordChange::Remedies {
            record: record_name(records, *index),
        },
        RecordsCommand::SetHold(signal, _) => ConditionRecordChange::SampleHold {
            channel: signal.name.clone(),
        },
        RecordsCommand::SetBand(_) => ConditionRecordChange::Band,
        RecordsCommand::SetSearch(_) => ConditionRecordChange::Search,
        RecordsCommand::SetReferences(_) => ConditionRecordChange::References,
        RecordsCommand::AddPart(index, _) => ConditionRecordChange::AddPart {
            record: record_name(records, *index),
        },
        RecordsCommand::MovePart(index, _) => ConditionRecordChange::MovePart {
            record: record_name(records, *index),
        },
        RecordsCommand::RemovePart(index) => ConditionRecordChange::RemovePart {
            record: record_name(records, *index),
        },
        _ => ConditionRecordChange::Records,
    }
}

fn record_name(records: &ConditionRecords, index: usize) -> String {
    match records.rows.get(index) {
        Some(row) => row.table.name.clone(),
        None => "a record".to_owned(),
    }
}

/// Applies an edit to a condition's records; returns false if nothing was applied: the command is
/// not an edit of records, its row or channel does not exist, or it removes a row that is no part.
///
/// # Errors
/// A message, if a part cannot be added or moved.
fn apply_edit(
    records: &mut ConditionRecords,
    command: RecordsCommand,
    channels: &RecordChannels,
) -> Result<bool, Message> {
    match command {
        RecordsCommand::SetUsed(index, used) => return Ok(records.set_used(index, used)),
        RecordsCommand::AddPart(index, part_s) => records.add_part(index, part_s, channels)?,
        RecordsCommand::MovePart(index, part_s) => records.move_part(index, part_s, channels)?,
        RecordsCommand::RemovePart(index) => return Ok(records.remove_part(index)),
        RecordsCommand::SetKind(index, kind) => {
            let Some(row) = records.rows.get_mut(index) else {
                return Ok(false);
            };
            row.guess.kind = kind;
        }
        RecordsCommand::SetHeldOut(index, held_out) => {
            let Some(row) = records.rows.get_mut(index) else {
                return Ok(false);
            };
            row.guess.held_out = held_out;
        }
        RecordsCommand::SetDelay(signal, delay_s) => {
            let Some(channel) = records.channel_mut(&signal) else {
                return Ok(false);
            };
            channel.delay_s = delay_s;
        }
        RecordsCommand::SetRemedies(index, remedies) => {
            let Some(row) = records.rows.get_mut(index) else {
                return Ok(false);
            };
            set_remedies(row, &remedies, channels);
        }
        RecordsCommand::SetHold(signal, hold) => {
            let Some(channel) = records.channel_mut(&signal) else {
                return Ok(false);
            };
            channel.hold = hold;
        }
        RecordsCommand::SetBand(band) => records.band = band,
        RecordsCommand::SetSearch(search) => records.search = search,
        RecordsCommand::SetReferences(references) => records.references = references,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Sets channel delays and factors in a single record.
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
