//! The channels that records are to give.

use crate::assembly::ChannelRule;
use crate::dataset::{Channel, Dataset};

use super::record_layout::RecordLayout;
use super::record_table::RecordTable;

/// Inputs and outputs that records are to give. A channel without a unit is taken in that of the file; one with other names is looked for
/// by these alone.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordChannels {
    /// Inputs, in order.
    pub inputs: Vec<ChannelRule>,
    /// Outputs, in order.
    pub outputs: Vec<ChannelRule>,
}

impl RecordChannels {
    /// The channels of a dataset, in its units; a file that does not say a unit is taken to have the dataset's.
    pub fn of_dataset(dataset: &Dataset) -> Self {
        let rule = |channel: &Channel| ChannelRule {
            unit: channel.unit.clone(),
            unit_in_files: Some(channel.unit.clone()),
            ..ChannelRule::named(channel.name.clone())
        };
        Self {
            inputs: dataset.inputs().iter().map(rule).collect(),
            outputs: dataset.outputs().iter().map(rule).collect(),
        }
    }

    /// Gives channels without a unit that of the column that this layout takes for them, so that further records are converted.
    pub fn take_units(&mut self, layout: &RecordLayout, table: &RecordTable) {
        let sides = [(&mut self.inputs, &layout.inputs), (&mut self.outputs, &layout.outputs)];
        for (rules, uses) in sides {
            for (rule, used) in rules.iter_mut().zip(uses).filter(|(rule, _)| rule.unit.is_empty()) {
                let unit = used.and_then(|used| table.columns.get(used.column)?.unit.clone()).unwrap_or_default();
                rule.unit_in_files = Some(unit.clone()).filter(|unit| !unit.is_empty());
                rule.unit = unit;
            }
        }
    }
}
