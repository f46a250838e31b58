//! A record in the form of its file: columns of samples.

use std::ops::Range;
use std::sync::Arc;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::names::channel_alias::folded_name;
use gdcm_model::names::time_name::time_name_rank;
use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit};
use gdcm_model::units::{number, telling};

use super::topic_tables::shown;

/// A column of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordColumn {
    /// Its name; "column 3" if the file has none.
    pub name: String,
    /// Its unit, if given in the file.
    pub unit: Option<String>,
    /// Its side, if given in the file.
    pub side: Option<ChannelSide>,
    /// Samples, in the file's unit; NaN where one is missing.
    pub values: Vec<f64>,
    /// Its topic, if that has a separate clock.
    pub topic: Option<Arc<TopicClock>>,
    /// The channel by the documentation of the logging system: "P", "LON".
    pub meaning: Option<&'static str>,
}

/// The sample times of a topic: some columns of a table, with separate stamps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TopicClock {
    /// Name of the topic.
    pub name: String,
    /// A stamp \[s\] for each sample of its columns.
    pub time_s: Vec<f64>,
}

impl RecordColumn {
    /// Creates a column from a name and samples only.
    pub fn new(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            unit: None,
            side: None,
            values,
            topic: None,
            meaning: None,
        }
    }

    /// Returns its name within its topic: `xyz[0]` for `vehicle_angular_velocity.xyz[0]`.
    pub fn field(&self) -> &str {
        let topic = self.topic.as_ref().map_or("", |topic| topic.name.as_str());
        self.name
            .strip_prefix(topic)
            .and_then(|rest| rest.strip_prefix('.'))
            .unwrap_or(&self.name)
    }

    /// Returns the unit given in the file, if any.
    pub fn said_unit(&self) -> Option<&str> {
        self.unit.as_deref().filter(|unit| !unit.trim().is_empty())
    }

    /// Returns the smallest and largest finite sample; `None` if there are none.
    pub fn range(&self) -> Option<(f64, f64)> {
        let finite = self
            .values
            .iter()
            .copied()
            .filter(|value| value.is_finite());
        let (least, most) = finite.fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(least, most), value| (least.min(value), most.max(value)),
        );
        (least <= most).then_some((least, most))
    }
}

/// Origin of a record.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordSource {
    pub file: String,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
    /// The record or variable within the file; `None` if the file has only one.
    pub variable: Option<String>,
}

/// A record in the form of its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordTable {
    /// Displayed name.
    pub name: String,
    /// Its columns, of equal length except for topics with separate clocks.
    pub columns: Vec<RecordColumn>,
    /// Whether the file names the columns.
    pub named: bool,
    /// Sample time \[s\], if the file gives it other than by a column.
    pub sample_time_s: Option<f64>,
    pub source: RecordSource,
    /// Notes on how it was read.
    pub notes: Vec<String>,
    /// Mode intervals of the logging system.
    pub modes: Vec<ModeSpan>,
    /// First and last time \[s\] of the part used as the record; `None` for the whole file.
    pub part_s: Option<[f64; 2]>,
}

/// Interval in which the logging system was armed, or in a flight mode.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeSpan {
    /// "armed", or the name of the mode.
    pub name: String,
    /// First and last time \[s\], on the clock of the record.
    pub ends_s: [f64; 2],
}

impl RecordTable {
    /// Creates a table of columns without further information.
    pub fn new(name: impl Into<String>, columns: Vec<RecordColumn>) -> Self {
        Self {
            name: name.into(),
            columns,
            named: true,
            ..Self::default()
        }
    }

    /// Returns the number of samples; with separate clocks, the largest number of any topic.
    pub fn rows(&self) -> usize {
        self.columns
            .iter()
            .map(|column| column.values.len())
            .max()
            .unwrap_or(0)
    }

    /// Returns the column with this name, exact or else ignoring case; `#30` is the thirtieth.
    pub fn find(&self, name: &str) -> Option<usize> {
        let position = |is_it: &dyn Fn(&str) -> bool| {
            self.columns.iter().position(|column| is_it(&column.name))
        };
        let numbered = || {
            let number: usize = name.trim().strip_prefix('#')?.parse().ok()?;
            number
                .checked_sub(1)
                .filter(|column| *column < self.columns.len())
        };
        // A column of a matrix, counted from 0 as in Python or from 1 as in MATLAB.
        let indexed = || {
            let (matrix, index, first) = match name.trim().strip_suffix(']') {
                Some(rest) => rest
                    .rsplit_once('[')
                    .map(|(matrix, index)| (matrix, index, 0))?,
                None => name
                    .trim()
                    .strip_suffix(')')?
                    .rsplit_once('(')
                    .map(|(matrix, index)| (matrix, index, 1))?,
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

    /// Returns the dataset entry of the record, and its condition: matched by its name in a file of
    /// the same name, or in an archive with another name.
    pub fn entry_of_dataset<'d>(
        &self,
        dataset: &'d Dataset,
    ) -> Option<(ConditionId, &'d ConditionRecord)> {
        let source = &self.source;
        for condition in dataset.conditions() {
            for entry in condition.records() {
                let same_file = file_name(&entry.file) == file_name(&source.file);
                let same_name = entry.variable.is_some() && entry.name == self.name;
                if (same_file || same_name)
                    && entry.variable == source.variable
                    && entry.part_s.is_none()
                {
                    return Some((condition.id(), entry));
                }
            }
        }
        None
    }

    /// Whether both are the same record: the same part of the same record in one file, or equal
    /// samples under the same name. Equal samples under another name are a copy
    /// (`leave_out_copies`).
    pub fn is_same_record(&self, other: &Self) -> bool {
        let is_same_file = self.source.sha256 == other.source.sha256
            && !self.source.sha256.is_empty()
            && file_name(&self.source.file) == file_name(&other.source.file);
        let is_same_source = is_same_file && self.source.variable == other.source.variable;
        let is_same_content =
            self.name == other.name && same_columns(&self.columns, &other.columns);
        self.part_s == other.part_s && (is_same_source || is_same_content)
    }

    /// Returns the name of a column in quotation marks.
    pub(super) fn quoted(&self, column: usize) -> String {
        self.columns.get(column).map_or_else(
            || format!("column {}", column + 1),
            |column| format!("\"{}\"", column.name),
        )
    }

    /// Returns the names of all columns, shortened to fit a message.
    pub(super) fn column_names(&self) -> String {
        shown(
            &self
                .columns
                .iter()
                .map(|column| column.name.as_str())
                .collect::<Vec<_>>(),
        )
    }
}

/// Returns the last part of a path.
fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// Whether columns have equal names and equal samples, to the last bit.
fn same_columns(first: &[RecordColumn], second: &[RecordColumn]) -> bool {
    let same = |a: &RecordColumn, b: &RecordColumn| {
        let values = a.values.iter().map(|value| value.to_bits());
        a.name == b.name
            && a.unit == b.unit
            && values.eq(b.values.iter().map(|value| value.to_bits()))
    };
    first.len() == second.len() && first.iter().zip(second).all(|(a, b)| same(a, b))
}

// Several records in one table.

/// Separation of several records in one table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separation {
    /// The table is one record.
    None,
    /// A column with one number for each record.
    ByColumn(usize),
    /// A column of stamps that restarts.
    ByTime(usize),
}

/// Names of columns with record numbers.
const NUMBERS: &str = "record records recordid recordno recordnumber run runid runno runnumber manoeuvre maneuver segment event \
                       testpoint experiment";

impl Separation {
    /// Fewest samples of a record in a table with several.
    pub const FEWEST: usize = 20;

    /// Proposes the separation of a table from its column names and stamps.
    pub fn proposed(table: &RecordTable) -> Self {
        if table.columns.iter().any(|column| column.topic.is_some()) {
            return Self::None;
        }
        let numbers = |index: &usize| {
            let column = &table.columns[*index];
            let name = folded_name(&column.name);
            NUMBERS.split(' ').any(|word| word == name) && {
                let runs = runs_of(&column.values);
                runs.len() > 1
                    && runs.iter().all(|run| {
                        run.len() >= Self::FEWEST && column.values[run.start].fract() == 0.0
                    })
            }
        };
        if let Some(column) = (0..table.columns.len()).find(numbers) {
            return Self::ByColumn(column);
        }
        let restarts = |column: &usize| {
            let parts = rising_parts(&table.columns[*column].values);
            parts.len() > 1 && parts.iter().all(|part| part.len() >= Self::FEWEST)
        };
        TimeBase::find(table)
            .filter(restarts)
            .map_or(Self::None, Self::ByTime)
    }
}

impl RecordTable {
    /// Splits the table into records, named by their number or part. Samples without a number
    /// belong to no record.
    pub fn separated(self, separation: Separation) -> Vec<RecordTable> {
        let (parts, why): (Vec<(Range<usize>, String)>, String) = match separation {
            Separation::None => return vec![self],
            Separation::ByColumn(column) => {
                let Some(numbers) = self.columns.get(column) else {
                    return vec![self];
                };
                let mut seen: Vec<f64> = Vec::new();
                let named = |run: Range<usize>| {
                    let value = numbers.values[run.start];
                    seen.push(value);
                    let times = seen.iter().filter(|other| **other == value).count();
                    let again = if times > 1 {
                        format!(", part {times}")
                    } else {
                        String::new()
                    };
                    (run, format!("{} {}{again}", numbers.name, number(value)))
                };
                let runs = runs_of(&numbers.values).into_iter().map(named).collect();
                (runs, format!("column {} changes", self.quoted(column)))
            }
            Separation::ByTime(column) => {
                let Some(stamps) = self.columns.get(column) else {
                    return vec![self];
                };
                let parts = rising_parts(&stamps.values).into_iter().enumerate();
                let parts = parts
                    .map(|(index, part)| (part, format!("part {}", index + 1)))
                    .collect();
                (parts, "the time restarts".to_owned())
            }
        };
        let why = format!("one of {} records: {why}", parts.len());
        parts
            .into_iter()
            .map(|(rows, name)| self.part(rows, &name, &why))
            .collect()
    }

    fn part(&self, rows: Range<usize>, name: &str, why: &str) -> RecordTable {
        let variable = self
            .source
            .variable
            .iter()
            .map(String::as_str)
            .chain([name])
            .collect::<Vec<_>>()
            .join(", ");
        let columns = self.columns.iter().map(|column| RecordColumn {
            unit: column.unit.clone(),
            side: column.side,
            meaning: column.meaning,
            ..RecordColumn::new(column.name.clone(), column.values[rows.clone()].to_vec())
        });
        RecordTable {
            named: self.named,
            sample_time_s: self.sample_time_s,
            source: RecordSource {
                variable: Some(variable),
                ..self.source.clone()
            },
            notes: self.notes.iter().cloned().chain([why.to_owned()]).collect(),
            modes: self.modes.clone(),
            ..RecordTable::new(format!("{}, {name}", self.name), columns.collect())
        }
    }
}

/// Returns ranges of samples with equal numbers; samples without a number are skipped.
fn runs_of(numbers: &[f64]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (sample, value) in numbers
        .iter()
        .enumerate()
        .filter(|(_, value)| value.is_finite())
    {
        match runs.last_mut() {
            Some(run) if run.end == sample && numbers[run.start] == *value => run.end += 1,
            _ => runs.push(sample..sample + 1),
        }
    }
    runs
}

/// Returns ranges of samples between restarts: decreases of the stamps that are not recovered
/// within a few samples, unlike a slip.
fn rising_parts(stamps: &[f64]) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut start = 0;
    let mut last = f64::NEG_INFINITY;
    for (sample, stamp) in stamps
        .iter()
        .enumerate()
        .filter(|(_, stamp)| stamp.is_finite())
    {
        let stays_below = || {
            stamps[sample..]
                .iter()
                .take(Separation::FEWEST / 2)
                .all(|later| later.is_nan() || *later < last)
        };
        if *stamp < last && stays_below() {
            parts.push(start..sample);
            start = sample;
        }
        last = *stamp;
    }
    parts.push(start..stamps.len());
    parts
}

// Source of the sample times.

/// Source of the sample times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeBase {
    /// A column of stamps.
    Column {
        /// Its index.
        column: usize,
        /// Seconds per unit of the column.
        seconds: f64,
    },
    /// Equidistant samples with this sample time \[s\].
    SampleTime(f64),
    /// The separate stamps of each topic.
    Topics,
}

/// Longest plausible step of a manoeuvre \[s\].
pub(super) const LONGEST_STEP_S: f64 = 1.5;
/// Shortest plausible step of a flight recorder \[s\].
const SHORTEST_STEP_S: f64 = 5e-5;
const SECONDS_A_DAY: f64 = 86_400.0;

impl TimeBase {
    /// Returns the times of the samples \[s\]; NaN where a stamp is missing.
    pub fn times_s(self, table: &RecordTable) -> Vec<f64> {
        match self {
            TimeBase::SampleTime(step_s) => (0..table.rows())
                .map(|sample| sample as f64 * step_s)
                .collect(),
            TimeBase::Topics => Vec::new(),
            TimeBase::Column { column, seconds } => {
                let stamps = table
                    .columns
                    .get(column)
                    .map_or(&[][..], |column| &column.values);
                stamps
                    .iter()
                    .map(|stamp| {
                        if stamp.is_finite() {
                            stamp * seconds
                        } else {
                            f64::NAN
                        }
                    })
                    .collect()
            }
        }
    }

    /// Returns the median step \[s\]; `None` without two stamps.
    pub fn step_s(self, table: &RecordTable) -> Option<f64> {
        match self {
            TimeBase::SampleTime(step_s) => Some(step_s),
            TimeBase::Topics => None,
            TimeBase::Column { column, seconds } => {
                Some(median_step(&table.columns.get(column)?.values)? * seconds)
            }
        }
    }

    /// Returns the time base of a column of stamps and the reason for its unit: the given unit, the
    /// end of its name, or else the length of its steps.
    pub(super) fn of_column(table: &RecordTable, column: usize) -> (Self, String) {
        let stamps = &table.columns[column];
        let (unit, why) = unit_of(stamps);
        (
            TimeBase::Column {
                column,
                seconds: unit.1,
            },
            format!(
                "time from column {}, in {}{why}",
                table.quoted(column),
                unit.0
            ),
        )
    }

    /// Finds the time column by its name, or as the first, rising column of a table without names.
    pub(super) fn find(table: &RecordTable) -> Option<usize> {
        let rank = |index: usize| {
            let column = &table.columns[index];
            let by_name = if table.named {
                time_name_rank(&column.name)
            } else {
                (index == 0).then_some(2)
            }?;
            // A column that mostly repeats or decreases is a time by name only.
            Some((u8::from(!mostly_rises(&column.values)), by_name, index))
        };
        let best = (0..table.columns.len()).filter_map(rank).min()?;
        (table.named || best.0 == 0).then_some(best.2)
    }
}

/// Returns the seconds in a unit of time, and its usual spelling.
fn seconds_in(unit: &str) -> Option<(&'static str, f64)> {
    let unit = PhysicalUnit::of(unit).filter(|unit| unit.dimension == Dimension::Time)?;
    Some((unit.name, unit.size))
}

fn unit_of(stamps: &RecordColumn) -> ((&'static str, f64), String) {
    let last_word = stamps
        .name
        .rsplit(|c: char| !c.is_alphanumeric())
        .next()
        .filter(|word| *word != stamps.name);
    if let Some(unit) = stamps
        .unit
        .as_deref()
        .into_iter()
        .chain(last_word)
        .find_map(seconds_in)
    {
        return (unit, String::new());
    }
    let step = median_step(&stamps.values).unwrap_or(f64::NAN);
    let told = |unit: &'static str| {
        format!(
            " (its steps are {}: {unit} would be too {})",
            telling(step, 3),
            if step > 1.0 { "long" } else { "short" }
        )
    };
    // Steps that are too short for milliseconds are microseconds, and so on.
    let units = [("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)];
    if step > LONGEST_STEP_S {
        let fits = |unit: &&(&str, f64)| (2e-4..=LONGEST_STEP_S).contains(&(step * unit.1));
        return units
            .iter()
            .find(fits)
            .map_or((("s", 1.0), String::new()), |unit| (*unit, told("s")));
    }
    if step > 0.0
        && step < SHORTEST_STEP_S
        && (2e-4..=LONGEST_STEP_S).contains(&(step * SECONDS_A_DAY))
    {
        return (("days", SECONDS_A_DAY), told("s"));
    }
    (("s", 1.0), " (the file does not say the unit)".to_owned())
}

/// Returns the median step between consecutive stamps.
pub fn median_step(stamps: &[f64]) -> Option<f64> {
    let steps = stamps.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps: Vec<f64> = steps.filter(|step| step.is_finite()).collect();
    let middle = steps.len() / 2;
    (!steps.is_empty()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

fn mostly_rises(stamps: &[f64]) -> bool {
    let steps = stamps
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| step.is_finite());
    let (rising, all) = steps.fold((0, 0), |(rising, all), step| {
        (rising + usize::from(step > 0.0), all + 1)
    });
    all > 0 && 2 * rising > all
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
    fn a_column_that_numbers_records_tells_them_apart() {
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
    fn a_count_of_samples_numbers_no_records() {
        let log = table(vec![("t", counted(0, 50)), ("record", counted(0, 50))]);
        assert_eq!(Separation::proposed(&log), Separation::None);
    }

    fn table_with(name: &str, unit: Option<&str>, stamps: Vec<f64>) -> RecordTable {
        let column = RecordColumn {
            unit: unit.map(str::to_owned),
            ..RecordColumn::new(name, stamps)
        };
        RecordTable {
            name: "r".into(),
            columns: vec![
                RecordColumn::new("time constant", vec![1.0; column.values.len()]),
                column,
            ],
            named: true,
            sample_time_s: None,
            ..RecordTable::new("r", Vec::new())
        }
    }

    fn stamps(step: f64) -> Vec<f64> {
        (0..50)
            .map(|sample| 3.0 + step * f64::from(sample))
            .collect()
    }

    #[test]
    fn the_time_is_found_by_its_name_and_by_rising() {
        for name in [
            "t",
            "Time",
            "time_s",
            "TIME [s]",
            "Elapsed",
            "real,_time",
            "t_ms",
            "timestamp",
        ] {
            assert_eq!(
                TimeBase::find(&table_with(name, None, stamps(0.02))),
                Some(1),
                "{name}"
            );
        }
        assert_eq!(
            TimeBase::find(&table_with("theta", None, stamps(0.02))),
            Some(0),
            "by its name only"
        );
        let mut unnamed = table_with("column 2", None, stamps(0.02));
        unnamed.named = false;
        assert_eq!(
            TimeBase::find(&unnamed),
            None,
            "its first column does not rise"
        );
        unnamed.columns.swap(0, 1);
        assert_eq!(TimeBase::find(&unnamed), Some(0));
    }

    #[test]
    fn the_unit_of_time_is_said_by_the_file_or_by_the_length_of_the_steps() {
        let seconds = |name, unit, step| match TimeBase::of_column(
            &table_with(name, unit, stamps(step)),
            1,
        ) {
            (TimeBase::Column { seconds, .. }, words) => (seconds, words),
            _ => panic!("it is a column"),
        };
        assert_eq!(
            seconds("t", Some("ms"), 20.0),
            (1e-3, "time from column \"t\", in ms".to_owned())
        );
        assert_eq!(seconds("time_ms", None, 20.0).0, 1e-3);
        assert_eq!(
            seconds("time_s", None, 20.0).0,
            1.0,
            "as the file says: it is for the checks to doubt it"
        );
        assert_eq!(
            seconds("t", None, 0.02),
            (
                1.0,
                "time from column \"t\", in s (the file does not say the unit)".into()
            )
        );
        let (by_steps, words) = seconds("t", None, 20.0);
        assert_eq!(
            (by_steps, words.as_str()),
            (
                1e-3,
                "time from column \"t\", in ms (its steps are 20.000: s would be too long)"
            )
        );
        assert_eq!(seconds("t", None, 20_000.0).0, 1e-6);
        assert_eq!(
            seconds("t", None, 0.02 / 86_400.0).0,
            86_400.0,
            "days, as Excel and MATLAB count them"
        );
    }

    #[test]
    fn a_missing_stamp_is_no_number_and_does_not_move_the_median() {
        let mut gaps = stamps(20.0);
        gaps[7] = f64::INFINITY;
        let table_with = table_with("t", Some("ms"), gaps);
        let base = TimeBase::of_column(&table_with, 1).0;
        assert!(base.times_s(&table_with)[7].is_nan());
        assert!(
            (base.step_s(&table_with).unwrap() - 0.02).abs() < 1e-15,
            "one rounding of the factor"
        );
        assert_eq!(TimeBase::SampleTime(0.5).times_s(&table_with)[3], 1.5);
    }
}
