//! Flight records: those used for identification, and those compared with models in the time domain
//! (M17.2).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use gdcm_io::import::record_files::{FoundRecords, read_records};
use gdcm_model::dataset::{Band, ConditionId, Dataset};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::units::{number, telling};
use gdcm_study::results::time_histories::{HistoryRecords, TimeHistories, time_histories_of};
use gdcm_study::{Analysis, Execution};
use gdcm_sysid::identification::{CautionNote, Preparation};
use gdcm_sysid::records::layout_problem::LayoutCaution;
use gdcm_sysid::records::record_channels::SaidConversion;
use gdcm_sysid::records::time_base::median_step;
use gdcm_sysid::records::{
    LaidOutRecord, LayoutProblem, RecordChannels, RecordSource, RecordTable, TimeWish,
    leave_out_copies, with_topics_joined,
};
use gdcm_words::Table;

use super::arguments::OfChannel;
use super::identify_arguments::{
    IdentifyArguments, RecordPart, channel_unit, record_part, say_conversions,
};
use super::models::ReadingProgress;
use super::terminal::{Failure, TerminalProgress, caution, error, indented, note};
use crate::executor::Pool;

/// Records read from files.
pub(super) struct ReadRecords {
    /// The records with their columns.
    pub(super) records: Vec<LaidOutRecord>,
    /// Named files that could not be read, or not completely.
    pub(super) unread: Vec<PathBuf>,
    /// Notes about choices made while reading.
    pub(super) reading: Vec<String>,
    /// Duplicates of records: the name of the other record, and the caution.
    pub(super) copies: Vec<(String, CautionNote)>,
    /// Records split into parts, with their spans.
    pub(super) wholes: Vec<WholeRecord>,
}

/// A record of which a part was requested.
pub(super) struct WholeRecord {
    name: String,
    source: RecordSource,
    /// First and last time \[s\] on its own clock.
    span_s: [f64; 2],
}

impl WholeRecord {
    /// "prbs runs from 42.30 s to 81.30 s".
    fn words(&self) -> String {
        let [first, last] = self.span_s.map(|time_s| telling(time_s, 2));
        format!("{} runs from {first} s to {last} s", self.name)
    }
}

/// Reads and lays out the records; reports choices and faults on standard error.
pub(super) fn laid_out(
    arguments: &IdentifyArguments,
    channels: &mut RecordChannels,
    dataset: Option<&Dataset>,
) -> Result<ReadRecords, Failure> {
    let wish = TimeWish {
        column: arguments.time.clone(),
        sample_time_s: arguments.sample_rate.map(|rate| 1.0 / rate),
    };
    let (mut records, mut told): (Vec<LaidOutRecord>, Vec<String>) = (Vec::new(), Vec::new());
    let FoundRecords { tables, unread, .. } = found_records(&arguments.records)?;
    let (mut reading, mut wrong): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    let units_are_known = channels
        .inputs
        .iter()
        .chain(&channels.outputs)
        .all(|rule| !rule.unit.is_empty());
    let tables = with_topics_joined(tables, channels, &wish);
    let mut wholes = Vec::new();
    let tables = if arguments.part.is_empty() {
        tables
    } else {
        let lay_out =
            |table: &RecordTable| as_dataset_says(table.clone(), channels, dataset, &wish).0;
        parts(tables, &arguments.part, lay_out, &mut wholes)?
    };
    for table in tables {
        let (record, notes) = as_dataset_says(table, channels, dataset, &wish);
        // A part applies only to records with samples at that time.
        if record.table.part_s.is_some()
            && record
                .flight
                .as_ref()
                .is_some_and(|flight| flight.time_s.len() < 2)
        {
            note(&format!("{}: no samples then", record.table.name));
            continue;
        }
        let name = &record.table.name;
        // The kind of a log and the sign convention of its system are stated in no other file.
        let is_log = record
            .table
            .columns
            .iter()
            .any(|column| column.topic.is_some() || column.meaning.is_some());
        let of_log = record.table.notes.iter().filter(|_| is_log).cloned();
        let notes: Vec<String> = of_log.chain(notes).collect();
        // Records of one flight are alike: equal choices are reported once.
        if notes != told {
            let words = notes.iter().map(|words| format!("{name}: {words}"));
            reading.extend(words.inspect(|words| note(words)));
            told = notes;
        }
        record
            .cautions
            .iter()
            .for_each(|words| caution(&format!("{name}: {words}")));
        // Problems common to all records are reported for the first.
        let problems: Vec<String> = record.problems.iter().map(ToString::to_string).collect();
        if problems != wrong {
            problems
                .iter()
                .for_each(|words| error(&format!("{name}: {words}")));
            wrong = problems;
        }
        channels.take_units(&record.layout, &record.table);
        records.push(record);
    }
    let has_samples = |part: &&RecordPart| {
        records
            .iter()
            .any(|record| is_part(&record.table, part, &wholes))
    };
    if let Some(part) = arguments.part.iter().find(|part| !has_samples(part)) {
        return Err(Failure::option("--part", no_samples(part, &wholes)));
    }
    // Records are laid out again with the final units: a record read before the first one that
    // states them may state none.
    let by_units = |record: LaidOutRecord| {
        if units_are_known || !record.problems.is_empty() {
            return record;
        }
        let (record, _) =
            as_dataset_says(Arc::unwrap_or_clone(record.table), channels, dataset, &wish);
        record
            .problems
            .iter()
            .for_each(|words| error(&format!("{}: {words}", record.table.name)));
        record
    };
    let mut records: Vec<LaidOutRecord> = records.into_iter().map(by_units).collect();
    leave_out_copies(&mut records);
    let mut copies = Vec::new();
    for copy in records.iter().filter(|record| !record.used) {
        for (first, text) in tell_copies(copy) {
            let records = vec![copy.table.name.clone()];
            copies.push((
                first.clone(),
                CautionNote {
                    code: "duplicate",
                    records,
                    text,
                    ..CautionNote::default()
                },
            ));
        }
    }
    records.retain(|record| record.used);
    let wrong = records
        .iter()
        .filter(|record| !record.problems.is_empty())
        .count();
    if wrong > 0 {
        Err(Failure::Records {
            wrong,
            of: records.len(),
        })
    } else {
        Ok(ReadRecords {
            records,
            unread,
            reading,
            copies,
            wholes,
        })
    }
}

/// Lays out a record, following the dataset's entry for it if there is one. It is always used,
/// because it was requested.
fn as_dataset_says(
    table: RecordTable,
    channels: &RecordChannels,
    dataset: Option<&Dataset>,
    wish: &TimeWish,
) -> (LaidOutRecord, Vec<String>) {
    match dataset {
        Some(dataset) => {
            let (record, notes) = LaidOutRecord::as_dataset_says(table, channels, dataset, wish);
            (
                LaidOutRecord {
                    used: true,
                    ..record
                },
                notes,
            )
        }
        None => LaidOutRecord::proposed(table, channels, wish),
    }
}

/// Returns the requested parts instead of the whole records, which are added to `wholes`. A record
/// with unclear columns replaces its parts, so that its problems are reported.
fn parts(
    tables: Vec<RecordTable>,
    asked: &[RecordPart],
    lay_out: impl Fn(&RecordTable) -> LaidOutRecord,
    wholes: &mut Vec<WholeRecord>,
) -> Result<Vec<RecordTable>, Failure> {
    let mut found: Vec<RecordTable> = Vec::new();
    for part in asked {
        let mut is_called_so = false;
        for table in &tables {
            if !part
                .record
                .as_ref()
                .is_none_or(|wanted| is_called(table, wanted))
            {
                continue;
            }
            is_called_so = true;
            let known = wholes
                .iter()
                .find(|whole| whole.source == table.source)
                .map(|whole| whole.span_s);
            match known.or_else(|| lay_out(table).span_s()) {
                Some(span_s) => {
                    if known.is_none() {
                        let name = table.name.clone();
                        let source = table.source.clone();
                        wholes.push(WholeRecord {
                            name,
                            source,
                            span_s,
                        });
                    }
                    found.push(table.part_of_time(part.on_clock_s(span_s[0])));
                }
                None if found.iter().any(|other| other.source == table.source) => {}
                None => found.push(table.clone()),
            }
        }
        if !is_called_so {
            let record = part.record.as_deref().unwrap_or_default();
            return Err(Failure::option(
                "--part",
                format!("\"{record}\" is none of the records"),
            ));
        }
    }
    Ok(found)
}

/// Returns whether a record is a requested part of a record with the requested name; a record with
/// unclear columns counts as every part.
fn is_part(table: &RecordTable, part: &RecordPart, wholes: &[WholeRecord]) -> bool {
    if !part
        .record
        .as_ref()
        .is_none_or(|record| is_called(table, record) || is_called_before_part(table, record))
    {
        return false;
    }
    match wholes.iter().find(|whole| whole.source == table.source) {
        Some(whole) => table.part_s == Some(part.on_clock_s(whole.span_s[0])),
        None => true,
    }
}

/// Returns whether a part belongs to the named record: a part's name is the record's name followed
/// by the times.
fn is_called_before_part(table: &RecordTable, wanted: &str) -> bool {
    table.part_s.is_some()
        && table
            .name
            .strip_prefix(wanted)
            .is_some_and(|rest| rest.starts_with(", "))
}

/// Returns why a requested part has no samples: the spans of the records.
fn no_samples(part: &RecordPart, wholes: &[WholeRecord]) -> String {
    /// Maximum number of records whose spans are listed.
    const MOST: usize = 4;
    let is_asked = |whole: &&WholeRecord| {
        let table = RecordTable {
            source: whole.source.clone(),
            ..RecordTable::new(whole.name.clone(), Vec::new())
        };
        part.record
            .as_ref()
            .is_none_or(|record| is_called(&table, record))
    };
    let spans: Vec<String> = wholes
        .iter()
        .filter(is_asked)
        .map(WholeRecord::words)
        .collect();
    let more = spans.len().saturating_sub(MOST);
    let more = if more == 0 {
        String::new()
    } else {
        format!("; {more} more")
    };
    let shown = spans[..spans.len().min(MOST)].join("; ");
    let asked = part.words();
    if part.is_from_start {
        return format!("no record has samples at {asked} s from its start: {shown}{more}");
    }
    let [from, to] = part.part_s;
    let mut words = format!("no record has samples at {asked} s on its own clock: {shown}{more}");
    if from >= 0.0 {
        words += &format!(
            " (--part +{}:+{} counts from the start of a record)",
            number(from),
            number(to)
        );
    }
    words
}

/// Returns whether a record has this name: its file, its name, or its name within its file.
pub(super) fn is_called(table: &RecordTable, wanted: &str) -> bool {
    let source = &table.source;
    let file = Path::new(wanted)
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    source.file.rsplit('/').next() == Some(&file)
        || table.name == *wanted
        || source.variable.as_deref() == Some(wanted)
}

/// Reads the records from files and folders; reports skipped content on standard error.
pub(super) fn found_records(paths: &[PathBuf]) -> Result<FoundRecords, Failure> {
    let found = read_records(paths, &ReadingProgress::new())?;
    found
        .faults
        .iter()
        .for_each(|fault| caution(&format!("not taken: {fault}")));
    found
        .ignored
        .iter()
        .for_each(|words| note(&format!("no record: {words}")));
    if found.tables.is_empty() {
        Err(Failure::nothing_in(paths, "record"))
    } else {
        Ok(found)
    }
}

/// Holds out the requested records, or parts of `wholes`; without a request, records whose names
/// say so stay held out.
pub(super) fn hold_out(
    wanted: &[String],
    records: &mut [LaidOutRecord],
    wholes: &[WholeRecord],
) -> Result<(), Failure> {
    if !wanted.is_empty() {
        records
            .iter_mut()
            .for_each(|record| record.guess.held_out = false);
    }
    for wanted in wanted {
        let part = record_part(wanted).ok();
        let mut is_found = false;
        for record in records.iter_mut() {
            let table = &record.table;
            let is_of_part =
                |part: &RecordPart| table.part_s.is_some() && is_part(table, part, wholes);
            if is_called(table, wanted) || part.as_ref().is_some_and(is_of_part) {
                record.guess.held_out = true;
                is_found = true;
            }
        }
        if !is_found {
            let reason =
                format!("\"{wanted}\" is none of the records; give its file among them too");
            return Err(Failure::option("--hold-out", reason));
        }
    }
    Ok(())
}

/// Returns a table with one line for each record, indented by `indent` spaces.
pub(super) fn record_table(records: &[LaidOutRecord], indent: usize) -> String {
    let mut table = Table::new("", ["record", "kind", "samples", "step", "length", ""]);
    for LaidOutRecord {
        table: record,
        layout,
        guess,
        flight,
        ..
    } in records
    {
        // Describes the record as used: with topics resampled to one clock and parts cut.
        let clock = flight
            .as_ref()
            .map(|flight| (flight.time_s.len(), median_step(&flight.time_s)));
        let (samples, step_s) = clock.unwrap_or((
            record.rows(),
            layout.time.and_then(|time| time.step_s(record)),
        ));
        let step_s = step_s.unwrap_or(f64::NAN);
        table.row([
            sanitized(&record.name),
            guess.kind.word().to_owned(),
            samples.to_string(),
            format!("{} s", telling(step_s, 3)),
            format!("{:.1} s", step_s * samples as f64),
            if guess.held_out {
                "held out".to_owned()
            } else {
                String::new()
            },
        ]);
    }
    indented(&table, indent)
}

/// What models are compared with in time.
#[derive(Debug, Args)]
pub struct HistoryArguments {
    /// Flight records, each of the condition that its name says: files, or folders with all that is in them. The models answer to their
    /// sticks, and their share of time within tolerances is told; may be repeated.
    #[arg(long, value_name = "PATH")]
    pub records: Vec<PathBuf>,
    /// The unit of a channel's samples in records that do not say it; may be repeated.
    #[arg(long, value_name = "CHANNEL=UNIT", value_parser = channel_unit, requires = "records")]
    pub unit: Vec<OfChannel<String>>,
}

/// The records of each condition.
#[derive(Default)]
pub(super) struct ReadHistories {
    pub(super) conditions: Vec<HistoryRecords>,
    /// Requested records that could not be read, or not completely.
    unread: Vec<String>,
}

impl ReadHistories {
    /// Returns the outcome of a command that used these records: a failure if some were not read.
    pub(super) fn ended(&self) -> Result<(), Failure> {
        let paths = self.unread.join(", ");
        if paths.is_empty() {
            Ok(())
        } else {
            Err(Failure::Unread { paths })
        }
    }
}

impl HistoryArguments {
    /// Reads the records of each condition, with topics resampled to a clock for this band; reports
    /// omitted records on standard error.
    pub(super) fn read(&self, dataset: &Dataset, band: Band) -> Result<ReadHistories, Failure> {
        if self.records.is_empty() {
            return Ok(ReadHistories::default());
        }
        let FoundRecords { tables, unread, .. } = found_records(&self.records)?;
        let mut unread: Vec<String> = unread.iter().map(|path| sanitized_path(path)).collect();
        let mut channels = RecordChannels::of_dataset(dataset);
        channels.resampling.band_end = Some(band.max());
        say_conversions("--unit", &self.unit, SaidConversion::Unit, &mut channels)?;
        let tables = with_topics_joined(tables, &channels, &TimeWish::default());
        let records = tables
            .into_iter()
            .filter_map(|table| record_of(table, dataset, &channels, &mut unread));
        let (of, mut records): (Vec<ConditionId>, Vec<LaidOutRecord>) = records.unzip();
        leave_out_copies(&mut records);
        records.iter().for_each(|record| drop(tell_copies(record)));
        let preparation = preparation(dataset);
        let conditions = dataset.conditions().iter().map(|condition| {
            let own = of
                .iter()
                .zip(&records)
                .filter(|(of, _)| **of == condition.id())
                .map(|(_, record)| record);
            HistoryRecords::of(condition.id(), own, preparation.clone())
        });
        Ok(ReadHistories {
            conditions: conditions.filter(|of| !of.records.is_empty()).collect(),
            unread,
        })
    }
}

/// Computes the responses of the models to the records, with progress on a terminal.
pub(super) fn time_histories(
    analysis: &Analysis,
    records: &ReadHistories,
) -> Result<TimeHistories, Failure> {
    let records = records.conditions.as_slice();
    let progress = TerminalProgress::new("simulating records");
    let execution = Execution::new(&Pool, &progress, HistoryRecords::steps(records));
    Ok(time_histories_of(
        analysis,
        records,
        &analysis.study.requirements.tolerances,
        &execution,
    )?)
}

/// Returns a record and its condition, following the dataset's entry if there is one; `None` if no
/// condition is known or its columns are unclear. A record with unknown units is added to `unread`.
fn record_of(
    table: RecordTable,
    dataset: &Dataset,
    channels: &RecordChannels,
    unread: &mut Vec<String>,
) -> Option<(ConditionId, LaidOutRecord)> {
    let entry = table.entry_of_dataset(dataset);
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
        caution(&format!(
            "{name}: left out: its name says no condition of the dataset"
        ));
        return None;
    };
    record
        .cautions
        .iter()
        .for_each(|words| caution(&format!("{name}: {words}")));
    record
        .problems
        .iter()
        .for_each(|words| caution(&format!("{name}: left out: {words}")));
    let is_unsaid = record
        .problems
        .iter()
        .any(|problem| matches!(problem, LayoutProblem::UnsaidUnit { .. }));
    unread.extend(is_unsaid.then(|| sanitized(&name)));
    if !record.used {
        note(&format!("{name}: left out: the dataset says so"));
    }
    record.used_flight()?;
    Some((condition, record))
}

/// Reports duplicates of other records; returns each other record's name with the message.
fn tell_copies(record: &LaidOutRecord) -> Vec<(&String, String)> {
    let copies = record.cautions.iter().filter_map(|why| match why {
        LayoutCaution::Copy { first } => Some((first, format!("{}: {why}", record.table.name))),
        _ => None,
    });
    copies.inspect(|(_, words)| caution(words)).collect()
}

/// Returns the preparation that leaves every channel unchanged.
fn preparation(dataset: &Dataset) -> Preparation {
    let (inputs, outputs) = dataset.names_of_channels();
    let [inputs, outputs]: [Vec<&str>; 2] =
        [&inputs, &outputs].map(|of| of.iter().map(String::as_str).collect());
    Preparation::of(&inputs, &outputs)
}
