//! Tables that are topics of one record: one file or struct per topic.
//!
//! A table with a column for every channel is a record. Tables that lack some channels may have all
//! of them together: these are the topics of one log, each with separate stamps. The name of a
//! table names its columns.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_model::names::time_name::time_name_rank;
use gdcm_model::units::number;

use super::layout_problem::LayoutProblem;
use super::layout_proposal::TimeWish;
use super::record_channels::RecordChannels;
use super::record_layout::{RecordLayout, same_samples};
use super::record_table::{
    RecordColumn, RecordSource, RecordTable, Separation, TimeBase, TopicClock, median_step,
};

/// Uninformative names of the only column beside the stamps of a topic.
const PLAIN: [&str; 8] = [
    "value", "values", "data", "signal", "signals", "x", "y", "val",
];
impl RecordTable {
    /// Name of the record that the topics of a file or folder form together.
    pub const TOPICS: &'static str = "its topics";

    /// Returns the record that topics form under this name: all of them as [`Self::TOPICS`], or
    /// those of one of several logs as "its topics, log_7".
    pub fn of_topics_called(tables: &[RecordTable], variable: &str) -> Option<RecordTable> {
        if variable == Self::TOPICS {
            return Some(Self::of_topics(tables));
        }
        let log = variable.strip_prefix(Self::TOPICS)?.strip_prefix(", ")?;
        let logs = logs_of(&topic_names(tables));
        let of_log = tables
            .iter()
            .zip(logs)
            .filter(|(_, of)| of == log)
            .map(|(table, _)| table.clone());
        let of_log: Vec<RecordTable> = of_log.collect();
        (!of_log.is_empty()).then(|| Self::of_log(&of_log, log))
    }

    /// Combines the topics of one of several logs, side by side.
    fn of_log(tables: &[RecordTable], log: &str) -> RecordTable {
        let joined = Self::of_topics(tables);
        let variable = Some(format!("{}, {log}", Self::TOPICS));
        RecordTable {
            name: log.to_owned(),
            source: RecordSource {
                variable,
                ..joined.source
            },
            ..joined
        }
    }

    /// Combines the topics of one record, side by side; tables without a time are left out and
    /// reported.
    fn of_topics(tables: &[RecordTable]) -> RecordTable {
        let first = tables.first();
        let file = first
            .map(|table| table.source.file.as_str())
            .unwrap_or_default();
        let one_file = tables.iter().all(|table| table.source.file == file);
        let folder = file.rsplit_once('/').map_or("", |(folder, _)| folder);
        let file = if one_file { file } else { folder };
        let sha256 = first
            .filter(|_| one_file)
            .map(|table| table.source.sha256.clone())
            .unwrap_or_default();
        let last = file.rsplit('/').next().unwrap_or_default();
        let stem = if one_file {
            last.rsplit_once('.').map_or(last, |(stem, _)| stem)
        } else {
            last
        };
        let mut joined = RecordTable {
            source: RecordSource {
                file: file.to_owned(),
                sha256,
                variable: Some(Self::TOPICS.to_owned()),
            },
            ..RecordTable::new(if stem.is_empty() { "topics" } else { stem }, Vec::new())
        };
        let names = topic_names(tables);
        let prefix = common_prefix(&names);
        let seconds = seconds_by_name(tables);
        let mut taken = Vec::new();
        let mut left_out = Vec::new();
        for (table, name) in tables.iter().zip(&names) {
            let name = name.get(prefix..).unwrap_or(name);
            match topic_columns(table, name, &seconds) {
                Some(columns) => {
                    joined.columns.extend(columns);
                    taken.push(name);
                }
                None => left_out.push(name),
            }
            joined.modes.extend(table.modes.iter().cloned());
        }
        joined.notes.push(format!(
            "one record of {} topics: {}",
            taken.len(),
            shown(&taken)
        ));
        if !left_out.is_empty() {
            joined
                .notes
                .push(format!("without a time, left out: {}", shown(&left_out)));
        }
        joined
    }

    /// Splits a table with several columns of stamps, each followed by its samples, into topics;
    /// returns any other table unchanged.
    ///
    /// The stamps of each topic rise, and their times overlap: a second clock with another origin
    /// is an ordinary column.
    #[must_use]
    pub fn side_by_side(mut self) -> RecordTable {
        let is_time = |column: &RecordColumn| {
            let name = column
                .name
                .trim_end_matches(|letter: char| letter.is_ascii_digit() || letter == '.');
            time_name_rank(name).is_some() && rises(&column.values)
        };
        let times: Vec<usize> = (0..self.columns.len())
            .filter(|&column| is_time(&self.columns[column]))
            .collect();
        let has_others = |pair: &[usize]| pair[1] > pair[0] + 1;
        let is_apart = times.len() > 1
            && times[0] == 0
            && times.windows(2).all(has_others)
            && times
                .last()
                .is_some_and(|last| last + 1 < self.columns.len());
        if !self.named || !is_apart || self.columns.iter().any(|column| column.topic.is_some()) {
            return self;
        }
        let (base, _) = TimeBase::of_column(&self, 0);
        let TimeBase::Column { seconds, .. } = base else {
            return self;
        };
        let stamps = |column: usize| TimeBase::Column { column, seconds }.times_s(&self);
        let clocks: Vec<Vec<f64>> = times.iter().map(|column| stamps(*column)).collect();
        let ends = |clock: &Vec<f64>| {
            let known = || clock.iter().copied().filter(|time| time.is_finite());
            known().next().zip(known().next_back())
        };
        let first = ends(&clocks[0]);
        let overlaps = |clock: &Vec<f64>| match (ends(clock), first) {
            (Some(a), Some(b)) => a.1.min(b.1) - a.0.max(b.0) > 0.5 * (a.1 - a.0).min(b.1 - b.0),
            _ => false,
        };
        if !clocks.iter().all(overlaps)
            || clocks.iter().all(|clock| same_samples(clock, &clocks[0]))
        {
            return self;
        }
        let ends = times
            .iter()
            .skip(1)
            .copied()
            .chain([self.columns.len()])
            .collect::<Vec<_>>();
        for ((&time, &end), clock) in times.iter().zip(&ends).zip(&clocks) {
            let rows: Vec<usize> = (0..clock.len())
                .filter(|row| clock[*row].is_finite())
                .collect();
            let time_s = rows.iter().map(|row| clock[*row]).collect();
            let topic = Arc::new(TopicClock {
                name: String::new(),
                time_s,
            });
            for column in &mut self.columns[time + 1..end] {
                column.values = rows.iter().map(|row| column.values[*row]).collect();
                column.topic = Some(Arc::clone(&topic));
            }
        }
        let mut column = 0;
        self.columns.retain(|_| {
            column += 1;
            !times.contains(&(column - 1))
        });
        self.notes.push(format!(
            "{} tables side by side, each behind its own stamps",
            times.len()
        ));
        self
    }

    /// Returns the part of the record between two times on its own clock \[s\].
    #[must_use]
    pub fn part_of_time(&self, part_s: [f64; 2]) -> RecordTable {
        let mut part = self.clone();
        part.name = format!(
            "{}, {} to {} s",
            self.name,
            number(part_s[0]),
            number(part_s[1])
        );
        part.part_s = Some(part_s);
        part
    }
}

/// Combines tables that are topics of one record: in each file or folder, tables that lack a
/// channel and have all channels together. If they are topics of several logs, so that channels
/// have several columns, each log is combined separately. Other tables are unchanged.
pub fn with_topics_joined(
    tables: Vec<RecordTable>,
    channels: &RecordChannels,
    time: &TimeWish,
) -> Vec<RecordTable> {
    let lacks = |table: &RecordTable| {
        let problems = RecordLayout::proposed(table, channels, time).problems;
        problems.iter().any(|problem| {
            matches!(
                problem,
                LayoutProblem::NoColumn { .. }
                    | LayoutProblem::SeveralColumns { .. }
                    | LayoutProblem::Unnamed { .. }
            )
        })
    };
    let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, table) in tables.iter().enumerate().filter(|(_, table)| lacks(table)) {
        groups
            .entry(group_of(&table.source))
            .or_default()
            .push(index);
    }
    let mut joined: BTreeMap<usize, RecordTable> = BTreeMap::new();
    let mut gone = vec![false; tables.len()];
    let of_group = |group: &[usize]| {
        group
            .iter()
            .map(|index| tables[*index].clone())
            .collect::<Vec<_>>()
    };
    let mut join = |group: &[usize], together: RecordTable| {
        let is_record = !together.columns.is_empty() && !lacks(&together);
        if is_record {
            group.iter().for_each(|index| gone[*index] = true);
            joined.insert(group[0], together);
        }
        is_record
    };
    for group in groups.into_values().filter(|group| group.len() > 1) {
        let topics = of_group(&group);
        if join(&group, RecordTable::of_topics(&topics)) {
            continue;
        }
        let mut of_logs: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (index, log) in group.iter().zip(logs_of(&topic_names(&topics))) {
            of_logs.entry(log).or_default().push(*index);
        }
        for (log, group) in of_logs
            .into_iter()
            .filter(|(log, group)| !log.is_empty() && group.len() > 1)
        {
            join(&group, RecordTable::of_log(&of_group(&group), &log));
        }
    }
    let tables = tables.into_iter().enumerate();
    tables
        .filter_map(|(index, table)| {
            if gone[index] {
                joined.remove(&index)
            } else {
                Some(table)
            }
        })
        .collect()
}

/// Whether stamps rise and are numerous enough for a signal, without values after the first missing
/// stamp.
fn rises(stamps: &[f64]) -> bool {
    let known: Vec<f64> = stamps
        .iter()
        .copied()
        .take_while(|stamp| stamp.is_finite())
        .collect();
    let rest = &stamps[known.len()..];
    known.len() >= Separation::FEWEST
        && known.windows(2).all(|pair| pair[1] > pair[0])
        && rest.iter().all(|stamp| stamp.is_nan())
}

/// Returns the common key of the topics of one log: their file, or else the folder of their files.
fn group_of(source: &RecordSource) -> String {
    match &source.variable {
        Some(_) => source.file.clone(),
        None => source
            .file
            .rsplit_once('/')
            .map_or(String::new(), |(folder, _)| format!("{folder}/")),
    }
}

/// Returns the name of each topic.
fn topic_names(tables: &[RecordTable]) -> Vec<String> {
    let first = tables.first().map(|table| table.source.file.as_str());
    let one_file = tables
        .iter()
        .all(|table| Some(table.source.file.as_str()) == first);
    tables
        .iter()
        .map(|table| topic_name(table, one_file))
        .collect()
}

/// Separators between the words of a name.
const MARKS: [char; 4] = ['_', '-', '.', ' '];

/// Returns the log of each topic: "log_7" for "log_7_rates" beside "log_8_rates". A topic name
/// begins at the first separator after which another name is the same; a topic found in one log
/// only belongs to the longest log name that its name begins with. Empty without a match.
fn logs_of(names: &[String]) -> Vec<String> {
    let parts = |name: &str| {
        name.match_indices(MARKS)
            .map(|(at, _)| at)
            .collect::<Vec<usize>>()
    };
    let mut ends: BTreeMap<&str, usize> = BTreeMap::new();
    for name in names {
        parts(name)
            .into_iter()
            .for_each(|at| *ends.entry(&name[at..]).or_default() += 1);
    }
    let log = |name: &String| {
        let at = parts(name)
            .into_iter()
            .find(|at| ends.get(&name[*at..]).is_some_and(|count| *count > 1));
        name[..at.unwrap_or(0)].to_owned()
    };
    let logs: Vec<String> = names.iter().map(log).collect();
    let is_log =
        |log: &&String| !log.is_empty() && logs.iter().filter(|other| other == log).count() > 1;
    let known: Vec<&String> = logs.iter().filter(is_log).collect();
    let of_topic = |(name, log): (&String, &String)| {
        let begins = |log: &&&String| {
            name.strip_prefix(log.as_str())
                .is_some_and(|rest| rest.starts_with(MARKS))
        };
        let own = || {
            known
                .iter()
                .filter(begins)
                .max_by_key(|log| log.len())
                .map(|log| (*log).clone())
        };
        if is_log(&log) {
            log.clone()
        } else {
            own().unwrap_or_default()
        }
    };
    names.iter().zip(&logs).map(of_topic).collect()
}

/// Returns the variable of a file, or the name of a file in a folder without its extension.
fn topic_name(table: &RecordTable, one_file: bool) -> String {
    let source = &table.source;
    let name = source
        .variable
        .as_deref()
        .filter(|_| one_file)
        .unwrap_or(&source.file);
    let name = name.rsplit('/').next().unwrap_or(name);
    // An extension has letters: the number in "motor.1" is not an extension.
    let stem = name
        .rsplit_once('.')
        .filter(|(_, ending)| ["csv", "txt", "tsv", "dat", "mat", "npz", "json"].contains(ending));
    stem.map_or(name, |(stem, _)| stem).to_owned()
}

/// Returns the number of bytes in the common prefix of all names, up to a separator: "log_3_2024_"
/// for "log_3_2024_q" and "log_3_2024_M".
fn common_prefix(names: &[String]) -> usize {
    let Some(first) = names.first().filter(|_| names.len() > 1) else {
        return 0;
    };
    let same = |name: &String| {
        first
            .bytes()
            .zip(name.bytes())
            .take_while(|(a, b)| a == b)
            .count()
    };
    let length = names.iter().skip(1).map(same).min().unwrap_or(0);
    first.as_bytes()[..length]
        .iter()
        .rposition(|byte| MARKS.contains(&char::from(*byte)))
        .map_or(0, |at| at + 1)
}

/// Returns the seconds per unit of the stamps, by the name of their column: topics of one log share
/// the unit, and only fast topics reveal it by their steps.
fn seconds_by_name(tables: &[RecordTable]) -> BTreeMap<String, f64> {
    let mut fastest: BTreeMap<String, (f64, f64)> = BTreeMap::new();
    for table in tables {
        let Some(column) = TimeBase::find(table) else {
            continue;
        };
        let (TimeBase::Column { seconds, .. }, _) = TimeBase::of_column(table, column) else {
            continue;
        };
        let stamps = &table.columns[column];
        let step = median_step(&stamps.values)
            .filter(|step| *step > 0.0)
            .unwrap_or(f64::INFINITY);
        let known = fastest
            .entry(stamps.name.clone())
            .or_insert((step, seconds));
        if step < known.0 {
            *known = (step, seconds);
        }
    }
    fastest
        .into_iter()
        .map(|(name, (_, seconds))| (name, seconds))
        .collect()
}

/// Returns the columns of a topic with its stamps; `None` without a source of sample times.
fn topic_columns(
    table: &RecordTable,
    name: &str,
    seconds: &BTreeMap<String, f64>,
) -> Option<Vec<RecordColumn>> {
    let (time_s, stamps) = match TimeBase::find(table) {
        Some(column) => {
            let seconds = *seconds.get(&table.columns[column].name)?;
            (
                TimeBase::Column { column, seconds }.times_s(table),
                Some(column),
            )
        }
        None => (
            TimeBase::SampleTime(table.sample_time_s?).times_s(table),
            None,
        ),
    };
    let clock = Arc::new(TopicClock {
        name: name.to_owned(),
        time_s,
    });
    let values: Vec<&RecordColumn> = table
        .columns
        .iter()
        .enumerate()
        .filter(|(index, _)| Some(*index) != stamps)
        .map(|(_, column)| column)
        .collect();
    let plain = |column: &RecordColumn| PLAIN.contains(&column.name.to_lowercase().as_str());
    let named = |column: &RecordColumn| {
        let numbered = column
            .name
            .rsplit_once('_')
            .filter(|(stem, _)| PLAIN.contains(&stem.to_lowercase().as_str()));
        match numbered {
            Some((_, number)) if number.parse::<usize>().is_ok() => format!("{name}.{number}"),
            _ if plain(column) && values.len() == 1 => name.to_owned(),
            _ => format!("{name}.{}", column.name),
        }
    };
    let columns = values.iter().map(|column| RecordColumn {
        name: named(column),
        topic: Some(Arc::clone(&clock)),
        ..(*column).clone()
    });
    Some(columns.collect())
}

/// Joins names, shortened to fit a message.
pub(super) fn shown(names: &[&str]) -> String {
    /// Sufficient to find the cause.
    const SHOWN: usize = 20;
    let more = names.len().saturating_sub(SHOWN);
    let names = names
        .iter()
        .take(SHOWN)
        .copied()
        .collect::<Vec<_>>()
        .join(", ");
    if more == 0 {
        names
    } else {
        format!("{names} and {more} more")
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::names::ChannelRule;

    use super::*;

    fn topic(file: &str, variable: Option<&str>, columns: &[&str], step: f64) -> RecordTable {
        let stamps: Vec<f64> = (0..500).map(|k| step * f64::from(k)).collect();
        let values = stamps.iter().map(|t| (3.0 * t).sin()).collect::<Vec<_>>();
        let columns = columns
            .iter()
            .map(|name| RecordColumn::new(*name, values.clone()));
        let columns = std::iter::once(RecordColumn::new("timestamp", stamps))
            .chain(columns)
            .collect();
        let source = RecordSource {
            file: file.to_owned(),
            variable: variable.map(str::to_owned),
            ..RecordSource::default()
        };
        RecordTable {
            source,
            ..RecordTable::new(file, columns)
        }
    }

    fn channels() -> RecordChannels {
        let rules = |names: &[&str]| names.iter().map(|name| ChannelRule::named(*name)).collect();
        RecordChannels {
            inputs: rules(&["M"]),
            outputs: rules(&["q"]),
            ..RecordChannels::default()
        }
    }

    fn names(table: &RecordTable) -> Vec<&str> {
        table
            .columns
            .iter()
            .map(|column| column.name.as_str())
            .collect()
    }

    #[test]
    fn structs_of_stamps_and_values_are_topics_of_one_record() {
        let tables = vec![
            topic("log.mat", Some("M"), &["value"], 0.004),
            topic("log.mat", Some("q"), &["value"], 0.01),
            topic("log.mat", Some("acc"), &["value_1", "value_2"], 0.004),
        ];
        let joined = with_topics_joined(tables, &channels(), &TimeWish::default());
        assert_eq!(joined.len(), 1);
        assert_eq!(names(&joined[0]), ["M", "q", "acc.1", "acc.2"]);
        assert_eq!(
            (
                joined[0].name.as_str(),
                joined[0].source.variable.as_deref()
            ),
            ("log", Some("its topics"))
        );
        assert_eq!(joined[0].columns[1].topic.as_ref().unwrap().time_s[1], 0.01);
    }

    #[test]
    fn a_table_for_each_topic_in_a_folder_is_one_record_in_the_unit_of_the_fastest_stamps() {
        let tables = vec![
            topic("fly/log_7_status.csv", None, &["armed"], 5e6),
            topic("fly/log_7_rates.csv", None, &["p", "q"], 1e4),
            topic("fly/log_7_torque.csv", None, &["M"], 2e4),
        ];
        let joined = with_topics_joined(tables, &channels(), &TimeWish::default());
        assert_eq!(
            names(&joined[0]),
            ["status.armed", "rates.p", "rates.q", "torque.M"]
        );
        assert_eq!(
            (joined[0].name.as_str(), joined[0].source.file.as_str()),
            ("fly", "fly")
        );
        assert_eq!(
            joined[0].columns[0].topic.as_ref().unwrap().time_s[1],
            5.0,
            "microseconds, as the fast ones tell"
        );
    }

    #[test]
    fn topics_of_several_logs_in_one_folder_are_a_record_of_each_log() {
        let of_log = |log: &str, more: &str| {
            let file = |topic: &str| format!("fly/{log}_{topic}.csv");
            vec![
                topic(&file("vehicle_rates_0"), None, &["p", "q"], 0.01),
                topic(&file("vehicle_torque_0"), None, &["M"], 0.02),
                topic(&file(more), None, &["state"], 1.0),
            ]
        };
        let tables = [
            of_log("12_30_05", "esc_status_0"),
            of_log("12_41_55", "vehicle_status_0"),
        ]
        .concat();
        let joined = with_topics_joined(tables.clone(), &channels(), &TimeWish::default());
        let found: Vec<&str> = joined.iter().map(|table| table.name.as_str()).collect();
        assert_eq!(found, ["12_30_05", "12_41_55"]);
        assert_eq!(
            names(&joined[0]),
            [
                "vehicle_rates_0.p",
                "vehicle_rates_0.q",
                "vehicle_torque_0.M",
                "esc_status_0.state"
            ]
        );
        for log in &joined {
            let again =
                RecordTable::of_topics_called(&tables, log.source.variable.as_deref().unwrap())
                    .unwrap();
            assert_eq!(&again, log, "a dataset finds each again by its name");
        }
        assert_eq!(
            RecordTable::of_topics_called(&tables, "its topics, 12_50_00"),
            None
        );
    }

    #[test]
    fn tables_side_by_side_are_topics_and_a_clock_of_another_origin_is_a_column() {
        let stamps = |rows: usize, step: f64, from: f64| {
            (0..60)
                .map(|k| {
                    if k < rows {
                        from + step * k as f64
                    } else {
                        f64::NAN
                    }
                })
                .collect::<Vec<f64>>()
        };
        let table = |second: Vec<f64>| {
            let names = ["time", "M", "time.1", "q"];
            let values = [
                stamps(60, 0.01, 0.0),
                stamps(60, 1.0, 0.0),
                second.clone(),
                second,
            ];
            let columns = names
                .into_iter()
                .zip(values)
                .map(|(name, values)| RecordColumn::new(name, values));
            RecordTable::new("log", columns.collect())
        };
        let apart = table(stamps(30, 0.02, 0.0)).side_by_side();
        assert_eq!(names(&apart), ["M", "q"]);
        assert_eq!(apart.columns[1].values.len(), 30);
        assert_eq!(apart.columns[1].topic.as_ref().unwrap().time_s[1], 0.02);
        assert_eq!(table(stamps(60, 0.01, 5e5)).side_by_side().columns.len(), 4);
    }

    #[test]
    fn records_that_have_every_channel_stay_records() {
        let tables = vec![
            topic("a.csv", None, &["M", "q"], 0.01),
            topic("b.csv", None, &["M", "q", "p"], 0.01),
        ];
        assert_eq!(
            with_topics_joined(tables.clone(), &channels(), &TimeWish::default()),
            tables
        );
        let lacking = vec![
            topic("a.csv", None, &["q", "p"], 0.01),
            topic("b.csv", None, &["q", "p"], 0.01),
        ];
        assert_eq!(
            with_topics_joined(lacking.clone(), &channels(), &TimeWish::default()),
            lacking
        );
    }
}
