//! Transfers a layout, the user's edits or remedies to another record.
//!
//! Columns are matched by name. A *remedy* ([`ChannelRemedy`]) is a factor on a channel's samples
//! and a delay to remove, in one record only.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::ChannelRemedy;

use super::column_use::ColumnUse;
use super::record_layout::RecordLayout;
use super::record_table::RecordTable;
use super::time_base::TimeBase;

impl RecordLayout {
    /// Returns this layout for the record `from` with the same columns, by name, in the record
    /// `other`; `None` if that lacks a column.
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

    /// Applies the changes between two layouts for `from` to this layout for `table`, channel by
    /// channel: transfers the user's edits to another record with the same column names.
    ///
    /// A channel whose column was removed by the user, or is missing in this record, keeps its own
    /// column. This record's remedies do not change either, because remedies belong to one record.
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
                let unedited = before.get(index).copied().flatten();
                let Some(edited) = after.get(index).copied().flatten() else {
                    // The user removed the column.
                    continue;
                };
                let is_unchanged =
                    unedited.map(ColumnUse::without_remedy) == Some(edited.without_remedy());
                if is_unchanged {
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

    /// Copies each channel's remedy from `other`.
    #[must_use]
    pub fn with_remedies_of(mut self, other: &Self) -> Self {
        copy_remedies(&mut self.inputs, &other.inputs);
        copy_remedies(&mut self.outputs, &other.outputs);
        self
    }
}

fn copy_remedies(uses: &mut [Option<ColumnUse>], others: &[Option<ColumnUse>]) {
    for (used, other) in uses.iter_mut().zip(others) {
        if let (Some(used), Some(other)) = (used, other) {
            used.remedy = other.remedy;
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
    use crate::records::column_use::UnitBasis;
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
            unit: UnitBasis::Open,
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
        assert_eq!(edited.unit, UnitBasis::Known);
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
