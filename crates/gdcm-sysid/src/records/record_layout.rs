//! A record's columns, assigned to its time and channels.
//!
//! A *rule* ([`ChannelRule`]) describes a channel to read: its name and unit, and its names in
//! files. A *remedy* ([`ChannelRemedy`]) is a factor on a channel's samples and a delay to remove,
//! in one record.

use std::collections::BTreeMap;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::{ChannelRemedy, ConditionRecord};
use gdcm_model::names::channel_rule::ChannelRule;

use super::column_use::ColumnUse;
use super::record_channels::RecordChannels;
use super::record_guess::RecordGuess;
use super::record_table::RecordTable;
use super::time_base::TimeBase;

/// A record's columns, assigned to its time and channels; proposed by
/// [`RecordLayout::proposed`] and editable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordLayout {
    /// Source of the sample times; `None` if not yet chosen.
    pub time: Option<TimeBase>,
    /// A column for each input; `None` if not yet chosen.
    pub inputs: Vec<Option<ColumnUse>>,
    /// A column for each output; `None` if not yet chosen.
    pub outputs: Vec<Option<ColumnUse>>,
}

/// A channel with its column, if one is chosen.
pub(super) struct ChannelUse<'r> {
    pub(super) side: ChannelSide,
    pub(super) rule: &'r ChannelRule,
    pub(super) used: Option<ColumnUse>,
}

/// A channel with its chosen column.
#[derive(Clone, Copy)]
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

    /// Adds remedies to channels by name, in this record only, in addition to earlier remedies.
    pub fn add_remedies(
        &mut self,
        remedies: &BTreeMap<String, ChannelRemedy>,
        channels: &RecordChannels,
    ) {
        add_remedies(&mut self.inputs, &channels.inputs, remedies);
        add_remedies(&mut self.outputs, &channels.outputs, remedies);
    }

    /// Returns a channel's column for editing; `None` if none is chosen.
    pub fn channel_mut(&mut self, role: ChannelSide, index: usize) -> Option<&mut ColumnUse> {
        role.pick(&mut self.inputs, &mut self.outputs)
            .get_mut(index)?
            .as_mut()
    }

    /// Assumes its channel's unit for every column whose unit is open, so that the record can be
    /// used; the layout then has a caution.
    #[must_use]
    pub fn assuming_units_of_channels(&self) -> Self {
        let mut layout = self.clone();
        for used in layout.inputs.iter_mut().chain(&mut layout.outputs) {
            *used = used.map(ColumnUse::assuming_unit_of_channel);
        }
        layout
    }

    /// Returns the layout without the remedies, which belong to one record.
    #[must_use]
    pub fn without_remedies(&self) -> Self {
        let mut layout = self.clone();
        for used in layout.inputs.iter_mut().chain(&mut layout.outputs) {
            *used = used.map(ColumnUse::without_remedy);
        }
        layout
    }

    /// Confirms, for every column whose unit is open or assumed, that its samples are in its
    /// channel's unit.
    #[must_use]
    pub fn in_units_of_channels(&self) -> Self {
        let mut layout = self.clone();
        for used in layout.inputs.iter_mut().chain(&mut layout.outputs) {
            *used = used.map(ColumnUse::in_unit_of_channel);
        }
        layout
    }

    /// Creates the record's dataset entry: its location, hash, part and sample time, the remedies
    /// to store, and the manoeuvre and use for validation from `guess`.
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
