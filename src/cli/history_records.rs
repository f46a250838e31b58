//! The flight records that models are compared with in time (M17.2).

use std::path::{Path, PathBuf};

use clap::Args;
use gdcm_core::dataset::{Band, Condition, ConditionId, ConditionRecord, Dataset};
use gdcm_core::identification::Preparation;
use gdcm_core::message_text::{sanitized, sanitized_path};
use gdcm_core::records::{
    LaidOutRecord, LayoutCaution, LayoutProblem, RecordChannels, RecordTable, TimeWish, leave_out_copies,
    with_topics_joined,
};
use gdcm_core::study::{Analysis, Execution, HistoryRecords, TimeHistories, time_histories_of};
use gdcm_files::FoundRecords;

use super::{ChannelConversion, Failure, TerminalProgress, caution, found_records, note, said_unit, say_conversions};
use crate::executor::Pool;

/// What models are compared with in time.
#[derive(Debug, Args)]
pub struct HistoryArguments {
    /// Flight records, each of the condition that its name says: files, or folders with all that is in them. The models answer to their
    /// sticks, and their share of time within tolerances is told; may be repeated.
    #[arg(long, value_name = "PATH")]
    pub records: Vec<PathBuf>,
    /// The unit of a channel's samples in records that do not say it; may be repeated.
    #[arg(long, value_name = "CHANNEL=UNIT", value_parser = said_unit, requires = "records")]
    pub unit: Vec<ChannelConversion>,
}

/// The records of each condition.
#[derive(Default)]
pub(super) struct ReadHistories {
    /// They.
    pub(super) conditions: Vec<HistoryRecords>,
    /// What was asked for and could not be read, or not all of it.
    unread: Vec<String>,
}

impl ReadHistories {
    /// How the command ends whose work was done with them.
    pub(super) fn ended(&self) -> Result<(), Failure> {
        let paths = self.unread.join(", ");
        if paths.is_empty() { Ok(()) } else { Err(Failure::Unread { paths }) }
    }
}

impl HistoryArguments {
    /// The records of each condition, topics brought to a clock for this band; what is not taken is told on standard error.
    pub(super) fn read(&self, dataset: &Dataset, band: Band) -> Result<ReadHistories, Failure> {
        if self.records.is_empty() {
            return Ok(ReadHistories::default());
        }
        let FoundRecords { tables, unread, .. } = found_records(&self.records)?;
        let mut unread: Vec<String> = unread.iter().map(|path| sanitized_path(path)).collect();
        let mut channels = RecordChannels::of_dataset(dataset);
        channels.resampling.band_end = Some(band.max());
        say_conversions("--unit", &self.unit, &mut channels)?;
        let tables = with_topics_joined(tables, &channels, &TimeWish::default());
        let records = tables.into_iter().filter_map(|table| record_of(table, dataset, &channels, &mut unread));
        let (of, mut records): (Vec<ConditionId>, Vec<LaidOutRecord>) = records.unzip();
        leave_out_copies(&mut records);
        records.iter().for_each(tell_copies);
        let preparation = preparation(dataset);
        let of_condition = |condition: &Condition| {
            let id = condition.id();
            let own = of.iter().zip(&records).filter(|(of, _)| **of == id).map(|(_, record)| record);
            HistoryRecords::of(id, own, preparation.clone())
        };
        let conditions = dataset.conditions().iter().map(|condition| of_condition(condition));
        let conditions = conditions.filter(|of| !of.records.is_empty()).collect();
        Ok(ReadHistories { conditions, unread })
    }
}

/// The answers of the models to records, with a word about how far it is on a terminal.
pub(super) fn time_histories(analysis: &Analysis, records: &ReadHistories) -> Result<TimeHistories, Failure> {
    let records = records.conditions.as_slice();
    let progress = TerminalProgress::new("simulating records");
    let execution = Execution::new(&Pool, &progress, HistoryRecords::steps(records));
    Ok(time_histories_of(analysis, records, &analysis.study.requirements.tolerances, &execution)?)
}

/// A record and its condition, as the dataset says of it where it does; none where it has no condition, or its columns are not clear:
/// one whose units are not said is among what was not read.
fn record_of(
    table: RecordTable,
    dataset: &Dataset,
    channels: &RecordChannels,
    unread: &mut Vec<String>,
) -> Option<(ConditionId, LaidOutRecord)> {
    let entry = entry_of_dataset(dataset, &table);
    let named = entry.map(|_| channels.clone().of_named_records());
    let channels = named.as_ref().unwrap_or(channels);
    let (record, _) = LaidOutRecord::proposed(table, channels, &TimeWish::default());
    let name = record.table.name.clone();
    let (condition, record) = match (entry, dataset.conditions()) {
        (Some((condition, entry)), _) => (Some(condition), record.as_said(entry, channels)),
        (None, [only]) => (Some(only.id()), record),
        (None, _) => (record.guess.condition_of(dataset), record),
    };
    let Some(condition) = condition else {
        caution(&format!("{name}: left out: its name says no condition of the dataset"));
        return None;
    };
    record.cautions.iter().for_each(|words| caution(&format!("{name}: {words}")));
    record.problems.iter().for_each(|words| caution(&format!("{name}: left out: {words}")));
    let is_unsaid = record.problems.iter().any(|problem| matches!(problem, LayoutProblem::UnsaidUnit { .. }));
    unread.extend(is_unsaid.then(|| sanitized(&name)));
    if !record.used {
        note(&format!("{name}: left out: the dataset says so"));
    }
    record.used_flight()?;
    Some((condition, record))
}

/// What a dataset says of a record, and the condition: by its name in a file of the same name, or in an archive of another.
pub(super) fn entry_of_dataset<'d>(
    dataset: &'d Dataset,
    table: &RecordTable,
) -> Option<(ConditionId, &'d ConditionRecord)> {
    let file_name = |file: &str| Path::new(file).file_name().map(ToOwned::to_owned);
    let is_it = |entry: &&ConditionRecord| {
        let same_file = file_name(&entry.file) == file_name(&table.source.file);
        let same_name = entry.variable.is_some() && entry.name == table.name;
        (same_file || same_name) && entry.variable == table.source.variable && entry.part_s.is_none()
    };
    dataset.conditions().iter().find_map(|of| Some((of.id(), of.records().iter().find(is_it)?)))
}

fn tell_copies(record: &LaidOutRecord) {
    for why in record.cautions.iter().filter(|why| matches!(why, LayoutCaution::Copy { .. })) {
        caution(&format!("{}: {why}", record.table.name));
    }
}

/// Every channel as it is.
fn preparation(dataset: &Dataset) -> Preparation {
    let (inputs, outputs) = dataset.names_of_channels();
    let [inputs, outputs]: [Vec<&str>; 2] = [&inputs, &outputs].map(|of| of.iter().map(String::as_str).collect());
    Preparation::of(&inputs, &outputs)
}
