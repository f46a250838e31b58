//! Finds tables that are topics of one record: a file or struct per topic.
//!
//! A table with a column for every channel is a record. Tables that each lack some channels but
//! together have all of them are a log's topics, each with separate stamps; `topic_join` makes one
//! record of them.

use std::collections::BTreeMap;

use super::layout_problem::LayoutProblem;
use super::layout_proposal::TimeSettings;
use super::record_channels::RecordChannels;
use super::record_layout::RecordLayout;
use super::record_table::RecordTable;
use super::topic_join::{join_topics, join_topics_of_log};
use super::topic_names::{log_key, logs_of_topics, topic_names};

/// Combines tables that are topics of one record: in each file or folder, tables that each lack a
/// channel but together have all of them. If they come from several logs, so that channels have
/// several columns, each log is combined separately. Other tables are unchanged.
pub fn with_topics_joined(
    tables: Vec<RecordTable>,
    channels: &RecordChannels,
    time: &TimeSettings,
) -> Vec<RecordTable> {
    let mut joiner = TopicJoiner {
        is_joined: vec![false; tables.len()],
        joined: BTreeMap::new(),
        tables: &tables,
        channels,
        time,
    };
    for group in joiner.groups_of_topics() {
        joiner.join_group(&group);
    }
    let TopicJoiner {
        is_joined,
        mut joined,
        ..
    } = joiner;
    let mut found = Vec::new();
    for (index, table) in tables.into_iter().enumerate() {
        if is_joined[index] {
            found.extend(joined.remove(&index));
        } else {
            found.push(table);
        }
    }
    found
}

/// Joins topics among tables.
struct TopicJoiner<'r> {
    tables: &'r [RecordTable],
    channels: &'r RecordChannels,
    time: &'r TimeSettings,
    /// Whether each table is part of a joined record.
    is_joined: Vec<bool>,
    /// Joined records, by the index of their first topic.
    joined: BTreeMap<usize, RecordTable>,
}

impl TopicJoiner<'_> {
    /// Returns the tables that lack a channel, by file or folder; groups with a single table are
    /// omitted.
    fn groups_of_topics(&self) -> Vec<Vec<usize>> {
        let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (index, table) in self.tables.iter().enumerate() {
            if self.lacks_channels(table) {
                let key = log_key(&table.source);
                groups.entry(key).or_default().push(index);
            }
        }
        groups
            .into_values()
            .filter(|group| group.len() > 1)
            .collect()
    }

    /// Returns whether a channel has no column, or several candidate columns, as in a table joined
    /// from several logs.
    fn lacks_channels(&self, table: &RecordTable) -> bool {
        let proposal = RecordLayout::proposed(table, self.channels, self.time);
        proposal.problems.iter().any(|problem| {
            matches!(
                problem,
                LayoutProblem::NoColumn { .. }
                    | LayoutProblem::SeveralColumns { .. }
                    | LayoutProblem::Unnamed { .. }
            )
        })
    }

    /// Joins a group into one record or, if that would not be complete, each log's topics into a
    /// record.
    fn join_group(&mut self, group: &[usize]) {
        let topics = self.tables_at(group);
        if self.keep_if_complete(group, join_topics(&topics)) {
            return;
        }
        let mut logs: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (index, log) in group.iter().zip(logs_of_topics(&topic_names(&topics))) {
            logs.entry(log).or_default().push(*index);
        }
        for (log, group) in logs {
            if !log.is_empty() && group.len() > 1 {
                let joined = join_topics_of_log(&self.tables_at(&group), &log);
                self.keep_if_complete(&group, joined);
            }
        }
    }

    fn tables_at(&self, indices: &[usize]) -> Vec<RecordTable> {
        let mut tables = Vec::with_capacity(indices.len());
        for index in indices {
            tables.push(self.tables[*index].clone());
        }
        tables
    }

    /// Keeps a group's record if it has all channels; returns whether it was kept.
    fn keep_if_complete(&mut self, group: &[usize], joined: RecordTable) -> bool {
        if joined.columns.is_empty() || self.lacks_channels(&joined) {
            return false;
        }
        for index in group {
            self.is_joined[*index] = true;
        }
        self.joined.insert(group[0], joined);
        true
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::names::ChannelRule;

    use super::*;
    use crate::records::record_table::RecordColumn;

    fn topic(file: &str, variable: Option<&str>, columns: &[&str], step: f64) -> RecordTable {
        let stamps: Vec<f64> = (0..500).map(|k| step * f64::from(k)).collect();
        let values = stamps.iter().map(|t| (3.0 * t).sin()).collect::<Vec<_>>();
        let mut table = RecordTable::new(file, vec![RecordColumn::new("timestamp", stamps)]);
        for name in columns {
            table.columns.push(RecordColumn::new(*name, values.clone()));
        }
        table.source.file = file.to_owned();
        table.source.variable = variable.map(str::to_owned);
        table
    }

    fn channels() -> RecordChannels {
        RecordChannels {
            inputs: vec![ChannelRule::named("M")],
            outputs: vec![ChannelRule::named("q")],
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
        let joined = with_topics_joined(tables, &channels(), &TimeSettings::default());
        assert_eq!(joined.len(), 1);
        assert_eq!(names(&joined[0]), ["M", "q", "acc.1", "acc.2"]);
        assert_eq!(joined[0].name, "log");
        assert_eq!(joined[0].source.variable.as_deref(), Some("its topics"));
        assert_eq!(joined[0].columns[1].topic.as_ref().unwrap().time_s[1], 0.01);
    }

    #[test]
    fn a_table_for_each_topic_in_a_folder_is_one_record_in_the_unit_of_the_fastest_stamps() {
        let tables = vec![
            topic("fly/log_7_status.csv", None, &["armed"], 5e6),
            topic("fly/log_7_rates.csv", None, &["p", "q"], 1e4),
            topic("fly/log_7_torque.csv", None, &["M"], 2e4),
        ];
        let joined = with_topics_joined(tables, &channels(), &TimeSettings::default());
        assert_eq!(
            names(&joined[0]),
            ["status.armed", "rates.p", "rates.q", "torque.M"]
        );
        assert_eq!(joined[0].name, "fly");
        assert_eq!(joined[0].source.file, "fly");
        assert_eq!(
            joined[0].columns[0].topic.as_ref().unwrap().time_s[1],
            5.0,
            "microseconds, by the steps of the fast topics"
        );
    }

    #[test]
    fn topics_of_several_logs_in_one_folder_are_a_record_of_each_log() {
        let tables = vec![
            topic("fly/12_30_05_vehicle_rates_0.csv", None, &["p", "q"], 0.01),
            topic("fly/12_30_05_vehicle_torque_0.csv", None, &["M"], 0.02),
            topic("fly/12_30_05_esc_status_0.csv", None, &["state"], 1.0),
            topic("fly/12_41_55_vehicle_rates_0.csv", None, &["p", "q"], 0.01),
            topic("fly/12_41_55_vehicle_torque_0.csv", None, &["M"], 0.02),
            topic("fly/12_41_55_vehicle_status_0.csv", None, &["state"], 1.0),
        ];
        let joined = with_topics_joined(tables.clone(), &channels(), &TimeSettings::default());
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
            let variable = log.source.variable.as_deref().unwrap();
            let again = RecordTable::of_topics_called(&tables, variable).unwrap();
            assert_eq!(&again, log, "by the name that a dataset keeps");
        }
        assert_eq!(
            RecordTable::of_topics_called(&tables, "its topics, 12_50_00"),
            None
        );
    }

    #[test]
    fn records_that_have_every_channel_stay_records() {
        let tables = vec![
            topic("a.csv", None, &["M", "q"], 0.01),
            topic("b.csv", None, &["M", "q", "p"], 0.01),
        ];
        assert_eq!(
            with_topics_joined(tables.clone(), &channels(), &TimeSettings::default()),
            tables
        );
        let lacking = vec![
            topic("a.csv", None, &["q", "p"], 0.01),
            topic("b.csv", None, &["q", "p"], 0.01),
        ];
        assert_eq!(
            with_topics_joined(lacking.clone(), &channels(), &TimeSettings::default()),
            lacking
        );
    }
}
