//! The records that models are identified from, as they were read.

use gdcm_core::message_text::sanitized;
use std::path::{Path, PathBuf};

use gdcm_core::dataset::ConditionRecord;
use gdcm_core::records::{LaidOutRecord, RecordChannels, RecordTable, TimeWish, leave_out_copies};
use gdcm_core::study::Table;
use gdcm_core::units::telling;
use gdcm_files::{FoundRecords, read_records, relative_folder};

use super::{Failure, IdentifyArguments, ReadingProgress, indented, say_error};

/// Every record with its columns; what was chosen, and what is wrong, is told on standard error.
pub(super) fn laid_out(
    arguments: &IdentifyArguments,
    channels: &mut RecordChannels,
) -> Result<Vec<LaidOutRecord>, Failure> {
    let wish = TimeWish { column: arguments.time.clone(), sample_time_s: arguments.sample_rate.map(|rate| 1.0 / rate) };
    let (mut records, mut told): (Vec<LaidOutRecord>, Vec<String>) = (Vec::new(), Vec::new());
    for table in tables(arguments)? {
        let (record, notes) = LaidOutRecord::proposed(table, channels, &wish);
        let name = sanitized(&record.table.name);
        let say = |words: &str| say_error(&format!("{name}: {}", sanitized(words)));
        // Records of one flight are alike: what is chosen is said once.
        if notes != told {
            notes.iter().for_each(|note| say(note));
            told = notes;
        }
        record.cautions.iter().for_each(|caution| say(&format!("caution: {caution}")));
        record.problems.iter().for_each(|problem| say(&problem.to_string()));
        channels.take_units(&record.layout, &record.table);
        records.push(record);
    }
    // By the units that the channels have by now.
    for record in records.iter_mut().filter(|record| record.problems.is_empty()) {
        *record = LaidOutRecord::new(record.table.clone(), record.layout.clone(), record.guess.clone(), channels);
        let name = sanitized(&record.table.name);
        record.problems.iter().for_each(|of| say_error(&format!("{name}: {}", sanitized(&of.to_string()))));
    }
    leave_out_copies(&mut records);
    for copy in records.iter().filter(|record| !record.used) {
        let why = copy.cautions.last().map(ToString::to_string).unwrap_or_default();
        say_error(&format!("{}: caution: {}", sanitized(&copy.table.name), sanitized(&why)));
    }
    records.retain(|record| record.used);
    let wrong = records.iter().filter(|record| !record.problems.is_empty()).count();
    if wrong > 0 { Err(Failure::Records { wrong, of: records.len() }) } else { Ok(records) }
}

fn tables(arguments: &IdentifyArguments) -> Result<Vec<RecordTable>, Failure> {
    let FoundRecords { tables, faults, ignored, .. } = read_records(&arguments.records, &ReadingProgress::new())?;
    faults.iter().for_each(|fault| say_error(&format!("not taken: {}", sanitized(fault))));
    ignored.iter().for_each(|words| say_error(&format!("no record: {}", sanitized(words))));
    if tables.is_empty() {
        return Err(Failure::Option { option: "RECORD", reason: "holds no record that could be taken".to_owned() });
    }
    Ok(tables)
}

/// Holds out the records asked for; without a word those whose names say so stay held out.
pub(super) fn hold_out(wanted: &[String], records: &mut [LaidOutRecord]) -> Result<(), Failure> {
    if !wanted.is_empty() {
        records.iter_mut().for_each(|record| record.guess.held_out = false);
    }
    for wanted in wanted {
        let file = Path::new(wanted).file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let is_it = |record: &&mut LaidOutRecord| {
            let source = &record.table.source;
            let own = source.file.rsplit('/').next() == Some(&file);
            own || record.table.name == *wanted || source.variable.as_deref() == Some(wanted)
        };
        let found: Vec<&mut LaidOutRecord> = records.iter_mut().filter(is_it).collect();
        if found.is_empty() {
            let reason = format!("\"{wanted}\" is none of the records; give its file among them too");
            return Err(Failure::Option { option: "--hold-out", reason });
        }
        found.into_iter().for_each(|record| record.guess.held_out = true);
    }
    Ok(())
}

/// What a dataset at `dataset` says of a record, its file relative to the dataset's; `asked` are the files and folders that were read.
pub(super) fn relative_entry(mut entry: ConditionRecord, asked: &[PathBuf], dataset: &Path) -> ConditionRecord {
    // A file by itself, or below the folder that was asked for.
    let place = asked.iter().find_map(|path| {
        let own = path.file_name().is_some_and(|name| name.to_string_lossy() == entry.file.as_str());
        let below = path.join(&entry.file);
        if own { Some(path.clone()) } else { Some(below).filter(|_| path.is_dir()) }
    });
    if let Some(place) = place {
        let folder = relative_folder(place.parent().unwrap_or(Path::new(".")), dataset);
        let name = place.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        entry.file = if folder.is_empty() || folder == "." { name } else { format!("{folder}/{name}") };
    }
    entry
}

/// A line a record, each behind `indent` spaces.
pub(super) fn record_table(records: &[LaidOutRecord], indent: usize) -> String {
    let mut table = Table::new("", ["record", "kind", "samples", "step", "length", ""]);
    for LaidOutRecord { table: record, layout, guess, .. } in records {
        let step_s = layout.time.and_then(|time| time.step_s(record)).unwrap_or(f64::NAN);
        table.row([
            sanitized(&record.name),
            guess.kind.word().to_owned(),
            record.rows().to_string(),
            format!("{} s", telling(step_s, 3)),
            format!("{:.1} s", step_s * record.rows() as f64),
            if guess.held_out { "held out".to_owned() } else { String::new() },
        ]);
    }
    indented(&table, indent)
}
