//! A table of strings, and its format as monospaced text. The window, the report and CSV files
//! format its cells themselves.

use gdcm_model::units::without_sign_of_zero;

/// A table with a title and headings; all cells are strings. Headings name quantity and unit
/// (`airspeed [kt]`), so that a table is self-contained.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    pub title: String,
    /// Column headings, with units.
    pub columns: Vec<String>,
    /// The rows, with one cell for each column; a cell without a value is empty.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates a table without rows.
    pub fn new(
        title: impl Into<String>,
        columns: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        Self {
            title: title.into(),
            columns: columns.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row. Cells beyond the last column are dropped, missing cells are empty, and a zero
    /// loses its minus sign.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        let mut cells: Vec<String> = cells
            .into_iter()
            .map(|cell| unsigned_zero(cell.into()))
            .collect();
        cells.resize(self.columns.len(), String::new());
        self.rows.push(cells);
    }

    /// Formats the table as monospaced text: the title, the headings, a line for each row. Numeric
    /// columns are right-aligned, others left-aligned; no line ends in spaces.
    pub fn text(&self) -> String {
        let columns: Vec<TextColumn> = (0..self.columns.len())
            .map(|column| TextColumn {
                width: self.width(column),
                is_numeric: self.has_numbers(column),
            })
            .collect();
        let mut text = String::new();
        if !self.title.is_empty() {
            text.push_str(&self.title);
            text.push('\n');
        }
        for record in std::iter::once(&self.columns).chain(&self.rows) {
            let cells: Vec<String> = record
                .iter()
                .zip(&columns)
                .map(|(cell, column)| column.aligned(cell))
                .collect();
            text.push_str(cells.join("  ").trim_end());
            text.push('\n');
        }
        text
    }

    /// Returns a column's width in characters, including its heading.
    fn width(&self, column: usize) -> usize {
        std::iter::once(&self.columns)
            .chain(&self.rows)
            .map(|record| record[column].chars().count())
            .max()
            .unwrap_or(0)
    }

    /// Returns whether a column has nonempty cells, all of which are numbers.
    pub fn has_numbers(&self, column: usize) -> bool {
        let cells: Vec<&str> = self
            .rows
            .iter()
            .map(|row| row[column].as_str())
            .filter(|cell| !cell.is_empty())
            .collect();
        !cells.is_empty() && cells.into_iter().all(is_number)
    }
}

/// A column in a table formatted as text.
struct TextColumn {
    /// Width in characters.
    width: usize,
    /// Whether the cells are right-aligned.
    is_numeric: bool,
}

impl TextColumn {
    /// Pads a cell to the column's width.
    fn aligned(&self, cell: &str) -> String {
        // Padded by hand, because a width in a format string is limited to 65535.
        let padding = " ".repeat(self.width - cell.chars().count());
        if self.is_numeric {
            format!("{padding}{cell}")
        } else {
            format!("{cell}{padding}")
        }
    }
}

/// Returns the cell, without its sign if it is a zero.
fn unsigned_zero(cell: String) -> String {
    let unsigned = without_sign_of_zero(&cell);
    if unsigned.len() == cell.len() {
        cell
    } else {
        unsigned.to_owned()
    }
}

/// Returns whether a string is a number with optional minus sign and unit, or the dash for a
/// missing value.
fn is_number(cell: &str) -> bool {
    let mut words = cell.split(' ');
    let number = words
        .next()
        .unwrap_or_default()
        .replacen('\u{2212}', "-", 1);
    matches!(cell, "–" | "—" | "-") || (words.count() < 2 && number.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_has_no_sign() {
        let mut table = Table::new("", ["a", "b", "c"]);
        table.row(["-0.0", "−0.00", "-0.01"]);
        assert_eq!(table.rows, [["0.0", "0.00", "-0.01"]]);
    }

    #[test]
    fn words_stand_at_the_left_and_figures_at_the_right() {
        let mut table = Table::new("Condition 3", ["response", "G [-]", "D [ms]"]);
        table.row(["LON → Q", "1.346", "−12.5"]);
        table.row(["COL → NZ", "0.9", ""]);
        assert_eq!(
            table.text(),
            "Condition 3\nresponse  G [-]  D [ms]\nLON → Q   1.346   −12.5\nCOL → NZ    0.9\n"
        );
    }

    #[test]
    fn a_column_without_figures_is_one_of_words() {
        let mut table = Table::new("", ["a", "b"]);
        table.row(["", "1"]);
        table.row(["", "two"]);
        assert_eq!(table.text(), "a  b\n   1\n   two\n");
    }

    #[test]
    fn numbers_with_units_are_numbers_and_counts_of_others_are_words() {
        assert!(["120 kt", "−1.5", "-", "–"].into_iter().all(is_number));
        assert!(
            ["3 of 4", "V+5kt", "kt", ""]
                .into_iter()
                .all(|words| !is_number(words))
        );
    }

    #[test]
    fn a_row_has_as_many_cells_as_there_are_columns() {
        let mut table = Table::new("", ["a", "b"]);
        table.row(["1"]);
        table.row(["1", "2", "3"]);
        assert_eq!(table.rows, [["1", ""], ["1", "2"]]);
    }
}
