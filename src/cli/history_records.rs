//! The flight records that models are compared with in time (M17.2).

use std::path::{Path, PathBuf};

use clap::Args;
use gdcm_core::dataset::{Band, Condition, ConditionId, ConditionRecord, Dataset};
use gdcm_core::identification::Preparation;
use gdcm_core::records::{
    LaidOutRecord, LayoutCaution, RecordChannels, RecordTable, TimeWish, leave_out_copies, with_topics_joined,
};
use gdcm_core::study::{Analysis, Execution, HistoryRecords, TimeHistories, time_histories_of};
use gdcm_files::{FoundRecords, read_records};

use super::{Failure, ReadingProgress, TerminalProgress, caution, note};
use crate::executor::Pool;

/// What models are compared with in time.
#[derive(Debug, Args)]
pub struct HistoryArguments {
    /// Flight records, each of the condition that its name says: files, or folders with all that is in them. The models answer to their
    /// sticks, and their share of time within tolerances is told; may be repeated.
    #[arg(long, value_name = "PATH")]
    pub records: Vec<PathBuf>,
}

impl HistoryArguments {
    /// The records of each condition, topics brought to a clock for this band; what is not taken is told on standard error.
    pub(super) fn read(&self, dataset: &Dataset, band: Band) -> Result<Vec<HistoryRecords>, Failure> {
        if self.records.is_empty() {
            return Ok(Vec::new());
        }
        let FoundRecords { tables, faults, ignored, .. } = read_records(&self.records, &ReadingProgress::new())?;
        faults.iter().for_each(|fault| caution(&format!("not taken: {fault}")));
        ignored.iter().for_each(|words| note(&format!("no record: {words}")));
        if tables.is_empty() {
            return Err(Failure::nothing_in(&self.records, "record"));
        }
        let mut channels = RecordChannels::of_dataset(dataset);
        channels.resampling.band_end = Some(band.max());
        let tables = with_topics_joined(tables, &channels, &TimeWish::default());
        let records = tables.into_iter().filter_map(|table| record_of(table, dataset, &channels));
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
        Ok(conditions.filter(|of| !of.records.is_empty()).collect())
    }
}

/// The answers of the models to records, with a word about how far it is on a terminal.
pub(super) fn time_histories(analysis: &Analysis, records: &[HistoryRecords]) -> Result<TimeHistories, Failure> {
    let progress = TerminalProgress::new("simulating records");
    let execution = Execution::new(&Pool, &progress, HistoryRecords::steps(records));
    Ok(time_histories_of(analysis, records, &analysis.study.requirements.tolerances, &execution)?)
}

/// A record and its condition, as the dataset says of it where it does; none where it has no condition, or its columns are not clear.
fn record_of(table: RecordTable, dataset: &Dataset, channels: &RecordChannels) -> Option<(ConditionId, LaidOutRecord)> {
    let (record, _) = LaidOutRecord::proposed(table, channels, &TimeWish::default());
    let name = record.table.name.clone();
    let entry = dataset.conditions().iter().find_map(|of| Some((of.id(), entry_of(of.records(), &record.table)?)));
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
    if !record.used {
        note(&format!("{name}: left out: the dataset says so"));
    }
    record.used_flight()?;
    Some((condition, record))
}

/// What a dataset says of a record: by its name in a file of the same name.
fn entry_of<'e>(entries: &'e [ConditionRecord], table: &RecordTable) -> Option<&'e ConditionRecord> {
    let file_name = |file: &str| Path::new(file).file_name().map(ToOwned::to_owned);
    entries.iter().find(|entry| {
        let same_file = file_name(&entry.file) == file_name(&table.source.file);
        same_file && entry.variable == table.source.variable && entry.part_s.is_none()
    })
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
