//! Place of a column in a table.

use std::fmt::{Display, Formatter, Result};

/// Column of a table by its number and its heading, displayed as `column 2 ("Q")`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnPlace {
    /// Column number, from 1.
    pub number: usize,
    /// Name in the heading; `None` without one.
    pub name: Option<String>,
}

impl Display for ColumnPlace {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        match &self.name {
            Some(name) => write!(out, "column {} (\"{name}\")", self.number),
            None => write!(out, "column {}", self.number),
        }
    }
}
