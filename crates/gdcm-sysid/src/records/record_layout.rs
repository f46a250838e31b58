//! A record's columns, assigned to its time and channels.

use std::collections::BTreeMap;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::{ChannelRemedy, ConditionRecord};
use gdcm_model::names::channel_rule::ChannelRule;

use super::column_use::ColumnUse;
use super::record_channels::{RecordChannels, SaidConversion};
use super::record_guess::RecordGuess;
use super::record_table::RecordTable;
use super::time_base::TimeBase;

/// A record's columns, assigned to its time and channels; proposed by
/// [`RecordLayout::proposed`] and editable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordLayout {
    /// Sample times; `None` while open.
    pub time: Option<TimeBase>,
    /// A column for each input; `None` while open.
    pub inputs: Vec<Option<ColumnUse>>,
    /// A column for each output; `None` while open.
    pub outputs: Vec<Option<ColumnUse>>,
}

/// A channel with its column, if one is chosen.
pub(super) struct ChannelUse<'r> {
    pub(super) side: ChannelSide,
    pub(super) rule: &'r ChannelRule,
    pub(super) used: Option<ColumnUse>,
}

/// A channel with its chosen column.
pub(super) struct ChosenColumn<'r> {
    pub(super) rule: &'r ChannelRule,
    pub(super) used: ColumnUse,
}

impl RecordLayout {
    /// Returns every channel with its column, inputs first.
    pub(super) fn uses<'r>(&self, channels: &'r RecordChannels) -> Vec<ChannelUse<'r>> {
        let mut found = Vec::new();
        for side in [ChannelSide::Input, ChannelSide::Output] {
            let uses = side.pick(&self.inputs, &self.outputs);
            let rules = side.pick(&channels.inputs, &channels.outputs);
            for (index, rule) in rules.iter().enumerate() {
                let used = uses.get(index).copied().flatten();
                found.push(ChannelUse { side, rule, used });
            }
        }
        found
    }

    /// Returns the channels for which a column is chosen, inputs first.
    pub(super) fn chosen<'r>(&self, channels: &'r RecordChannels) -> Vec<ChosenColumn<'r>> {
        let mut chosen = Vec::new();
        for ChannelUse { rule, used, .. } in self.uses(channels) {
            if let Some(used) = used {
                chosen.push(ChosenColumn { rule, used });
            }
        }
        chosen
    }

    /// Returns the stamp column, if the time comes from a column.
    pub(super) fn time_column(&self) -> Option<usize> {
        match self.time {
            Some(TimeBase::Column { column, .. }) => Some(column),
            _ => None,
        }
    }

    /// Copies each channel's remedy from `other`.
    #[must_use]
    pub fn with_remedies_of(mut self, other: &Self) -> Self {
        copy_remedies(&mut self.inputs, &other.inputs);
        copy_remedies(&mut self.outputs, &other.outputs);
        self
    }

    /// Adds remedies to channels by name, in this record only, in addition to earlier remedies.
    pub fn put_right(
        &mut self,
        remedies: &BTreeMap<String, ChannelRemedy>,
        channels: &RecordChannels,
    ) {
        add_remedies(&mut self.inputs, &channels.inputs, remedies);
        add_remedies(&mut self.outputs, &channels.outputs, remedies);
    }

    /// Returns the column of a channel for editing.
    pub fn channel_mut(&mut self, role: ChannelSide, index: usize) -> Option<&mut ColumnUse> {
        role.pick(&mut self.inputs, &mut self.outputs)
            .get_mut(index)?
            .as_mut()
    }

    /// Applies the changes between two layouts of `from` to this layout of `table`, channel by
    /// channel: transfers the user's edits to another record with the same column names. Remedies,
    /// which belong to one record, are not changed.
    #[must_use]
    pub fn following(
        &self,
        table: &RecordTable,
        [before, after]: [&Self; 2],
        from: &RecordTable,
    ) -> Self {
        let mut layout = self.clone();
        if before.time != after.time {
            layout.time = match after.time {
                Some(base @ TimeBase::Column { .. }) => {
                    time_in_other(base, from, table).or(self.time)
                }
                other => other,
            };
        }
        for side in [ChannelSide::Input, ChannelSide::Output] {
            let uses = side.pick(&mut layout.inputs, &mut layout.outputs);
            let before = side.pick(&before.inputs, &before.outputs);
            let after = side.pick(&after.inputs, &after.outputs);
            for (index, own) in uses.iter_mut().enumerate() {
                let earlier = before.get(index).copied().flatten();
                let Some(edited) = after.get(index).copied().flatten() else {
                    continue;
                };
                if earlier.map(ColumnUse::without_remedy) == Some(edited.without_remedy()) {
                    continue;
                }
                if let Some(column) = column_in_other(edited.column, from, table) {
                    let remedy = own.map_or(ChannelRemedy::NONE, |own| own.remedy);
                    *own = Some(ColumnUse {
                        column,
                        remedy,
                        ..edited
                    });
                }
            }
        }
        layout
    }

    /// Treats the samples of every open column as values in the unit of its channel.
    #[must_use]
    pub fn in_units_of_channels(&self) -> Self {
        let mut layout = self.clone();
        for used in layout.inputs.iter_mut().chain(&mut layout.outputs) {
            *used = used.map(ColumnUse::in_unit_of_channel);
        }
        layout
    }

    /// Returns the layout with the same columns, by name, in another record; `None` if a column is
    /// missing there.
    pub fn carried_to(&self, other: &RecordTable, from: &RecordTable) -> Option<Self> {
        let mut layout = self.clone();
        if let Some(time) = self.time {
            layout.time = Some(time_in_other(time, from, other)?);
        }
        let uses = layout.inputs.iter_mut().chain(&mut layout.outputs);
        for used in uses.flatten() {
            used.column = column_in_other(used.column, from, other)?;
        }
        Some(layout)
    }

    /// Creates the record's dataset entry: its location, and the information in its name.
    pub fn condition_record(
        &self,
        table: &RecordTable,
        guess: &RecordGuess,
        channels: &RecordChannels,
    ) -> ConditionRecord {
        let mut remedies = BTreeMap::new();
        for ChosenColumn { rule, used } in self.chosen(channels) {
            let remedy = used.kept_remedy(table, rule);
            if remedy != ChannelRemedy::NONE {
                remedies.insert(rule.name.clone(), remedy);
            }
        }
        let step_s = self.time.and_then(|time| time.step_s(table));
        ConditionRecord {
            remedies,
            variable: table.source.variable.clone(),
            sha256: Some(table.source.sha256.clone()).filter(|hash| !hash.is_empty()),
            kind: guess.kind,
            held_out: guess.held_out,
            part_s: table.part_s,
            sample_time_s: step_s.filter(|step_s| *step_s > 0.0),
            ..ConditionRecord::new(table.name.clone(), table.source.file.clone())
        }
    }
}

impl RecordChannels {
    /// Gives channels without a unit the unit of their column in this layout, so that further
    /// records are converted to it.
    pub fn take_units(&mut self, layout: &RecordLayout, table: &RecordTable) {
        for side in [ChannelSide::Input, ChannelSide::Output] {
            let rules = side.pick(&mut self.inputs, &mut self.outputs);
            let uses = side.pick(&layout.inputs, &layout.outputs);
            for (rule, used) in rules.iter_mut().zip(uses) {
                if rule.unit.is_empty() {
                    let conversion = self.said.get(&rule.name);
                    rule.unit = unit_of_samples(conversion, *used, table).unwrap_or_default();
                }
            }
        }
    }
}

/// Returns the unit of a channel's samples: given by the user, or else by the file; `None` if
/// unknown, as after a user-defined factor other than ±1.
fn unit_of_samples(
    conversion: Option<&SaidConversion>,
    used: Option<ColumnUse>,
    table: &RecordTable,
) -> Option<String> {
    match conversion {
        Some(SaidConversion::Unit(unit)) => Some(unit.clone()),
        Some(SaidConversion::Factor(factor)) if factor.abs() != 1.0 => None,
        _ => table.columns.get(used?.column)?.unit.clone(),
    }
}

fn copy_remedies(uses: &mut [Option<ColumnUse>], others: &[Option<ColumnUse>]) {
    for (used, other) in uses.iter_mut().zip(others) {
        if let (Some(used), Some(other)) = (used, other) {
            used.remedy = other.remedy;
        }
    }
}

fn add_remedies(
    uses: &mut [Option<ColumnUse>],
    rules: &[ChannelRule],
    remedies: &BTreeMap<String, ChannelRemedy>,
) {
    for (used, rule) in uses.iter_mut().zip(rules) {
        if let (Some(used), Some(remedy)) = (used, remedies.get(&rule.name)) {
            used.remedy = used.remedy.then(*remedy);
        }
    }
}

/// Returns the time base for another record, with the column matched by name; `None` if there is no
/// such column.
fn time_in_other(time: TimeBase, from: &RecordTable, other: &RecordTable) -> Option<TimeBase> {
    match time {
        TimeBase::Column { column, seconds } => Some(TimeBase::Column {
            column: column_in_other(column, from, other)?,
            seconds,
        }),
        TimeBase::SampleTime(_) | TimeBase::Topics => Some(time),
    }
}

/// Returns the index of a column in another record, by name; the same index if the names agree.
fn column_in_other(column: usize, from: &RecordTable, other: &RecordTable) -> Option<usize> {
    let name = &from.columns.get(column)?.name;
    match other.columns.get(column) {
        Some(same) if same.name == *name => Some(column),
        _ => other.find(name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::record_table::RecordColumn;

    fn table(names: &[&str]) -> RecordTable {
        let columns = names
            .iter()
            .map(|name| RecordColumn::new(*name, vec![0.0, 1.0, 2.0]))
            .collect();
        RecordTable::new("record", columns)
    }

    fn time(column: usize) -> Option<TimeBase> {
        Some(TimeBase::Column {
            column,
            seconds: 1.0,
        })
    }

    fn open(column: usize) -> Option<ColumnUse> {
        Some(ColumnUse {
            is_unit_open: true,
            ..ColumnUse::as_it_is(column)
        })
    }

    #[test]
    fn an_edit_of_one_channel_follows_in_other_records_and_leaves_their_other_channels() {
        let from = table(&["t", "P", "Q"]);
        let other = table(&["Q", "t", "P"]);
        let before = RecordLayout {
            time: time(0),
            inputs: Vec::new(),
            outputs: vec![open(1), open(2)],
        };
        let mut after = before.clone();
        after.outputs[0] = before.outputs[0].map(|used| used.in_unit("rad/s", "deg/s"));
        let remedy = ChannelRemedy {
            delay_s: 0.1,
            ..ChannelRemedy::NONE
        };
        let own = ColumnUse {
            remedy,
            ..ColumnUse::as_it_is(2)
        };
        let layout = RecordLayout {
            time: time(1),
            inputs: Vec::new(),
            outputs: vec![Some(own), open(0)],
        };
        let found = layout.following(&other, [&before, &after], &from);
        let edited = found.outputs[0].unwrap();
        assert_eq!(edited.column, 2, "by name");
        assert!(!edited.is_unit_open);
        assert_eq!(edited.remedy, remedy, "kept");
        assert!((edited.factor - 180.0 / std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(found.outputs[1], layout.outputs[1]);
        assert_eq!(found.time, layout.time);
        let without = table(&["t", "Q"]);
        assert_eq!(
            before.following(&without, [&before, &after], &from),
            before,
            "no such column"
        );
    }
}
