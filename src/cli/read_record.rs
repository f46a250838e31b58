//! The records that models are identified from, as they were read.

use gdcm_core::message_text::sanitized;
use std::path::{Path, PathBuf};

use gdcm_core::assembly::standard_patterns;
use gdcm_core::dataset::ConditionRecord;
use gdcm_core::records::{LayoutProposal, RecordChannels, RecordGuess, RecordLayout, RecordTable, TimeWish};
use gdcm_core::study::Table;
use gdcm_core::units::telling;
use gdcm_files::{FoundRecords, read_records, relative_folder};

use super::failure::Failure;
use super::identify_arguments::IdentifyArguments;
use super::models::ReadingProgress;
use super::terminal::say_error;
use super::text_table::indented;

/// A record as it was read.
pub(super) struct ReadRecord {
    pub(super) table: RecordTable,
    pub(super) layout: RecordLayout,
    pub(super) guess: RecordGuess,
}

/// Every record with its columns; what was chosen, and what is wrong, is told on standard error.
pub(super) fn laid_out(
    arguments: &IdentifyArguments,
    channels: &mut RecordChannels,
) -> Result<Vec<ReadRecord>, Failure> {
    let tables = tables(arguments)?;
    let wish = TimeWish { column: arguments.time.clone(), sample_time_s: arguments.sample_rate.map(|rate| 1.0 / rate) };
    let patterns = standard_patterns();
    let (mut records, mut wrong, mut told): (Vec<ReadRecord>, usize, Vec<String>) = (Vec::new(), 0, Vec::new());
    for table in tables {
        let LayoutProposal { layout, notes, problems, cautions } = RecordLayout::proposed(&table, channels, &wish);
        let name = sanitized(&table.name);
        // Records of one flight are alike: what is chosen is said once.
        if notes != told {
            notes.iter().for_each(|note| say_error(&format!("{name}: {}", sanitized(note))));
            told = notes;
        }
        cautions.iter().for_each(|caution| say_error(&format!("{name}: caution: {}", sanitized(&caution.to_string()))));
        problems.iter().for_each(|problem| say_error(&format!("{name}: {}", sanitized(&problem.to_string()))));
        wrong += usize::from(!problems.is_empty());
        channels.take_units(&layout, &table);
        let guess = RecordGuess::of_table(&table, &patterns);
        records.push(ReadRecord { table, layout, guess });
    }
    if wrong > 0 { Err(Failure::Records { wrong, of: records.len() }) } else { Ok(records) }
}

fn tables(arguments: &IdentifyArguments) -> Result<Vec<RecordTable>, Failure> {
    let FoundRecords { tables, faults, passed_over, .. } = read_records(&arguments.records, &ReadingProgress::new())?;
    faults.iter().for_each(|fault| say_error(&format!("not taken: {}", sanitized(fault))));
    passed_over.iter().for_each(|words| say_error(&format!("no record: {}", sanitized(words))));
    if tables.is_empty() {
        return Err(Failure::Option { option: "RECORD", reason: "holds no record that could be taken".to_owned() });
    }
    Ok(tables)
}

/// Holds out the records asked for; without a word those whose names say so stay held out.
pub(super) fn hold_out(wanted: &[String], records: &mut [ReadRecord]) -> Result<(), Failure> {
    if !wanted.is_empty() {
        records.iter_mut().for_each(|record| record.guess.held_out = false);
    }
    for wanted in wanted {
        let file = Path::new(wanted).file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let is_it = |record: &&mut ReadRecord| {
            let source = &record.table.source;
            let own = source.file.rsplit('/').next() == Some(&file);
            own || record.table.name == *wanted || source.variable.as_deref() == Some(wanted)
        };
        let found: Vec<&mut ReadRecord> = records.iter_mut().filter(is_it).collect();
        if found.is_empty() {
            let reason = format!("\"{wanted}\" is none of the records; give its file among them too");
            return Err(Failure::Option { option: "--hold-out", reason });
        }
        found.into_iter().for_each(|record| record.guess.held_out = true);
    }
    Ok(())
}

impl ReadRecord {
    /// What the dataset says of it, its file relative to the dataset's; `asked` are the files and folders that were read.
    pub(super) fn entry(&self, asked: &[PathBuf], dataset: &Path) -> ConditionRecord {
        let mut entry = self.layout.condition_record(&self.table, &self.guess);
        // A file by itself, or below the folder that was asked for.
        let place = asked.iter().find_map(|path| {
            let own = path.file_name().is_some_and(|name| name.to_string_lossy() == self.table.source.file.as_str());
            let below = path.join(&self.table.source.file);
            if own { Some(path.clone()) } else { Some(below).filter(|_| path.is_dir()) }
        });
        if let Some(place) = place {
            let folder = relative_folder(place.parent().unwrap_or(Path::new(".")), dataset);
            let name = place.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            entry.file = if folder.is_empty() || folder == "." { name } else { format!("{folder}/{name}") };
        }
        entry
    }
}

/// A line a record, each behind `indent` spaces.
pub(super) fn record_table(records: &[ReadRecord], indent: usize) -> String {
    let mut table = Table::new("", ["record", "kind", "samples", "step", "length", ""]);
    for ReadRecord { table: record, layout, guess } in records {
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
