//! Splits a table that holds several records: by a column that numbers them, or where its stamps
//! restart.
//!
//! ```text
//! the first that applies to a table without topics (columns with stamps of their own):
//! by column  a column named like a record number, with several runs of equal integers
//! by time    stamps restart: they decrease and stay below the earlier stamp for 10 samples, since
//!            a shorter decrease is an error in the stamps
//! none       the table is one record
//! each record has at least 20 samples, or the table is not split so
//! ```

use std::ops::Range;

use gdcm_model::names::channel_alias::folded_name;
use gdcm_model::units::number;

use super::record_table::{RecordColumn, RecordSource, RecordTable};
use super::time_base::TimeBase;

/// How several records are separated in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separation {
    /// The table is one record.
    None,
    /// By a column with record numbers.
    ByColumn(usize),
    /// By a stamp column that restarts.
    ByTime(usize),
}

/// Names, without separators, that mark columns with record numbers.
const NUMBERS: &str = "record records recordid recordno recordnumber run runid runno runnumber manoeuvre maneuver segment event \
                       testpoint experiment";

impl Separation {
    /// Minimum number of samples in each record when a table holds several.
    pub const FEWEST: usize = 20;

    /// Proposes a separation by a column with record numbers or, without one, by stamps that
    /// restart; [`Self::None`] if there are neither, and for a table with topics.
    pub fn proposed(table: &RecordTable) -> Self {
        if table.has_topics() {
            return Self::None;
        }
        if let Some(column) = table.columns.iter().position(numbers_records) {
            return Self::ByColumn(column);
        }
        match TimeBase::find(table) {
            Some(column) if restarts(&table.columns[column].values) => Self::ByTime(column),
            _ => Self::None,
        }
    }
}

/// Returns whether a column is named like a record number and consists of several runs of equal
/// integers, each with at least [`Separation::FEWEST`] samples.
fn numbers_records(column: &RecordColumn) -> bool {
    let name = folded_name(&column.name);
    if !NUMBERS.split(' ').any(|word| word == name) {
        return false;
    }
    let runs = constant_runs(&column.values);
    runs.len() > 1
        && runs
            .iter()
            .all(|run| run.len() >= Separation::FEWEST && column.values[run.start].fract() == 0.0)
}

/// Returns whether stamps restart, with at least [`Separation::FEWEST`] samples in each part.
fn restarts(stamps: &[f64]) -> bool {
    let parts = rising_parts(stamps);
    parts.len() > 1 && parts.iter().all(|part| part.len() >= Separation::FEWEST)
}

/// Table rows that form a record.
struct RecordPart {
    rows: Range<usize>,
    /// The part's name within its table.
    name: String,
}

impl RecordTable {
    /// Splits the table into records, named by their number or part. Samples without a number
    /// belong to no record.
    pub fn separated(self, separation: Separation) -> Vec<RecordTable> {
        let parts;
        let reason;
        match separation {
            Separation::None => return vec![self],
            Separation::ByColumn(column) => {
                let Some(numbers) = self.columns.get(column) else {
                    return vec![self];
                };
                parts = parts_by_number(numbers);
                reason = format!(
                    "a new record begins where column {} changes",
                    self.quoted(column)
                );
            }
            Separation::ByTime(column) => {
                let Some(stamps) = self.columns.get(column) else {
                    return vec![self];
                };
                parts = parts_by_time(&stamps.values);
                reason = "a new record begins where the time restarts".to_owned();
            }
        }
        let note = format!("one of {} records: {reason}", parts.len());
        parts
            .into_iter()
            .map(|part| self.part(part, &note))
            .collect()
    }

    fn part(&self, part: RecordPart, note: &str) -> RecordTable {
        let RecordPart { rows, name } = part;
        let variable = match &self.source.variable {
            Some(variable) => format!("{variable}, {name}"),
            None => name.clone(),
        };
        let columns = self.columns.iter().map(|column| RecordColumn {
            unit: column.unit.clone(),
            side: column.side,
            meaning: column.meaning,
            ..RecordColumn::new(column.name.clone(), column.values[rows.clone()].to_vec())
        });
        let mut notes = self.notes.clone();
        notes.push(note.to_owned());
        RecordTable {
            named: self.named,
            sample_time_s: self.sample_time_s,
            source: RecordSource {
                variable: Some(variable),
                ..self.source.clone()
            },
            notes,
            modes: self.modes.clone(),
            ..RecordTable::new(format!("{}, {name}", self.name), columns.collect())
        }
    }
}

/// Returns a part for each run of equal numbers; later runs with the same number are named "part
/// 2", "part 3".
fn parts_by_number(numbers: &RecordColumn) -> Vec<RecordPart> {
    let mut seen: Vec<f64> = Vec::new();
    let mut parts = Vec::new();
    for rows in constant_runs(&numbers.values) {
        let value = numbers.values[rows.start];
        seen.push(value);
        let times = seen.iter().filter(|other| **other == value).count();
        let mut name = format!("{} {}", numbers.name, number(value));
        if times > 1 {
            name.push_str(&format!(", part {times}"));
        }
        parts.push(RecordPart { rows, name });
    }
    parts
}

/// Returns a part from each restart to the next.
fn parts_by_time(stamps: &[f64]) -> Vec<RecordPart> {
    let mut parts = Vec::new();
    for (index, rows) in rising_parts(stamps).into_iter().enumerate() {
        let name = format!("part {}", index + 1);
        parts.push(RecordPart { rows, name });
    }
    parts
}

/// Returns sample ranges with equal numbers; samples without a number are skipped.
fn constant_runs(numbers: &[f64]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (sample, value) in numbers.iter().enumerate() {
        if !value.is_finite() {
            continue;
        }
        match runs.last_mut() {
            Some(run) if run.end == sample && numbers[run.start] == *value => run.end += 1,
            _ => runs.push(sample..sample + 1),
        }
    }
    runs
}

/// Returns the sample ranges between restarts. Stamps restart where they decrease and stay below
/// the earlier stamp for half of [`Separation::FEWEST`] samples; a shorter decrease is an error in
/// the stamps.
fn rising_parts(stamps: &[f64]) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut start = 0;
    let mut last = f64::NEG_INFINITY;
    for (sample, stamp) in stamps.iter().enumerate() {
        if !stamp.is_finite() {
            continue;
        }
        if *stamp < last && stays_below(&stamps[sample..], last) {
            parts.push(start..sample);
            start = sample;
        }
        last = *stamp;
    }
    parts.push(start..stamps.len());
    parts
}

/// Returns whether the first stamps, half of [`Separation::FEWEST`], are all below `last` or
/// missing.
fn stays_below(stamps: &[f64], last: f64) -> bool {
    stamps
        .iter()
        .take(Separation::FEWEST / 2)
        .all(|later| later.is_nan() || *later < last)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(columns: Vec<(&str, Vec<f64>)>) -> RecordTable {
        let columns = columns
            .into_iter()
            .map(|(name, values)| RecordColumn::new(name, values))
            .collect();
        RecordTable::new("log", columns)
    }

    fn counted(from: usize, to: usize) -> Vec<f64> {
        (from..to).map(|sample| sample as f64).collect()
    }

    #[test]
    fn a_column_of_record_numbers_separates_records() {
        let runs = [
            vec![1.0; 30],
            vec![f64::NAN; 5],
            vec![2.0; 25],
            vec![1.0; 40],
        ]
        .concat();
        let log = table(vec![
            ("t", counted(0, 100)),
            ("Run No.", runs),
            ("P", counted(0, 100)),
        ]);
        assert_eq!(Separation::proposed(&log), Separation::ByColumn(1));
        let records = log.separated(Separation::ByColumn(1));
        let names: Vec<&str> = records.iter().map(|record| record.name.as_str()).collect();
        assert_eq!(
            names,
            ["log, Run No. 1", "log, Run No. 2", "log, Run No. 1, part 2"]
        );
        assert_eq!(records[1].columns[2].values, counted(35, 60));
        assert_eq!(records[1].source.variable.as_deref(), Some("Run No. 2"));
    }

    #[test]
    fn time_that_restarts_begins_a_record_and_a_slip_does_not() {
        let twice = [counted(0, 40), counted(0, 30)].concat();
        let log = table(vec![("time", twice.clone()), ("P", twice)]);
        assert_eq!(Separation::proposed(&log), Separation::ByTime(0));
        let lengths: Vec<usize> = log
            .separated(Separation::ByTime(0))
            .iter()
            .map(RecordTable::rows)
            .collect();
        assert_eq!(lengths, [40, 30]);
        let mut slip = counted(0, 70);
        slip[35] = 30.5;
        let log = table(vec![("time", slip)]);
        assert_eq!(Separation::proposed(&log), Separation::None);
        assert_eq!(log.clone().separated(Separation::None), [log]);
    }

    #[test]
    fn a_count_of_samples_is_no_record_number() {
        let log = table(vec![("t", counted(0, 50)), ("record", counted(0, 50))]);
        assert_eq!(Separation::proposed(&log), Separation::None);
    }
}
