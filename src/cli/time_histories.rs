//! Flight records with which models are compared in the time domain (M17.2), for
//! `gdcm requirements` and `gdcm report`. Unlike `flight_records`, which serves the identification,
//! this module reports a record that cannot be used as a caution and goes on with the others.
//!
//! A record is *laid out* when its columns are assigned to channels; an *entry* is what the dataset
//! states about a record.

use gdcm_io::import::record_files::FoundRecords;
use gdcm_model::dataset::{Band, ConditionId, Dataset};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_study::results::record_simulations::time_histories_of;
use gdcm_study::results::time_histories::{HistoryRecords, TimeHistories};
use gdcm_study::{Analysis, Execution};
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::records::record_channels::DeclaredConversion;
use gdcm_sysid::records::{
    LaidOutRecord, LayoutProblem, RecordChannels, RecordTable, TimeSettings, leave_out_copies,
    with_topics_joined,
};

use super::failure::Failure;
use super::flight_records::{found_records, report_duplicates};
use super::progress::TerminalProgress;
use super::requested_channels::declare_conversions;
use super::result_arguments::HistoryArguments;
use super::terminal::{caution, note};
use crate::executor::Pool;
use crate::message_codes::{layout_caution_code, layout_problem_code};

/// Each condition's flight records, and those that could not be read.
#[derive(Default)]
pub(super) struct ReadHistories {
    pub(super) conditions: Vec<HistoryRecords>,
    /// Requested records that could not be read completely, or that lack a unit.
    unread: Vec<String>,
}

impl ReadHistories {
    /// Returns the outcome for a command that used these records: a failure if some were not read
    /// completely.
    pub(super) fn into_outcome(self) -> Result<(), Failure> {
        if self.unread.is_empty() {
            return Ok(());
        }
        Err(Failure::Unread {
            paths: self.unread.join(", "),
        })
    }
}

/// Reads each condition's records; none without the option `--records`.
///
/// 1. Reads the files, and joins the topics of logs, resampled to a sample rate suitable for
///    `band`.
/// 2. Assigns the columns of each record to channels, and determines its condition; keeps the
///    usable records of known conditions, and reports why the others are omitted.
/// 3. Leaves out records with the same samples as another one.
/// 4. Groups the records by condition; the samples are compared as they are, without preparation.
///
/// # Errors
/// The files contain no record, or a declared unit concerns an unknown channel.
pub(super) fn read_histories(
    arguments: &HistoryArguments,
    dataset: &Dataset,
    band: Band,
) -> Result<ReadHistories, Failure> {
    if arguments.records.is_empty() {
        return Ok(ReadHistories::default());
    }
    // Step 1.
    let FoundRecords { tables, unread, .. } = found_records(&arguments.records)?;
    let mut unread: Vec<String> = unread.iter().map(|path| sanitized_path(path)).collect();
    let mut channels = RecordChannels::of_dataset(dataset);
    channels.resampling.band_end = Some(band.max());
    declare_conversions(
        "--unit",
        &arguments.unit,
        DeclaredConversion::Unit,
        &mut channels,
    )?;
    // The records, and at the same index each record's condition.
    let mut records: Vec<LaidOutRecord> = Vec::new();
    let mut ids: Vec<ConditionId> = Vec::new();
    // Steps 1 and 2.
    for table in with_topics_joined(tables, &channels, &TimeSettings::default()) {
        let laid_out = laid_out_record(table, dataset, &channels);
        report_record(&laid_out);
        // Counts as not read, because the option `--unit` can supply the missing unit.
        if laid_out.lacks_unit() {
            unread.push(sanitized(&laid_out.record.table.name));
        }
        if let Some(id) = laid_out.condition
            && laid_out.record.used_flight().is_some()
        {
            ids.push(id);
            records.push(laid_out.record);
        }
    }
    // Step 3.
    leave_out_copies(&mut records);
    for record in &records {
        report_duplicates(record);
    }
    // Step 4.
    let preparation = unchanged_channels(dataset);
    let mut conditions = Vec::new();
    for condition in dataset.conditions() {
        let own = ids
            .iter()
            .zip(&records)
            .filter(|(id, _)| **id == condition.id())
            .map(|(_, record)| record);
        let histories = HistoryRecords::from_used(condition.id(), own, preparation.clone());
        if !histories.records.is_empty() {
            conditions.push(histories);
        }
    }
    Ok(ReadHistories { conditions, unread })
}

/// Computes the models' responses to the records; shows the progress on a terminal.
pub(super) fn simulated_histories(
    analysis: &Analysis,
    records: &ReadHistories,
) -> Result<TimeHistories, Failure> {
    let records = records.conditions.as_slice();
    let progress = TerminalProgress::new("simulating models with records");
    let execution = Execution::new(&Pool, &progress, HistoryRecords::steps(records));
    let tolerances = &analysis.study.requirements.tolerances;
    Ok(time_histories_of(
        analysis, records, tolerances, &execution,
    )?)
}

/// A record and its condition; `None` if the condition is unknown.
struct ConditionRecord {
    condition: Option<ConditionId>,
    record: LaidOutRecord,
}

impl ConditionRecord {
    /// Returns whether the record belongs to a known condition but is unusable because a unit is
    /// unknown.
    fn lacks_unit(&self) -> bool {
        self.condition.is_some()
            && self
                .record
                .problems
                .iter()
                .any(|problem| matches!(problem, LayoutProblem::UnitNotGiven { .. }))
    }
}

/// Assigns a record's columns, and determines its condition.
///
/// If the dataset lists the record, both follow from its entry; otherwise the columns are
/// recognised, and the condition is the dataset's only condition, or else the one in the record's
/// name.
fn laid_out_record(
    table: RecordTable,
    dataset: &Dataset,
    channels: &RecordChannels,
) -> ConditionRecord {
    if let Some((condition, entry)) = table.entry_of_dataset(dataset) {
        let channels = channels.clone().of_named_records();
        let (record, _) = LaidOutRecord::proposed(table, &channels, &TimeSettings::default());
        return ConditionRecord {
            condition: Some(condition),
            record: record.with_entry(entry, &channels),
        };
    }
    let (record, _) = LaidOutRecord::proposed(table, channels, &TimeSettings::default());
    let condition = match dataset.conditions() {
        [only] => Some(only.id()),
        _ => record.guess.condition_of(dataset),
    };
    ConditionRecord { condition, record }
}

/// Reports a record's cautions and problems, and why it is omitted.
fn report_record(laid_out: &ConditionRecord) {
    let record = &laid_out.record;
    let name = &record.table.name;
    if laid_out.condition.is_none() {
        let text = format!("{name}: left out, because its name gives no condition of the dataset");
        caution("record-without-condition", &text);
        return;
    }
    for words in &record.cautions {
        caution(layout_caution_code(words), &format!("{name}: {words}"));
    }
    for words in &record.problems {
        let text = format!("{name} is left out: {words}");
        caution(layout_problem_code(words), &text);
    }
    if !record.used {
        let text = format!("{name}: left out, because the dataset excludes it");
        note("record-excluded", &text);
    }
}

/// Returns preparation settings that leave every channel unchanged.
fn unchanged_channels(dataset: &Dataset) -> Preparation {
    let (inputs, outputs) = dataset.input_and_output_names();
    let inputs: Vec<&str> = inputs.iter().map(String::as_str).collect();
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    Preparation::new(&inputs, &outputs)
}
