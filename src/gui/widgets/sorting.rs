//! Order of the rows of a table: a click on a heading sorts by its column, numbers by value.

use gdcm_words::Table;

/// Order of a table's rows; the default is the original order.
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

    /// Returns the sorted row indices: numbers by value, text alphabetically, empty cells last.
    /// Equal rows keep their order.
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
        let cells: Vec<String> = order.iter().map(|&row| cell(row, key.column)).collect();
        order.sort_by(|a, b| {
            let a = &cells[*a];
            let b = &cells[*b];
            let compared = match (number_in(a), number_in(b)) {
                (Some(a), Some(b)) => a.total_cmp(&b),
                _ => a.cmp(b),
            };
            let compared = if key.is_descending {
                compared.reverse()
            } else {
                compared
            };
            a.is_empty().cmp(&b.is_empty()).then(compared)
        });
        order
    }

    /// Returns the sort mark in the heading of a column.
    pub fn mark(self, column: usize) -> &'static str {
        match self.key {
            Some(key) if key.column == column && key.is_descending => " ▼",
            Some(key) if key.column == column => " ▲",
            _ => "",
        }
    }
}

/// Parses the number at the beginning of a cell, with either minus sign.
pub(super) fn number_in(cell: &str) -> Option<f64> {
    cell.split_whitespace()
        .next()?
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
    fn the_third_click_on_a_heading_leaves_the_table_as_it_was_made() {
        let sorting = Sorting::default().clicked(1).clicked(1).clicked(1);
        assert_eq!(sorting.order(&table()), [0, 1, 2, 3]);
        assert_eq!(
            Sorting::default().clicked(0).clicked(1),
            Sorting::default().clicked(1)
        );
    }
}
