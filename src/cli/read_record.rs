//! The records that models are identified from, as they were read.

use gdcm_core::message_text::sanitized;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_core::dataset::{ChannelRemedy, ConditionRecord, Dataset};
use gdcm_core::identification::CautionNote;
use gdcm_core::records::{
    LaidOutRecord, LayoutCaution, RecordChannels, RecordTable, TimeWish, leave_out_copies, median_step,
    with_topics_joined,
};
use gdcm_core::study::Table;
use gdcm_core::units::telling;
use gdcm_files::{FoundRecords, read_records};

use super::{
    Failure, IdentifyArguments, ReadingProgress, RecordPart, caution, entry_of_dataset, error, indented, note,
};

/// The records that were read.
pub(super) struct ReadRecords {
    /// Every record with its columns.
    pub(super) records: Vec<LaidOutRecord>,
    /// The files named that could not be read, or not all that is in them.
    pub(super) unread: Vec<PathBuf>,
    /// What was chosen and done while they were read.
    pub(super) reading: Vec<String>,
    /// Records that are others under second names: the name of the other, and what is said.
    pub(super) copies: Vec<(String, CautionNote)>,
}

/// Reads the records; what was chosen, and what is wrong, is told on standard error.
pub(super) fn laid_out(
    arguments: &IdentifyArguments,
    channels: &mut RecordChannels,
    dataset: Option<&Dataset>,
) -> Result<ReadRecords, Failure> {
    let wish = TimeWish { column: arguments.time.clone(), sample_time_s: arguments.sample_rate.map(|rate| 1.0 / rate) };
    let (mut records, mut told): (Vec<LaidOutRecord>, Vec<String>) = (Vec::new(), Vec::new());
    let FoundRecords { tables, unread, .. } = found_records(&arguments.records)?;
    let (mut reading, mut wrong): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    let units_are_known = channels.inputs.iter().chain(&channels.outputs).all(|rule| !rule.unit.is_empty());
    let tables = with_topics_joined(tables, channels, &wish);
    for table in parts(tables, &arguments.part)? {
        let (record, notes) = as_dataset_says(table, channels, dataset, &wish);
        // A part is of those records that have samples then.
        if record.table.part_s.is_some() && record.flight.as_ref().is_some_and(|flight| flight.time_s.len() < 2) {
            note(&format!("{}: no samples then", record.table.name));
            continue;
        }
        let name = &record.table.name;
        // What a log is, and the signs of its system, no other file tells.
        let is_log = record.table.columns.iter().any(|column| column.topic.is_some() || column.meaning.is_some());
        let of_log = record.table.notes.iter().filter(|_| is_log).cloned();
        let notes: Vec<String> = of_log.chain(notes).collect();
        // Records of one flight are alike: what is chosen is said once.
        if notes != told {
            let words = notes.iter().map(|words| format!("{name}: {words}"));
            reading.extend(words.inspect(|words| note(words)));
            told = notes;
        }
        record.cautions.iter().for_each(|words| caution(&format!("{name}: {words}")));
        // What is wrong with all of them is told of the first.
        let problems: Vec<String> = record.problems.iter().map(ToString::to_string).collect();
        if problems != wrong {
            problems.iter().for_each(|words| error(&format!("{name}: {words}")));
            wrong = problems;
        }
        channels.take_units(&record.layout, &record.table);
        records.push(record);
    }
    let has = |part_s| records.iter().any(|record| record.table.part_s == Some(part_s));
    if let Some(part) = arguments.part.iter().find(|part| !has(part.part_s)) {
        let [from, to] = part.part_s;
        let reason = format!("no record has samples from {from} to {to} s on its own clock");
        return Err(Failure::Option { option: "--part", reason });
    }
    // By the units that the channels have by now: a record before the first that says them may say none.
    let by_units = |record: LaidOutRecord| {
        if units_are_known || !record.problems.is_empty() {
            return record;
        }
        let (record, _) = as_dataset_says(Arc::unwrap_or_clone(record.table), channels, dataset, &wish);
        record.problems.iter().for_each(|words| error(&format!("{}: {words}", record.table.name)));
        record
    };
    let mut records: Vec<LaidOutRecord> = records.into_iter().map(by_units).collect();
    leave_out_copies(&mut records);
    let mut copies = Vec::new();
    for copy in records.iter().filter(|record| !record.used) {
        for why in &copy.cautions {
            let LayoutCaution::Copy { first } = why else { continue };
            let (record, text) = (copy.table.name.clone(), format!("{}: {why}", copy.table.name));
            caution(&text);
            let note = CautionNote { code: "duplicate", records: vec![record], text, ..CautionNote::default() };
            copies.push((first.clone(), note));
        }
    }
    records.retain(|record| record.used);
    let wrong = records.iter().filter(|record| !record.problems.is_empty()).count();
    if wrong > 0 {
        Err(Failure::Records { wrong, of: records.len() })
    } else {
        Ok(ReadRecords { records, unread, reading, copies })
    }
}

/// A record with its channels. One that the dataset itself names is as that says: in its units where the file says none, times the
/// factors and less the delays that it keeps, but for what the command line says of the samples of a channel.
fn as_dataset_says(
    table: RecordTable,
    channels: &RecordChannels,
    dataset: Option<&Dataset>,
    wish: &TimeWish,
) -> (LaidOutRecord, Vec<String>) {
    let Some((_, entry)) = dataset.and_then(|dataset| entry_of_dataset(dataset, &table)) else {
        return LaidOutRecord::proposed(table, channels, wish);
    };
    let channels = channels.clone().of_named_records();
    let (record, mut notes) = LaidOutRecord::proposed(table, &channels, wish);
    let kept = |(name, remedy): (&String, &ChannelRemedy)| {
        let factor = if channels.said.contains_key(name) { 1.0 } else { remedy.factor };
        (name.clone(), ChannelRemedy { factor, ..*remedy })
    };
    let remedies = entry.remedies.iter().map(kept).filter(|(_, remedy)| *remedy != ChannelRemedy::NONE).collect();
    let words = |(name, remedy): (&String, &ChannelRemedy)| {
        format!("{name}: times {}, {} s taken out, as the dataset says of this record", remedy.factor, remedy.delay_s)
    };
    let entry = ConditionRecord { remedies, used: true, ..entry.clone() };
    notes.extend(entry.remedies.iter().map(words));
    (record.as_said(&entry, &channels), notes)
}

/// The parts asked for, in place of the records that they are of.
fn parts(tables: Vec<RecordTable>, asked: &[RecordPart]) -> Result<Vec<RecordTable>, Failure> {
    let mut found = Vec::new();
    for RecordPart { record, part_s } in asked {
        let before = found.len();
        let is_it = |table: &&RecordTable| record.as_ref().is_none_or(|wanted| is_called(table, wanted));
        found.extend(tables.iter().filter(is_it).map(|table| table.part_of_time(*part_s)));
        if found.len() == before {
            let reason = format!("\"{}\" is none of the records", record.as_deref().unwrap_or_default());
            return Err(Failure::Option { option: "--part", reason });
        }
    }
    Ok(if asked.is_empty() { tables } else { found })
}

/// Whether a record is called so: by its file, its name, or its name in its file.
pub(super) fn is_called(table: &RecordTable, wanted: &str) -> bool {
    let source = &table.source;
    let file = Path::new(wanted).file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    source.file.rsplit('/').next() == Some(&file) || table.name == *wanted || source.variable.as_deref() == Some(wanted)
}

/// The records of files and folders; what could not be taken is told on standard error.
pub(super) fn found_records(paths: &[PathBuf]) -> Result<FoundRecords, Failure> {
    let found = read_records(paths, &ReadingProgress::new())?;
    found.faults.iter().for_each(|fault| caution(&format!("not taken: {fault}")));
    found.ignored.iter().for_each(|words| note(&format!("no record: {words}")));
    if found.tables.is_empty() { Err(Failure::nothing_in(paths, "record")) } else { Ok(found) }
}

/// Holds out the records asked for; without a word those whose names say so stay held out.
pub(super) fn hold_out(wanted: &[String], records: &mut [LaidOutRecord]) -> Result<(), Failure> {
    if !wanted.is_empty() {
        records.iter_mut().for_each(|record| record.guess.held_out = false);
    }
    for wanted in wanted {
        let part = wanted.parse::<RecordPart>().ok();
        let is_part = |table: &RecordTable| {
            part.as_ref().is_some_and(|RecordPart { record, part_s }| {
                table.part_s == Some(*part_s) && record.as_ref().is_none_or(|record| is_called(table, record))
            })
        };
        let is_it = |record: &&mut LaidOutRecord| is_called(&record.table, wanted) || is_part(&record.table);
        let found: Vec<&mut LaidOutRecord> = records.iter_mut().filter(is_it).collect();
        if found.is_empty() {
            let reason = format!("\"{wanted}\" is none of the records; give its file among them too");
            return Err(Failure::Option { option: "--hold-out", reason });
        }
        found.into_iter().for_each(|record| record.guess.held_out = true);
    }
    Ok(())
}

/// A line a record, each behind `indent` spaces.
pub(super) fn record_table(records: &[LaidOutRecord], indent: usize) -> String {
    let mut table = Table::new("", ["record", "kind", "samples", "step", "length", ""]);
    for LaidOutRecord { table: record, layout, guess, flight, .. } in records {
        // As it is used: topics are brought to one clock, parts are cut.
        let clock = flight.as_ref().map(|flight| (flight.time_s.len(), median_step(&flight.time_s)));
        let (samples, step_s) = clock.unwrap_or((record.rows(), layout.time.and_then(|time| time.step_s(record))));
        let step_s = step_s.unwrap_or(f64::NAN);
        table.row([
            sanitized(&record.name),
            guess.kind.word().to_owned(),
            samples.to_string(),
            format!("{} s", telling(step_s, 3)),
            format!("{:.1} s", step_s * samples as f64),
            if guess.held_out { "held out".to_owned() } else { String::new() },
        ]);
    }
    indented(&table, indent)
}
