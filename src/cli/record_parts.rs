//! Parts of flight records, selected by time (`--part`).

use std::path::Path;

use gdcm_model::units::{number, telling};
use gdcm_sysid::records::{LaidOutRecord, RecordSource, RecordTable};

use super::failure::Failure;
use super::option_values::RecordPart;

/// Record from which parts are cut.
pub(super) struct WholeRecord {
    name: String,
    source: RecordSource,
    /// First and last time \[s\] on the record's time axis.
    span_s: [f64; 2],
}

impl WholeRecord {
    /// Describes the record: "prbs runs from 42.30 s to 81.30 s".
    fn words(&self) -> String {
        let [first, last] = self.span_s.map(|time_s| telling(time_s, 2));
        format!("{} runs from {first} s to {last} s", self.name)
    }

    /// Returns whether a part may belong to this record, judging by the record name given with the
    /// part.
    fn matches(&self, part: &RecordPart) -> bool {
        let Some(record) = &part.record else {
            return true;
        };
        let table = RecordTable {
            source: self.source.clone(),
            ..RecordTable::new(self.name.clone(), Vec::new())
        };
        is_called(&table, record)
    }
}

/// Parts cut from records, and the records with unclear columns, which are kept whole.
pub(super) struct CutRecords {
    pub(super) tables: Vec<RecordTable>,
    /// Records from which parts were cut.
    pub(super) wholes: Vec<WholeRecord>,
}

/// Cuts the requested parts from the records. A record with unclear columns is kept whole, so that
/// its problems are reported.
pub(super) fn cut_parts(
    tables: &[RecordTable],
    parts: &[RecordPart],
    lay_out: impl Fn(&RecordTable) -> LaidOutRecord,
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
            cut.add(table, part, &lay_out);
        }
        if !is_found {
            let record = part.record.as_deref().unwrap_or_default();
            return Err(Failure::unknown_record("--part", record));
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
        lay_out: impl Fn(&RecordTable) -> LaidOutRecord,
    ) {
        let known = self
            .wholes
            .iter()
            .find(|whole| whole.source == table.source);
        if let Some(whole) = known {
            let part_s = part.on_clock_s(whole.span_s[0]);
            self.tables.push(table.part_of_time(part_s));
        } else if let Some(span_s) = lay_out(table).span_s() {
            self.wholes.push(WholeRecord {
                name: table.name.clone(),
                source: table.source.clone(),
                span_s,
            });
            let part_s = part.on_clock_s(span_s[0]);
            self.tables.push(table.part_of_time(part_s));
        } else if !self.tables.iter().any(|other| other.source == table.source) {
            self.tables.push(table.clone());
        }
    }
}

/// Returns whether a record is the requested part; a record with unclear columns matches every
/// part.
pub(super) fn is_part(table: &RecordTable, part: &RecordPart, wholes: &[WholeRecord]) -> bool {
    if let Some(record) = &part.record
        && !is_called(table, record)
        && !is_called_before_part(table, record)
    {
        return false;
    }
    match wholes.iter().find(|whole| whole.source == table.source) {
        Some(whole) => table.part_s == Some(part.on_clock_s(whole.span_s[0])),
        None => true,
    }
}

/// Returns whether `wanted` identifies a record, by its file, its name, or its name within the
/// file.
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

/// Returns whether a record is a part of the record `wanted`: the name of a part is the name of the
/// whole record, a comma and the times.
fn is_called_before_part(table: &RecordTable, wanted: &str) -> bool {
    let rest = table.name.strip_prefix(wanted);
    table.part_s.is_some() && rest.is_some_and(|rest| rest.starts_with(", "))
}

/// Returns the failure for a part without samples; it lists the time spans of the records.
pub(super) fn part_without_samples(part: &RecordPart, wholes: &[WholeRecord]) -> Failure {
    /// Maximum number of listed time spans.
    const MOST: usize = 4;
    let spans: Vec<String> = wholes
        .iter()
        .filter(|whole| whole.matches(part))
        .map(WholeRecord::words)
        .collect();
    let shown = &spans[..spans.len().min(MOST)];
    let mut listed = shown.join("; ");
    let more = spans.len() - shown.len();
    if more > 0 {
        listed += &format!("; {more} more");
    }
    let times = part.words();
    let mut reason = if part.is_from_start {
        format!("no record has samples in the part {times} (seconds from its start): {listed}")
    } else {
        format!("no record has samples in the part {times} (seconds on its time axis): {listed}")
    };
    let [from, to] = part.part_s;
    if !part.is_from_start && from >= 0.0 {
        reason += &format!(
            " (--part +{}:+{} counts from the start of a record)",
            number(from),
            number(to)
        );
    }
    Failure::coded_option("--part", "no-samples", reason)
}
