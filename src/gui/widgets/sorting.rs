//! Row order in a table: a click on a heading sorts by its column, numbers by value.

use std::cmp::Ordering;

use gdcm_model::number_format::NO_VALUE;
use gdcm_words::Table;

/// Row order; the default is the original order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sorting {
    key: Option<SortKey>,
}

/// Column by which a table is sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct SortKey {
    column: usize,
    is_descending: bool,
}

impl Sorting {
    /// Returns the order after a click on a column's heading: ascending, descending, original.
    pub fn clicked(self, column: usize) -> Self {
        let is_descending = match self.key {
            Some(key) if key.column == column && key.is_descending => return Self::default(),
            Some(key) => key.column == column,
            None => false,
        };
        Self {
            key: Some(SortKey {
                column,
                is_descending,
            }),
        }
    }

    /// Returns the sorted row indices: numbers by value, then text alphabetically; cells without a
    /// value last, in both directions. Equal rows keep their order.
    pub fn order(self, table: &Table) -> Vec<usize> {
        self.order_of(table.rows.len(), |row, column| {
            table.rows[row].get(column).cloned().unwrap_or_default()
        })
    }

    /// Like [`Self::order`], for `rows` rows and a function that returns the cell at a row and a
    /// column.
    pub fn order_of(self, rows: usize, cell: impl Fn(usize, usize) -> String) -> Vec<usize> {
        let mut order: Vec<usize> = (0..rows).collect();
        let Some(key) = self.key else {
            return order;
        };
        let mut cells = Vec::new();
        for row in 0..rows {
            cells.push(SortedCell::new(cell(row, key.column)));
        }
        order.sort_by(|a, b| {
            let a = &cells[*a];
            let b = &cells[*b];
            if !key.is_descending
                || matches!((a, b), (SortedCell::Missing, _) | (_, SortedCell::Missing))
            {
                a.compare(b)
            } else {
                b.compare(a)
            }
        });
        order
    }

    /// Returns the direction in which a column is sorted; `None` if the table is not sorted by it.
    pub fn direction(self, column: usize) -> Option<SortDirection> {
        match self.key {
            Some(key) if key.column == column && key.is_descending => {
                Some(SortDirection::Descending)
            }
            Some(key) if key.column == column => Some(SortDirection::Ascending),
            _ => None,
        }
    }

    /// Returns the sort mark in a column's heading; empty if the table is not sorted by it.
    pub fn mark(self, column: usize) -> &'static str {
        match self.direction(column) {
            Some(SortDirection::Descending) => " ▼",
            Some(SortDirection::Ascending) => " ▲",
            None => "",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SortDirection {
    Ascending,
    Descending,
}

/// Cell content by which the row is sorted.
enum SortedCell {
    Number(f64),
    Text(String),
    Missing,
}

impl SortedCell {
    fn new(cell: String) -> Self {
        if is_missing(&cell) {
            return Self::Missing;
        }
        match number_in(&cell) {
            Some(number) => Self::Number(number),
            None => Self::Text(cell),
        }
    }

    fn compare(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Number(own), Self::Number(others)) => own.total_cmp(others),
            (Self::Text(own), Self::Text(others)) => own.cmp(others),
            _ => self.rank().cmp(&other.rank()),
        }
    }

    fn rank(&self) -> u8 {
        match self {
            Self::Number(_) => 0,
            Self::Text(_) => 1,
            Self::Missing => 2,
        }
    }
}

/// Returns whether a cell is empty or holds only a dash.
pub(super) fn is_missing(cell: &str) -> bool {
    matches!(cell.trim(), "" | "-" | NO_VALUE | "—")
}

/// Parses the number at the beginning of a cell, with either minus sign and possibly in brackets.
pub(super) fn number_in(cell: &str) -> Option<f64> {
    cell.split_whitespace()
        .next()?
        .trim_start_matches('(')
        .trim_end_matches(')')
        .replacen('\u{2212}', "-", 1)
        .parse()
        .ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new("t", ["name", "value"]);
        for (name, value) in [("b", "10"), ("a", "\u{2212}2.5"), ("c", ""), ("d", "9")] {
            table.row([name, value]);
        }
        table
    }

    #[test]
    fn numbers_are_sorted_by_value_and_words_by_letters() {
        let by_name = Sorting::default().clicked(0);
        let by_value = Sorting::default().clicked(1);
        assert_eq!(by_value.order(&table()), [1, 3, 0, 2], "empty cells last");
        let falling = by_value.clicked(1);
        assert_eq!(falling.order(&table()), [0, 3, 1, 2], "downwards too");
        assert_eq!(by_name.order(&table()), [1, 0, 2, 3]);
    }

    #[test]
    fn numbers_come_before_words_and_missing_values_last_in_both_directions() {
        let mut table = Table::new("t", ["value"]);
        for value in ["–", "9.5 s", "word", "-", "\u{2212}3", "10", "—"] {
            table.row([value]);
        }
        let rising = Sorting::default().clicked(0);
        assert_eq!(rising.order(&table), [4, 1, 5, 2, 0, 3, 6]);
        assert_eq!(rising.clicked(0).order(&table), [2, 5, 1, 4, 0, 3, 6]);
    }

    #[test]
    fn the_third_click_on_a_heading_leaves_the_table_as_it_was_made() {
        let sorting = Sorting::default().clicked(1).clicked(1).clicked(1);
        assert_eq!(sorting.order(&table()), [0, 1, 2, 3]);
        assert_eq!(
            Sorting::default().clicked(0).clicked(1),
            Sorting::default().clicked(1)
        );
    }
}
