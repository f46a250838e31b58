//! A table of what was found, to be read, copied and saved: the same texts wherever it goes.

/// Rows of texts under headings. Headings name quantity and unit (`airspeed [kt]`), so that a table can stand alone.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// What it is a table of, in words.
    pub title: String,
    /// The heading of each column, with its unit.
    pub columns: Vec<String>,
    /// The rows, with one cell for each column; a cell without a value is empty.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new(title: impl Into<String>, columns: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self { title: title.into(), columns: columns.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Adds a row; cells beyond the last column are left out, missing ones are empty.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        let mut cells: Vec<String> = cells.into_iter().map(Into::into).collect();
        cells.resize(self.columns.len(), String::new());
        self.rows.push(cells);
    }

    /// The table as text of equally wide letters: the title, the headings, a line for each row. Columns of figures are aligned at
    /// the right, others at the left; no line ends in spaces.
    pub fn text(&self) -> String {
        let records = || std::iter::once(&self.columns).chain(&self.rows);
        let cells_of = |column: usize| records().map(move |record| record[column].as_str());
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|column| cells_of(column).map(|cell| cell.chars().count()).max().unwrap_or(0))
            .collect();
        let figures: Vec<bool> = (0..self.columns.len()).map(|column| self.has_figures(column)).collect();
        let mut text = if self.title.is_empty() { String::new() } else { format!("{}\n", self.title) };
        for record in records() {
            let cells = record.iter().zip(&widths).zip(&figures).map(|((cell, &width), figures)| {
                if *figures { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
            });
            text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
            text.push('\n');
        }
        text
    }

    /// Whether every cell of a column that is not empty is a figure, and there is one.
    pub fn has_figures(&self, column: usize) -> bool {
        let mut cells = self.rows.iter().map(|row| row[column].as_str()).filter(|cell| !cell.is_empty()).peekable();
        cells.peek().is_some() && cells.all(is_figure)
    }
}

/// Whether a text is a number, with whichever minus sign, or the dash that stands for none.
fn is_figure(cell: &str) -> bool {
    cell == "–" || cell == "—" || cell.replacen('\u{2212}', "-", 1).parse::<f64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stand_at_the_left_and_figures_at_the_right() {
        let mut table = Table::new("Condition 3", ["response", "G [-]", "D [ms]"]);
        table.row(["LON → Q", "1.346", "−12.5"]);
        table.row(["COL → NZ", "0.9", ""]);
        assert_eq!(table.text(), "Condition 3\nresponse  G [-]  D [ms]\nLON → Q   1.346   −12.5\nCOL → NZ    0.9\n");
    }

    #[test]
    fn a_column_without_figures_is_one_of_words() {
        let mut table = Table::new("", ["a", "b"]);
        table.row(["", "1"]);
        table.row(["", "two"]);
        assert_eq!(table.text(), "a  b\n   1\n   two\n");
    }

    #[test]
    fn a_row_has_as_many_cells_as_there_are_columns() {
        let mut table = Table::new("", ["a", "b"]);
        table.row(["1"]);
        table.row(["1", "2", "3"]);
        assert_eq!(table.rows, [["1", ""], ["1", "2"]]);
    }
}
