//! Takes channel units from the first record's columns.

use gdcm_model::dataset::channel::ChannelSide;

use super::column_use::ColumnUse;
use super::record_channels::{DeclaredConversion, RecordChannels};
use super::record_layout::RecordLayout;
use super::record_table::RecordTable;

impl RecordChannels {
    /// Gives channels without a unit their column's unit in this layout, so that further records
    /// are converted to it.
    pub fn take_units(&mut self, layout: &RecordLayout, table: &RecordTable) {
        for side in [ChannelSide::Input, ChannelSide::Output] {
            let rules = side.pick(&mut self.inputs, &mut self.outputs);
            let uses = side.pick(&layout.inputs, &layout.outputs);
            for (rule, used) in rules.iter_mut().zip(uses) {
                if rule.unit.is_empty() {
                    let conversion = self.declared.get(&rule.name);
                    rule.unit = unit_of_samples(conversion, *used, table).unwrap_or_default();
                }
            }
        }
    }
}

/// Returns the unit in which a channel's samples are: given by the user, or else by the file;
/// `None` if unknown, as after a user-defined factor other than ±1.
fn unit_of_samples(
    conversion: Option<&DeclaredConversion>,
    used: Option<ColumnUse>,
    table: &RecordTable,
) -> Option<String> {
    match conversion {
        Some(DeclaredConversion::Unit(unit)) => Some(unit.clone()),
        Some(DeclaredConversion::Factor(factor)) if factor.abs() != 1.0 => None,
        _ => table.columns.get(used?.column)?.unit.clone(),
    }
}
