//! Names for topics and their logs, from file and variable names.
//!
//! A *topic* is a group of columns that share stamps of their own, and a *log* is the record that
//! its topics form together. Here each topic is a file or a variable.

use std::collections::BTreeMap;

use super::record_table::{RecordSource, RecordTable};

/// Separators between words in a name.
const SEPARATORS: [char; 4] = ['_', '-', '.', ' '];
/// File extensions that are removed from names. The digit in "motor.1" is not an extension.
const EXTENSIONS: [&str; 7] = ["csv", "txt", "tsv", "dat", "mat", "npz", "json"];

/// Returns the key that all topics in a log share: their file if they are variables in it,
/// otherwise their folder.
pub(super) fn log_key(source: &RecordSource) -> String {
    if source.variable.is_some() {
        return source.file.clone();
    }
    match source.file.rsplit_once('/') {
        Some((folder, _)) => format!("{folder}/"),
        None => String::new(),
    }
}

/// Names each topic: by its variable if all topics come from one file, otherwise by its file name
/// without extension.
pub(super) fn topic_names(tables: &[RecordTable]) -> Vec<String> {
    let is_one_file = are_from_one_file(tables);
    tables
        .iter()
        .map(|table| topic_name(&table.source, is_one_file))
        .collect()
}

/// Returns whether all tables come from the first table's file.
pub(super) fn are_from_one_file(tables: &[RecordTable]) -> bool {
    tables
        .iter()
        .all(|table| table.source.file == tables[0].source.file)
}

fn topic_name(source: &RecordSource, is_one_file: bool) -> String {
    let mut name = source.file.as_str();
    if let Some(variable) = &source.variable
        && is_one_file
    {
        name = variable;
    }
    let name = name.rsplit('/').next().unwrap_or(name);
    match name.rsplit_once('.') {
        Some((stem, ending)) if EXTENSIONS.contains(&ending) => stem.to_owned(),
        _ => name.to_owned(),
    }
}

/// Returns each topic's log: "log_7" for "log_7_rates" next to "log_8_rates"; empty without a log.
///
/// ```text
/// names log_7_rates, log_7_pos, log_8_rates
/// 1  a topic begins at the first separator after which two names agree: "_rates" in log_7_rates
///    and log_8_rates;  the text before it is the log: log_7, log_8; none for log_7_pos
/// 2  a log is confirmed if several topics have it
/// 3  a topic without a confirmed log belongs to the longest confirmed log that begins its name
/// ```
pub(super) fn logs_of_topics(names: &[String]) -> Vec<String> {
    let logs = logs_by_shared_endings(names);
    let confirmed: Vec<&String> = logs.iter().filter(|log| is_confirmed(log, &logs)).collect();
    let mut found = Vec::with_capacity(names.len());
    for (name, log) in names.iter().zip(&logs) {
        let log = if is_confirmed(log, &logs) {
            log.clone()
        } else {
            longest_log_of(name, &confirmed)
        };
        found.push(log);
    }
    found
}

/// Returns the text before each name's shared ending (step 1).
fn logs_by_shared_endings(names: &[String]) -> Vec<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for name in names {
        for (at, _) in name.match_indices(SEPARATORS) {
            *counts.entry(&name[at..]).or_default() += 1;
        }
    }
    let mut logs = Vec::with_capacity(names.len());
    for name in names {
        let shared = name
            .match_indices(SEPARATORS)
            .map(|(at, _)| at)
            .find(|at| counts.get(&name[*at..]).is_some_and(|count| *count > 1));
        logs.push(name[..shared.unwrap_or(0)].to_owned());
    }
    logs
}

/// Returns whether several topics have this log.
fn is_confirmed(log: &str, logs: &[String]) -> bool {
    !log.is_empty() && logs.iter().filter(|other| *other == log).count() > 1
}

/// Returns the longest log name that begins `name` and ends at a separator; empty if there is none.
fn longest_log_of(name: &str, logs: &[&String]) -> String {
    let mut longest = "";
    for log in logs {
        let begins = name
            .strip_prefix(log.as_str())
            .is_some_and(|rest| rest.starts_with(SEPARATORS));
        if begins && log.len() >= longest.len() {
            longest = log;
        }
    }
    longest.to_owned()
}

/// Returns the length in bytes of the names' common prefix, including its last separator:
/// "log_3_2024_" for "log_3_2024_q" and "log_3_2024_M".
pub(super) fn common_prefix(names: &[String]) -> usize {
    let Some((first, rest)) = names.split_first() else {
        return 0;
    };
    if rest.is_empty() {
        return 0;
    }
    let length = rest
        .iter()
        .map(|name| common_bytes(first, name))
        .min()
        .unwrap_or(0);
    let last_separator = first.as_bytes()[..length]
        .iter()
        .rposition(|byte| SEPARATORS.contains(&char::from(*byte)));
    match last_separator {
        Some(at) => at + 1,
        None => 0,
    }
}

/// Counts the bytes with which two names begin alike.
fn common_bytes(first: &str, second: &str) -> usize {
    let pairs = first.bytes().zip(second.bytes());
    pairs.take_while(|(a, b)| a == b).count()
}
