//! Groups of records with the same columns: columns and units are set once for each group, over all
//! conditions.
//!
//! A layout ([`RecordLayout`]) assigns a record's columns to the channels. A remedy corrects a
//! channel in a single record (M14.16: docs/identification.md). A part is a time span of a record,
//! used instead of the whole.

use std::collections::BTreeSet;

use gdcm_model::dataset::ConditionId;
use gdcm_sysid::records::layout_problem::LayoutCaution;
use gdcm_sysid::records::{LaidOutRecord, LayoutProblem, RecordLayout};

use super::records::RecordsState;

/// Records with the same columns, assigned to the channels in the same way.
#[derive(Clone, Debug)]
pub struct ColumnGroup {
    /// Column names in the files.
    pub columns: Vec<String>,
    /// Assignment to the channels, without the remedies that belong to single records.
    layout: RecordLayout,
    /// Number of whole records.
    pub records: usize,
    /// Conditions to which these records belong; records without a condition add none.
    pub conditions: BTreeSet<ConditionId>,
    /// Record to show first: the first with a problem or an assumed unit, otherwise the first.
    /// `None` if no record in the group has a condition.
    pub first: Option<RecordPlace>,
    /// Whether `first` has a problem or an assumed unit.
    is_first_doubtful: bool,
    /// Problems in the first record that cannot be used; empty if all can.
    pub problems: Vec<LayoutProblem>,
    /// Names of the channels with assumed units.
    pub assumed: Vec<String>,
}

/// Position in the record lists: the condition, and the index in its list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordPlace {
    pub condition: ConditionId,
    pub row: usize,
}

/// Channels with assumed units, over all conditions' records.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AssumedUnits {
    /// Channel names.
    pub channels: Vec<String>,
    /// Number of affected records, without parts.
    pub records: usize,
    /// Number of affected conditions.
    pub conditions: usize,
    /// The first affected record.
    pub first: Option<RecordPlace>,
}

impl ColumnGroup {
    fn new(record: &LaidOutRecord, columns: Vec<String>, layout: RecordLayout) -> Self {
        Self {
            columns,
            layout,
            records: 0,
            conditions: BTreeSet::new(),
            first: None,
            is_first_doubtful: false,
            problems: record.problems.clone(),
            assumed: Vec::new(),
        }
    }

    /// Returns whether a record has these columns, assigned in the same way.
    fn contains(&self, record: &LaidOutRecord) -> bool {
        self.columns.len() == record.table.columns.len()
            && self
                .columns
                .iter()
                .zip(&record.table.columns)
                .all(|(name, column)| *name == column.name)
            && self.layout == record.layout.without_remedies()
    }

    /// Adds a record to the group; `place` is `None` for a record without a condition, which cannot
    /// be shown.
    fn add(&mut self, record: &LaidOutRecord, place: Option<RecordPlace>) {
        self.records += 1;
        if self.problems.is_empty() {
            self.problems.clone_from(&record.problems);
        }
        let assumed = assumed_channels(record);
        let is_doubtful = !record.problems.is_empty() || !assumed.is_empty();
        for channel in assumed {
            if !self.assumed.contains(&channel) {
                self.assumed.push(channel);
            }
        }
        let Some(place) = place else {
            return;
        };
        self.conditions.insert(place.condition);
        if self.first.is_none() || (is_doubtful && !self.is_first_doubtful) {
            self.first = Some(place);
            self.is_first_doubtful = is_doubtful;
        }
    }
}

impl RecordsState {
    /// Returns the groups of records with the same columns, the largest first. Parts are not
    /// counted: they have their record's columns.
    pub fn column_groups(&self) -> Vec<ColumnGroup> {
        let mut groups: Vec<ColumnGroup> = Vec::new();
        for (condition, records) in &self.conditions {
            for (row, record) in records.rows.iter().enumerate() {
                if record.table.part_s.is_none() {
                    let place = RecordPlace {
                        condition: *condition,
                        row,
                    };
                    add_to_group(&mut groups, record, Some(place));
                }
            }
        }
        for record in &self.unassigned {
            add_to_group(&mut groups, record, None);
        }
        groups.sort_by_key(|group| std::cmp::Reverse(group.records));
        groups
    }

    /// Returns a record's group; `None` without such a record.
    pub fn group_of(&self, place: RecordPlace) -> Option<ColumnGroup> {
        let record = self.conditions.get(&place.condition)?.rows.get(place.row)?;
        let groups = self.column_groups();
        groups.into_iter().find(|group| group.contains(record))
    }

    /// Returns the channels with assumed units; `None` if no unit is an assumption.
    pub fn assumed_units(&self) -> Option<AssumedUnits> {
        let mut units = AssumedUnits::default();
        for (condition, records) in &self.conditions {
            let before = units.records;
            for (row, record) in records.rows.iter().enumerate() {
                let channels = assumed_channels(record);
                if channels.is_empty() || record.table.part_s.is_some() {
                    continue;
                }
                units.records += 1;
                units.first.get_or_insert(RecordPlace {
                    condition: *condition,
                    row,
                });
                for channel in channels {
                    if !units.channels.contains(&channel) {
                        units.channels.push(channel);
                    }
                }
            }
            if units.records > before {
                units.conditions += 1;
            }
        }
        if units.records == 0 {
            return None;
        }
        Some(units)
    }
}

fn add_to_group(groups: &mut Vec<ColumnGroup>, record: &LaidOutRecord, place: Option<RecordPlace>) {
    for group in &mut *groups {
        if group.contains(record) {
            group.add(record, place);
            return;
        }
    }
    let mut columns = Vec::new();
    for column in &record.table.columns {
        columns.push(column.name.clone());
    }
    let layout = record.layout.without_remedies();
    let mut group = ColumnGroup::new(record, columns, layout);
    group.add(record, place);
    groups.push(group);
}

/// Returns the names of the channels whose unit is an assumption.
fn assumed_channels(record: &LaidOutRecord) -> Vec<String> {
    let mut channels = Vec::new();
    for caution in &record.cautions {
        if let LayoutCaution::UnitAssumed { channel, .. } = caution {
            channels.push(channel.clone());
        }
    }
    channels
}
