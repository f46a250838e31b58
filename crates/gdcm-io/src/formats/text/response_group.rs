//! Groups of table columns that belong to the same frequency response.
//!
//! Columns belong together if their names give the same label, which is the output and the input; a
//! column without a label belongs with the columns before it. A group has at most one column for
//! each quantity: a second one begins another group.

use crate::formats::text::quantity_words::Quantity;
use crate::formats::text::response_label::ResponseLabel;

/// Columns that belong to the same response.
pub(super) struct ResponseGroup {
    pub(super) label: ResponseLabel,
    pub(super) columns: Vec<GroupColumn>,
}

/// Column that holds a response quantity.
pub(super) struct GroupColumn {
    pub(super) quantity: Quantity,
    /// Column index, from 0.
    pub(super) column: usize,
}

/// Indices of the magnitude and phase columns.
#[derive(Clone, Copy)]
pub(super) struct PolarColumns {
    pub(super) magnitude: usize,
    pub(super) phase: usize,
}

impl ResponseGroup {
    /// Adds a column to the group to which it belongs, or begins a group with it. `groups` are those
    /// of the columns before it, `label` is its own.
    pub(super) fn add_column(groups: &mut Vec<Self>, column: GroupColumn, label: &ResponseLabel) {
        match group_of(groups, column.quantity, label) {
            Some(index) => groups[index].columns.push(column),
            None => groups.push(Self {
                label: label.clone(),
                columns: vec![column],
            }),
        }
    }

    /// Returns the index of the column that holds a quantity.
    pub(super) fn column(&self, quantity: Quantity) -> Option<usize> {
        let found = self
            .columns
            .iter()
            .find(|member| member.quantity == quantity);
        found.map(|member| member.column)
    }

    /// Returns magnitude and phase; `None` unless both are present.
    pub(super) fn polar_columns(&self) -> Option<PolarColumns> {
        Some(PolarColumns {
            magnitude: self.column(Quantity::Magnitude)?,
            phase: self.column(Quantity::Phase)?,
        })
    }
}

/// Returns the index of the group to which a column belongs, among the groups that do not have the
/// quantity yet: first the last group, if the column has no label or holds an error; else the last
/// group with the same label; else `None`.
fn group_of(groups: &[ResponseGroup], quantity: Quantity, label: &ResponseLabel) -> Option<usize> {
    // An error column's label names a quantity, not a channel, so the column joins the last group.
    let joins_last = *label == ResponseLabel::default() || quantity == Quantity::Error;
    if joins_last
        && let Some(last) = groups.last()
        && last.column(quantity).is_none()
    {
        return Some(groups.len() - 1);
    }
    groups
        .iter()
        .rposition(|group| group.label == *label && group.column(quantity).is_none())
}
