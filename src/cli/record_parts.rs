//! Parts of flight records, selected by time (`--part`).
//!
//! A record and the parts cut from it have the same source (file and variable within the file),
//! which differs between records. Cutting keeps each record's time span ([`WholeRecord`]), because
//! times may count from its first sample.
//!
//! On the command line, a record is given by its file, its name, or its name within the file
//! ([`is_called`]). A part is called like its record, with the times behind: "sweep, 5 to 34 s".

use std::path::Path;

use gdcm_model::units::{number, telling};
use gdcm_sysid::records::{RecordSource, RecordTable};

use super::failure::Failure;
use super::option_values::RecordPart;

/// Parts cut from records, and the records that could not be cut.
pub(super) struct CutRecords {
    /// The parts, and the records that could not be cut.
    pub(super) tables: Vec<RecordTable>,
    /// Records from which parts were cut.
    pub(super) wholes: Vec<WholeRecord>,
}

/// Cuts the requested parts from the records. `span_s` returns a record's first and last time
/// \[s\], `None` if its columns are unclear; such a record is kept whole, so that its problems are
/// reported.
///
/// # Errors
/// A part names an unknown record.
pub(super) fn cut_parts(
    tables: &[RecordTable],
    parts: &[RecordPart],
    span_s: impl Fn(&RecordTable) -> Option<[f64; 2]>,
) -> Result<CutRecords, Failure> {
    let mut cut = CutRecords {
        tables: Vec::new(),
        wholes: Vec::new(),
    };
    for part in parts {
        let mut is_found = false;
        for table in tables {
            if let Some(record) = &part.record
                && !is_called(table, record)
            {
                continue;
            }
            is_found = true;
            cut.add(table, part, &span_s);
        }
        if !is_found {
            let record = part.record.as_deref().unwrap_or_default();
            let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
            return Err(Failure::unknown_record("--part", record, &names));
        }
    }
    Ok(cut)
}

impl CutRecords {
    /// Adds a part of a record. If the record's columns are unclear, adds the whole record, but
    /// only once.
    fn add(
        &mut self,
        table: &RecordTable,
        part: &RecordPart,
        span_s: impl Fn(&RecordTable) -> Option<[f64; 2]>,
    ) {
        if !self.wholes.iter().any(|whole| whole.is_source_of(table))
            && let Some(span_s) = span_s(table)
        {
            self.wholes.push(WholeRecord {
                name: table.name.clone(),
                source: table.source.clone(),
                span_s,
            });
        }
        let whole = self.wholes.iter().find(|whole| whole.is_source_of(table));
        if let Some(whole) = whole {
            self.tables.push(table.part_of_time(whole.times_s(part)));
        } else if !self.tables.iter().any(|other| other.source == table.source) {
            self.tables.push(table.clone());
        }
    }
}

/// Record from which parts were cut.
pub(super) struct WholeRecord {
    name: String,
    source: RecordSource,
    /// First and last time \[s\] on the record's time axis.
    span_s: [f64; 2],
}

impl WholeRecord {
    /// Returns whether a table is this record or a part cut from it.
    fn is_source_of(&self, table: &RecordTable) -> bool {
        self.source == table.source
    }

    /// Returns a part's first and last time \[s\] on this record's time axis.
    fn times_s(&self, part: &RecordPart) -> [f64; 2] {
        part.on_clock_s(self.span_s[0])
    }

    /// Describes the time span: "prbs runs from 42.30 s to 81.30 s".
    fn words(&self) -> String {
        let [first, last] = self.span_s.map(|time_s| telling(time_s, 2));
        format!("{} runs from {first} s to {last} s", self.name)
    }
}

/// Returns whether a table is the requested part; a record with unclear columns, which was not cut,
/// counts as every part requested from it.
pub(super) fn is_requested_part(
    table: &RecordTable,
    part: &RecordPart,
    wholes: &[WholeRecord],
) -> bool {
    if let Some(record) = &part.record
        && !is_called(table, record)
        && !is_cut_from(table, record)
    {
        return false;
    }
    match wholes.iter().find(|whole| whole.is_source_of(table)) {
        Some(whole) => table.part_s == Some(whole.times_s(part)),
        None => true,
    }
}

/// Returns whether a name given on the command line means this table.
pub(super) fn is_called(table: &RecordTable, given_name: &str) -> bool {
    means(given_name, &table.name, &table.source)
}

/// Returns whether a name given on the command line means the record with this name and source.
fn means(given_name: &str, name: &str, source: &RecordSource) -> bool {
    let file = Path::new(given_name)
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    source.file.rsplit('/').next() == Some(&file)
        || name == given_name
        || source.variable.as_deref() == Some(given_name)
}

/// Returns whether a table was cut from the record with this name: a part's name is the whole
/// record's name, a comma and the times.
fn is_cut_from(table: &RecordTable, record_name: &str) -> bool {
    let times = table.name.strip_prefix(record_name);
    table.part_s.is_some() && times.is_some_and(|times| times.starts_with(", "))
}

/// Returns the failure for a part without samples; it lists the records' time spans.
pub(super) fn part_without_samples(part: &RecordPart, wholes: &[WholeRecord]) -> Failure {
    let times = part.words();
    let spans = listed_spans(part, wholes);
    let reason = if part.is_from_start {
        format!(
            "no record has samples in the part {times} (seconds from the start of the record): {spans}"
        )
    } else {
        format!(
            "no record has samples in the part {times} (seconds on the time axis of the record): {spans}{}",
            from_start_hint(part)
        )
    };
    Failure::coded_option("--part", "no-samples", reason)
}

/// Lists the time spans of the records to which a part may belong.
fn listed_spans(part: &RecordPart, wholes: &[WholeRecord]) -> String {
    /// Maximum number of listed time spans.
    const LISTED: usize = 4;
    let mut spans: Vec<String> = Vec::new();
    for whole in wholes {
        let is_wanted = match &part.record {
            Some(record) => means(record, &whole.name, &whole.source),
            None => true,
        };
        if is_wanted {
            spans.push(whole.words());
        }
    }
    let more = spans.len().saturating_sub(LISTED);
    spans.truncate(LISTED);
    let mut listed = spans.join("; ");
    if more > 0 {
        listed += &format!("; {more} more");
    }
    listed
}

/// Returns the hint that the same times may be given from a record's start; empty for negative
/// times, which lie before the start.
fn from_start_hint(part: &RecordPart) -> String {
    let [from, to] = part.part_s;
    if from < 0.0 {
        return String::new();
    }
    format!(
        " (--part +{}:+{} counts from the start of a record)",
        number(from),
        number(to)
    )
}
