//! Flight records read for identification.
//!
//! ```text
//! 1  read the files; an error without any record             (found_records)
//! 2  join the topics of logs, cut the requested parts
//! 3  assign the columns of each record to channels; leave out parts without samples
//!                                                            (RecordLayouts)
//! 4  an error if a requested part has samples in no record   (check_parts)
//! 5  repeat step 3 with the final units, if some channel had no unit beforehand
//! 6  leave out records with the same samples as another one
//! 7  an error if the columns of a remaining record are unclear
//! ```
//!
//! Topics are tables of the same log, each with some of the channels and time stamps of its own;
//! joining makes one record of them. A record is *laid out* when its columns are assigned to
//! channels. It is *used* unless it is a copy; its *problems* say why its columns are unclear.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_io::import::record_files::{FoundRecords, read_records};
use gdcm_model::dataset::Dataset;
use gdcm_sysid::identification::CautionNote;
use gdcm_sysid::records::layout_problem::LayoutCaution;
use gdcm_sysid::records::{
    LaidOutRecord, RecordChannels, RecordTable, TimeSettings, leave_out_copies, with_topics_joined,
};

use super::failure::Failure;
use super::identify_arguments::RecordArguments;
use super::option_values::RecordPart;
use super::progress::ReadingProgress;
use super::record_parts::{
    CutRecords, WholeRecord, cut_parts, is_requested_part, part_without_samples,
};
use super::terminal::{caution, error, note};
use crate::message_codes::{layout_caution_code, layout_problem_code};

/// Records read from files, with the messages about them.
pub(super) struct ReadRecords {
    pub(super) records: Vec<LaidOutRecord>,
    /// Requested files that could not be read completely.
    pub(super) unread: Vec<PathBuf>,
    /// Notes about assumptions made while reading, such as recognised columns.
    pub(super) reading: Vec<String>,
    pub(super) duplicates: Vec<Duplicate>,
    /// Whole records from which parts were cut, with their time spans.
    pub(super) wholes: Vec<WholeRecord>,
}

/// A record left out because its samples equal those in an earlier record.
pub(super) struct Duplicate {
    /// Name of the earlier record, which is used.
    pub(super) original: String,
    pub(super) caution: CautionNote,
}

/// Reads the records in files and folders; reports skipped content on standard error.
pub(super) fn found_records(paths: &[PathBuf]) -> Result<FoundRecords, Failure> {
    let found = read_records(paths, &ReadingProgress::new())?;
    for fault in &found.faults {
        caution("not-read", &format!("not read: {fault}"));
    }
    for words in &found.ignored {
        note("no-record", &format!("no record: {words}"));
    }
    if found.tables.is_empty() {
        Err(Failure::nothing_in(paths, "record"))
    } else {
        Ok(found)
    }
}

/// Reads the records and assigns their columns to channels, by the steps above. Assumptions and
/// faults are reported on standard error. Channels without a unit take the unit stated by a record.
///
/// # Errors
/// The files contain no record; a part names an unknown record or has no samples; the columns of a
/// record are unclear.
pub(super) fn laid_out_records(
    arguments: &RecordArguments,
    channels: &mut RecordChannels,
    dataset: Option<&Dataset>,
) -> Result<ReadRecords, Failure> {
    // Step 1.
    let FoundRecords { tables, unread, .. } = found_records(&arguments.records)?;
    let mut rules = channels.inputs.iter().chain(&channels.outputs);
    let units_are_known = rules.all(|rule| !rule.unit.is_empty());
    let mut layouts = RecordLayouts {
        dataset,
        time_settings: arguments.time_wish(),
        reported: Reported::default(),
    };
    // Step 2.
    let tables = with_topics_joined(tables, channels, &layouts.time_settings);
    let CutRecords { tables, wholes } = if arguments.part.is_empty() {
        CutRecords {
            tables,
            wholes: Vec::new(),
        }
    } else {
        cut_parts(&tables, &arguments.part, |table| {
            layouts.span_s(table, channels)
        })?
    };
    // Step 3.
    let mut records = layouts.lay_out_all(tables, channels);
    // Step 4.
    check_parts(&arguments.part, &records, &wholes)?;
    // Step 5.
    if !units_are_known {
        records = layouts.lay_out_again(records, channels);
    }
    // Step 6.
    leave_out_copies(&mut records);
    let mut duplicates = Vec::new();
    for record in &records {
        if !record.used {
            duplicates.extend(report_duplicates(record));
        }
    }
    records.retain(|record| record.used);
    // Step 7.
    let unclear = records.iter().filter(|record| !record.problems.is_empty());
    let wrong = unclear.count();
    if wrong > 0 {
        return Err(Failure::Records {
            wrong,
            count: records.len(),
        });
    }
    Ok(ReadRecords {
        records,
        unread,
        reading: layouts.reported.reading,
        duplicates,
        wholes,
    })
}

/// Assigns record columns to channels, and reports notes, cautions and problems.
struct RecordLayouts<'a> {
    dataset: Option<&'a Dataset>,
    /// Time column or sample rate given on the command line.
    time_settings: TimeSettings,
    reported: Reported,
}

/// Messages reported so far. If a record has the same messages as the previous one, they are not
/// repeated.
#[derive(Default)]
struct Reported {
    /// Notes about assumptions made while reading, each prefixed with its record's name.
    reading: Vec<String>,
    last_notes: Vec<String>,
    last_problems: Vec<String>,
}

impl RecordLayouts<'_> {
    /// Assigns a record's columns, as stated in the dataset if it lists the record; returns the
    /// notes about assumptions too. The record is marked as used even if the dataset excludes it,
    /// because it was requested.
    fn lay_out(
        &self,
        table: RecordTable,
        channels: &RecordChannels,
    ) -> (LaidOutRecord, Vec<String>) {
        let Some(dataset) = self.dataset else {
            return LaidOutRecord::proposed(table, channels, &self.time_settings);
        };
        let (mut record, notes) =
            LaidOutRecord::proposed_for_dataset(table, channels, dataset, &self.time_settings);
        record.used = true;
        (record, notes)
    }

    /// Returns a record's first and last time \[s\], to which the times of its parts may relate;
    /// `None` if its columns are unclear. The record is laid out only to find its time column.
    fn span_s(&self, table: &RecordTable, channels: &RecordChannels) -> Option<[f64; 2]> {
        let (record, _) = self.lay_out(table.clone(), channels);
        record.span_s()
    }

    /// Assigns all records' columns, and reports notes (for a log, first those of its format),
    /// cautions and problems. Channels without a unit take the unit stated by a record. Parts
    /// without samples are omitted.
    fn lay_out_all(
        &mut self,
        tables: Vec<RecordTable>,
        channels: &mut RecordChannels,
    ) -> Vec<LaidOutRecord> {
        let mut records = Vec::new();
        for table in tables {
            let (record, mut notes) = self.lay_out(table, channels);
            let name = &record.table.name;
            if is_empty_part(&record) {
                let text = format!("{name}: no samples in the requested part");
                note("no-samples-in-part", &text);
                continue;
            }
            if is_log(&record.table) {
                notes.splice(0..0, record.table.notes.iter().cloned());
            }
            self.reported.add_notes(name, notes);
            for words in &record.cautions {
                caution(layout_caution_code(words), &format!("{name}: {words}"));
            }
            self.reported.add_problems(&record);
            channels.take_units(&record.layout, &record.table);
            records.push(record);
        }
        records
    }

    /// Repeats the assignment for the usable records with the final units: the records before the
    /// first that states units were assigned without them. Only new problems are reported; a record
    /// with problems keeps them.
    fn lay_out_again(
        &self,
        records: Vec<LaidOutRecord>,
        channels: &RecordChannels,
    ) -> Vec<LaidOutRecord> {
        let mut again = Vec::new();
        for record in records {
            if !record.problems.is_empty() {
                again.push(record);
                continue;
            }
            let (record, _) = self.lay_out(Arc::unwrap_or_clone(record.table), channels);
            for words in &record.problems {
                let text = format!("{}: {words}", record.table.name);
                error(layout_problem_code(words), &text);
            }
            again.push(record);
        }
        again
    }
}

impl Reported {
    /// Reports a record's notes, unless they equal the previous record's.
    fn add_notes(&mut self, name: &str, notes: Vec<String>) {
        if notes == self.last_notes {
            return;
        }
        for words in &notes {
            let words = format!("{name}: {words}");
            note("record-layout", &words);
            self.reading.push(words);
        }
        self.last_notes = notes;
    }

    /// Reports a record's problems, unless they equal the previous record's.
    fn add_problems(&mut self, record: &LaidOutRecord) {
        let problems: Vec<String> = record.problems.iter().map(ToString::to_string).collect();
        if problems == self.last_problems {
            return;
        }
        for problem in &record.problems {
            let text = format!("{}: {problem}", record.table.name);
            error(layout_problem_code(problem), &text);
        }
        self.last_problems = problems;
    }
}

/// Returns whether a record is a part with fewer than two samples: a part requested for all records
/// may lie outside some of them.
fn is_empty_part(record: &LaidOutRecord) -> bool {
    match (&record.table.part_s, &record.flight) {
        (Some(_), Some(flight)) => flight.time_s.len() < 2,
        _ => false,
    }
}

/// Returns whether a record comes from a log; its notes state format and sign convention.
fn is_log(table: &RecordTable) -> bool {
    table
        .columns
        .iter()
        .any(|column| column.topic.is_some() || column.meaning.is_some())
}

/// Rejects a requested part in which no record has samples.
fn check_parts(
    parts: &[RecordPart],
    records: &[LaidOutRecord],
    wholes: &[WholeRecord],
) -> Result<(), Failure> {
    for part in parts {
        if !records
            .iter()
            .any(|record| is_requested_part(&record.table, part, wholes))
        {
            return Err(part_without_samples(part, wholes));
        }
    }
    Ok(())
}

/// Reports the earlier records with the same samples as `record`, and returns the cautions about
/// them.
pub(super) fn report_duplicates(record: &LaidOutRecord) -> Vec<Duplicate> {
    let mut duplicates = Vec::new();
    for reason in &record.cautions {
        let LayoutCaution::Copy { first } = reason else {
            continue;
        };
        let text = format!("{}: {reason}", record.table.name);
        caution("duplicate", &text);
        duplicates.push(Duplicate {
            original: first.clone(),
            caution: CautionNote {
                code: "duplicate",
                records: vec![record.table.name.clone()],
                text,
                ..CautionNote::default()
            },
        });
    }
    duplicates
}
