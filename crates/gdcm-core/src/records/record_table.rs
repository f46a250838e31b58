//! A record as its file has it: columns of samples.

use super::*;
use crate::units::number;
use std::ops::Range;
use std::sync::Arc;

/// A column of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordColumn {
    /// Its name; "column 3" where the file has none.
    pub name: String,
    /// Its unit, where the file says it.
    pub unit: Option<String>,
    /// Its side, where the file says it.
    pub side: Option<ChannelSide>,
    /// Samples, in the file's unit; not a number where one is missing.
    pub values: Vec<f64>,
    /// The topic that it is of, where that has a clock of its own.
    pub topic: Option<Arc<TopicClock>>,
    /// The channel that it is by the documentation of the system that logged it: "P", "LON".
    pub meaning: Option<&'static str>,
}

/// When the samples of a topic were taken: some columns of a table, with stamps of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TopicClock {
    /// Name of the topic.
    pub name: String,
    /// A stamp \[s\] for each sample of its columns.
    pub time_s: Vec<f64>,
}

impl RecordColumn {
    /// A column of which nothing but its name is known.
    pub fn new(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self { name: name.into(), unit: None, side: None, values, topic: None, meaning: None }
    }

    /// Its name within its topic: `xyz[0]` of `vehicle_angular_velocity.xyz[0]`.
    pub fn field(&self) -> &str {
        let topic = self.topic.as_ref().map_or("", |topic| topic.name.as_str());
        self.name.strip_prefix(topic).and_then(|rest| rest.strip_prefix('.')).unwrap_or(&self.name)
    }

    /// The unit that the file says, where it does.
    pub fn said_unit(&self) -> Option<&str> {
        self.unit.as_deref().filter(|unit| !unit.trim().is_empty())
    }

    /// Least and greatest of the samples that are numbers; none where there are none.
    pub fn range(&self) -> Option<(f64, f64)> {
        let finite = self.values.iter().copied().filter(|value| value.is_finite());
        let (least, most) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
        (least <= most).then_some((least, most))
    }
}

/// Where a record comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordSource {
    /// The file.
    pub file: String,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
    /// Which record of the file, or which variable; none where the file holds one.
    pub variable: Option<String>,
}

/// A record as its file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordTable {
    /// Its name, for people.
    pub name: String,
    /// Its columns, all of one length but for those of topics with clocks of their own.
    pub columns: Vec<RecordColumn>,
    /// Whether the file names the columns.
    pub named: bool,
    /// Sample time \[s\], where the file says it other than by a column.
    pub sample_time_s: Option<f64>,
    /// Where it comes from.
    pub source: RecordSource,
    /// How it was read, in words.
    pub notes: Vec<String>,
    /// What the system that logged it was at, when.
    pub modes: Vec<ModeSpan>,
    /// First and last time \[s\] of the part of it that is the record; none is all of it.
    pub part_s: Option<[f64; 2]>,
}

/// From when to when the system that logged a record was armed, or in a flight mode.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeSpan {
    /// "armed", or the name of the mode.
    pub name: String,
    /// First and last time \[s\], on the clock of the record.
    pub ends_s: [f64; 2],
}

impl RecordTable {
    /// A table of columns, of which nothing else is known.
    pub fn new(name: impl Into<String>, columns: Vec<RecordColumn>) -> Self {
        Self {
            name: name.into(),
            columns,
            named: true,
            sample_time_s: None,
            source: RecordSource::default(),
            notes: Vec::new(),
            modes: Vec::new(),
            part_s: None,
        }
    }

    /// Number of samples; of topics with clocks of their own, of the one that has most.
    pub fn rows(&self) -> usize {
        self.columns.iter().map(|column| column.values.len()).max().unwrap_or(0)
    }

    /// The column of this name, as it is written, else without case; `#30` is the thirtieth.
    pub fn find(&self, name: &str) -> Option<usize> {
        let position = |is_it: &dyn Fn(&str) -> bool| self.columns.iter().position(|column| is_it(&column.name));
        let numbered = || {
            let number: usize = name.trim().strip_prefix('#')?.parse().ok()?;
            number.checked_sub(1).filter(|column| *column < self.columns.len())
        };
        // A column of a matrix, counted from 0 as Python does or from 1 as MATLAB does.
        let indexed = || {
            let (matrix, index, first) = match name.trim().strip_suffix(']') {
                Some(rest) => rest.rsplit_once('[').map(|(matrix, index)| (matrix, index, 0))?,
                None => name.trim().strip_suffix(')')?.rsplit_once('(').map(|(matrix, index)| (matrix, index, 1))?,
            };
            let index: usize = index.trim().parse().ok()?;
            let column = format!("{matrix}_{}", index.checked_sub(first)? + 1);
            position(&|name| name.eq_ignore_ascii_case(&column))
        };
        position(&|column| column == name)
            .or_else(|| position(&|column| column.eq_ignore_ascii_case(name.trim())))
            .or_else(numbered)
            .or_else(indexed)
    }

    /// The name of a column in quotation marks.
    pub(super) fn quoted(&self, column: usize) -> String {
        self.columns
            .get(column)
            .map_or_else(|| format!("column {}", column + 1), |column| format!("\"{}\"", column.name))
    }

    /// The names of all columns, no more than a message can bear.
    pub(super) fn column_names(&self) -> String {
        /// Enough to see what went wrong.
        const SHOWN: usize = 20;
        let names: Vec<&str> = self.columns.iter().take(SHOWN).map(|column| column.name.as_str()).collect();
        let rest = self.columns.len() - names.len();
        let more = if rest == 0 { String::new() } else { format!(" and {rest} more") };
        format!("{}{more}", names.join(", "))
    }
}

// Several records in one table.

/// What tells the records of one table apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separation {
    /// The table is one record.
    None,
    /// A column that has one number for each record.
    ByColumn(usize),
    /// A column of stamps that begins again.
    ByTime(usize),
}

/// Names of columns that number records.
const NUMBERS: [&str; 15] = [
    "record",
    "records",
    "recordid",
    "recordno",
    "recordnumber",
    "run",
    "runid",
    "runno",
    "runnumber",
    "manoeuvre",
    "maneuver",
    "segment",
    "event",
    "testpoint",
    "experiment",
];

impl Separation {
    /// Fewer samples than these are no record of several in a file.
    pub const FEWEST: usize = 20;

    /// What tells the records of a table apart, as far as names of columns and stamps say.
    pub fn proposed(table: &RecordTable) -> Self {
        if table.columns.iter().any(|column| column.topic.is_some()) {
            return Self::None;
        }
        let numbers = |index: &usize| {
            let column = &table.columns[*index];
            let name: String =
                column.name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
            NUMBERS.contains(&name.as_str()) && {
                let runs = runs_of(&column.values);
                runs.len() > 1
                    && runs.iter().all(|run| run.len() >= Self::FEWEST && column.values[run.start].fract() == 0.0)
            }
        };
        if let Some(column) = (0..table.columns.len()).find(numbers) {
            return Self::ByColumn(column);
        }
        match TimeBase::find(table) {
            Some(column)
                if {
                    let parts = rising_parts(&table.columns[column].values);
                    parts.len() > 1 && parts.iter().all(|part| part.len() >= Self::FEWEST)
                } =>
            {
                Self::ByTime(column)
            }
            _ => Self::None,
        }
    }
}

impl RecordTable {
    /// The records of the table, each named by what tells it apart. Samples without a number belong to none.
    pub fn separated(self, separation: Separation) -> Vec<RecordTable> {
        let parts: Vec<(Range<usize>, String)> = match separation {
            Separation::None => return vec![self],
            Separation::ByColumn(column) => {
                let Some(numbers) = self.columns.get(column) else { return vec![self] };
                let mut seen: Vec<f64> = Vec::new();
                let named = |run: Range<usize>| {
                    let value = numbers.values[run.start];
                    seen.push(value);
                    let times = seen.iter().filter(|other| **other == value).count();
                    let again = if times > 1 { format!(", part {times}") } else { String::new() };
                    (run, format!("{} {}{again}", numbers.name, number(value)))
                };
                runs_of(&numbers.values).into_iter().map(named).collect()
            }
            Separation::ByTime(column) => {
                let Some(stamps) = self.columns.get(column) else { return vec![self] };
                let parts = rising_parts(&stamps.values).into_iter().enumerate();
                parts.map(|(index, part)| (part, format!("part {}", index + 1))).collect()
            }
        };
        let why = match separation {
            Separation::ByColumn(column) => {
                format!("one of {} records: column {} changes", parts.len(), self.quoted(column))
            }
            _ => format!("one of {} records: the time restarts", parts.len()),
        };
        parts.into_iter().map(|(rows, name)| self.part(rows, &name, &why)).collect()
    }

    fn part(&self, rows: Range<usize>, name: &str, why: &str) -> RecordTable {
        let variable = self.source.variable.iter().map(String::as_str).chain([name]).collect::<Vec<_>>().join(", ");
        let columns = self.columns.iter().map(|column| RecordColumn {
            unit: column.unit.clone(),
            side: column.side,
            meaning: column.meaning,
            ..RecordColumn::new(column.name.clone(), column.values[rows.clone()].to_vec())
        });
        RecordTable {
            named: self.named,
            sample_time_s: self.sample_time_s,
            source: RecordSource { variable: Some(variable), ..self.source.clone() },
            notes: self.notes.iter().cloned().chain([why.to_owned()]).collect(),
            modes: self.modes.clone(),
            ..RecordTable::new(format!("{}, {name}", self.name), columns.collect())
        }
    }
}

/// Ranges of samples with one number each; none for those without.
fn runs_of(numbers: &[f64]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (sample, value) in numbers.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        match runs.last_mut() {
            Some(run) if run.end == sample && numbers[run.start] == *value => run.end += 1,
            _ => runs.push(sample..sample + 1),
        }
    }
    runs
}

/// Ranges of samples between restarts: falls of the stamps that are not made good within some samples, as a slip is.
fn rising_parts(stamps: &[f64]) -> Vec<Range<usize>> {
    let (mut parts, mut start, mut last) = (Vec::new(), 0, f64::NEG_INFINITY);
    for (sample, stamp) in stamps.iter().enumerate().filter(|(_, stamp)| stamp.is_finite()) {
        let stays_below =
            || stamps[sample..].iter().take(Separation::FEWEST / 2).all(|later| later.is_nan() || *later < last);
        if *stamp < last && stays_below() {
            parts.push(start..sample);
            start = sample;
        }
        last = *stamp;
    }
    parts.push(start..stamps.len());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(columns: Vec<(&str, Vec<f64>)>) -> RecordTable {
        let columns = columns.into_iter().map(|(name, values)| RecordColumn::new(name, values)).collect();
        RecordTable::new("log", columns)
    }

    fn counted(from: usize, to: usize) -> Vec<f64> {
        (from..to).map(|sample| sample as f64).collect()
    }

    #[test]
    fn a_column_that_numbers_records_tells_them_apart() {
        let runs = [vec![1.0; 30], vec![f64::NAN; 5], vec![2.0; 25], vec![1.0; 40]].concat();
        let log = table(vec![("t", counted(0, 100)), ("Run No.", runs), ("P", counted(0, 100))]);
        assert_eq!(Separation::proposed(&log), Separation::ByColumn(1));
        let records = log.separated(Separation::ByColumn(1));
        let names: Vec<&str> = records.iter().map(|record| record.name.as_str()).collect();
        assert_eq!(names, ["log, Run No. 1", "log, Run No. 2", "log, Run No. 1, part 2"]);
        assert_eq!(records[1].columns[2].values, counted(35, 60));
        assert_eq!(records[1].source.variable.as_deref(), Some("Run No. 2"));
    }

    #[test]
    fn time_that_restarts_begins_a_record_and_a_slip_does_not() {
        let twice = [counted(0, 40), counted(0, 30)].concat();
        let log = table(vec![("time", twice.clone()), ("P", twice)]);
        assert_eq!(Separation::proposed(&log), Separation::ByTime(0));
        let lengths: Vec<usize> = log.separated(Separation::ByTime(0)).iter().map(RecordTable::rows).collect();
        assert_eq!(lengths, [40, 30]);
        let mut slip = counted(0, 70);
        slip[35] = 30.5;
        let log = table(vec![("time", slip)]);
        assert_eq!(Separation::proposed(&log), Separation::None);
        assert_eq!(log.clone().separated(Separation::None), [log]);
    }

    #[test]
    fn a_count_of_samples_numbers_no_records() {
        let log = table(vec![("t", counted(0, 50)), ("record", counted(0, 50))]);
        assert_eq!(Separation::proposed(&log), Separation::None);
    }
}
