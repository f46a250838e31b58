//! Joins topic tables into one record: their columns side by side, each with its topic's stamps.
//!
//! A *topic* is a group of columns in a log that share stamps of their own; here each has a table.
//! A table's name becomes part of its column names. A dataset keeps the joined record's name, from
//! which it is joined again.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_model::number_format::counted;

use super::record_table::{RecordColumn, RecordSource, RecordTable, TopicClock, shortened_list};
use super::sample_step::median_step;
use super::time_base::TimeBase;
use super::topic_names::{are_from_one_file, common_prefix, logs_of_topics, topic_names};

/// Uninformative names for a topic's only value column.
const PLAIN: [&str; 8] = [
    "value", "values", "data", "signal", "signals", "x", "y", "val",
];

impl RecordTable {
    /// Name for the record that all topics in a file or folder form together.
    pub const TOPICS: &'static str = "its topics";

    /// Returns the record that topics form under this name: all as [`Self::TOPICS`], or the topics
    /// in one log as "its topics, log_7"; `None` for other names.
    pub fn of_topics_called(tables: &[RecordTable], variable: &str) -> Option<RecordTable> {
        if variable == Self::TOPICS {
            return Some(join_topics(tables));
        }
        let log = variable.strip_prefix(Self::TOPICS)?.strip_prefix(", ")?;
        let mut topics = Vec::new();
        for (table, own_log) in tables.iter().zip(logs_of_topics(&topic_names(tables))) {
            if own_log == log {
                topics.push(table.clone());
            }
        }
        if topics.is_empty() {
            return None;
        }
        Some(join_topics_of_log(&topics, log))
    }
}

/// Combines a log's topics side by side, in a record named after the log.
pub(super) fn join_topics_of_log(tables: &[RecordTable], log: &str) -> RecordTable {
    let mut joined = join_topics(tables);
    joined.name = log.to_owned();
    joined.source.variable = Some(format!("{}, {log}", RecordTable::TOPICS));
    joined
}

/// Combines a record's topics side by side.
///
/// ```text
/// 1  topic names, from variables or files (topic_names), less their common beginning
/// 2  seconds per stamp unit, by the stamp column's name: from the fastest topic
/// 3  each table's columns, with the topic's name and stamps; a table without a time is omitted
/// 4  notes on the topics that are joined and omitted
/// ```
pub(super) fn join_topics(tables: &[RecordTable]) -> RecordTable {
    let source = common_source(tables);
    let mut joined = RecordTable {
        source,
        ..RecordTable::new(common_name(tables), Vec::new())
    };
    // Steps 1 and 2.
    let names = topic_names(tables);
    let prefix = common_prefix(&names);
    let seconds = seconds_by_name(tables);
    // Step 3.
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
    // Step 4.
    joined.notes.push(format!(
        "one record from {}: {}",
        counted(taken.len(), "topic"),
        shortened_list(&taken)
    ));
    if !left_out.is_empty() {
        joined.notes.push(format!(
            "topics left out, because they have no time: {}",
            shortened_list(&left_out)
        ));
    }
    joined
}

/// Returns the topics' file or folder, as their record's source.
fn common_source(tables: &[RecordTable]) -> RecordSource {
    let mut source = RecordSource {
        variable: Some(RecordTable::TOPICS.to_owned()),
        ..RecordSource::default()
    };
    if let Some(first) = tables.first() {
        source.file = common_file(tables).to_owned();
        if are_from_one_file(tables) {
            source.sha256 = first.source.sha256.clone();
        }
    }
    source
}

/// Returns the path to the topics' file, or to their folder.
fn common_file(tables: &[RecordTable]) -> &str {
    let Some(first) = tables.first() else {
        return "";
    };
    let file = first.source.file.as_str();
    if are_from_one_file(tables) {
        return file;
    }
    match file.rsplit_once('/') {
        Some((folder, _)) => folder,
        None => "",
    }
}

/// Returns the topics' file name without its extension, or their folder's name; "topics" if there
/// is none.
fn common_name(tables: &[RecordTable]) -> &str {
    let file = common_file(tables);
    let mut name = file.rsplit('/').next().unwrap_or_default();
    if are_from_one_file(tables)
        && let Some((stem, _)) = name.rsplit_once('.')
    {
        name = stem;
    }
    if name.is_empty() { "topics" } else { name }
}

/// Returns the seconds per stamp unit, by column name (step 2). A log's topics share the unit,
/// which only the fast topics' short steps reveal.
fn seconds_by_name(tables: &[RecordTable]) -> BTreeMap<String, f64> {
    struct Fastest {
        step: f64,
        seconds: f64,
    }
    let mut fastest: BTreeMap<String, Fastest> = BTreeMap::new();
    for table in tables {
        let Some(column) = TimeBase::find(table) else {
            continue;
        };
        let TimeBase::Column { seconds, .. } = TimeBase::from_column(table, column) else {
            continue;
        };
        let stamps = &table.columns[column];
        let step = median_step(&stamps.values)
            .filter(|step| *step > 0.0)
            .unwrap_or(f64::INFINITY);
        let known = fastest
            .entry(stamps.name.clone())
            .or_insert(Fastest { step, seconds });
        if step < known.step {
            *known = Fastest { step, seconds };
        }
    }
    fastest
        .into_iter()
        .map(|(name, fastest)| (name, fastest.seconds))
        .collect()
}

/// Returns a topic's columns with its stamps (step 3); `None` without sample times.
fn topic_columns(
    table: &RecordTable,
    name: &str,
    seconds: &BTreeMap<String, f64>,
) -> Option<Vec<RecordColumn>> {
    let stamps = TimeBase::find(table);
    let time = match stamps {
        Some(column) => TimeBase::Column {
            column,
            seconds: *seconds.get(&table.columns[column].name)?,
        },
        None => TimeBase::SampleTime(table.sample_time_s?),
    };
    let clock = Arc::new(TopicClock {
        name: name.to_owned(),
        time_s: time.times_s(table),
    });
    let is_single = table.columns.len() - usize::from(stamps.is_some()) == 1;
    let mut columns = Vec::new();
    for (index, column) in table.columns.iter().enumerate() {
        if Some(index) != stamps {
            columns.push(RecordColumn {
                name: column_name(name, &column.name, is_single),
                topic: Some(Arc::clone(&clock)),
                ..column.clone()
            });
        }
    }
    Some(columns)
}

/// Names a topic's column: "acc.1" for "value_1", the topic's name for a single "value", else
/// "acc.x".
fn column_name(topic: &str, column: &str, is_single: bool) -> String {
    if let Some((stem, number)) = column.rsplit_once('_')
        && is_plain(stem)
        && number.parse::<usize>().is_ok()
    {
        return format!("{topic}.{number}");
    }
    if is_single && is_plain(column) {
        topic.to_owned()
    } else {
        format!("{topic}.{column}")
    }
}

/// Returns whether a name is in [`PLAIN`], ignoring case.
fn is_plain(name: &str) -> bool {
    PLAIN.contains(&name.to_lowercase().as_str())
}
