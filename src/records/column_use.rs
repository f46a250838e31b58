//! Which column a channel is, and what its samples are multiplied by.

/// A column of a record that is a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColumnUse {
    /// Index of the column.
    pub column: usize,
    /// How many of the channel's units one of the column's is; negative where the sign is the other one.
    pub factor: f64,
}

impl ColumnUse {
    /// The column as it is.
    pub fn as_it_is(column: usize) -> Self {
        Self { column, factor: 1.0 }
    }
}
