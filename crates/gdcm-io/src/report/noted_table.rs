//! Tables that fit a page: long texts that several rows share become notes, and empty columns are
//! left out.

use gdcm_words::Table;

use super::wording::MISSING;

/// Number of characters above which a text that several rows repeat becomes a note.
const LONG: usize = 18;
/// Maximum number of notes below a table.
const MOST_NOTES: usize = 8;

/// A table with its repeated long texts moved into notes, and without empty columns.
pub(super) struct NotedTable {
    pub(super) table: Table,
    /// Notes in the form "a: text."
    pub(super) notes: Vec<String>,
}

impl NotedTable {
    /// Replaces the long texts that several rows share in a column, at most [`MOST_NOTES`], by
    /// letters, and explains each letter in a note. Long texts in a narrow column would make the
    /// table several times as long.
    pub(super) fn new(table: &Table) -> Self {
        let mut noted = Self {
            table: without_empty_columns(table),
            notes: Vec::new(),
        };
        for column in 0..noted.table.columns.len() {
            noted.move_texts(column);
        }
        noted
    }

    fn move_texts(&mut self, column: usize) {
        let mut repeated: Vec<String> = Vec::new();
        for (row, cells) in self.table.rows.iter().enumerate() {
            let text = &cells[column];
            let is_long = text.chars().count() > LONG;
            let later = &self.table.rows[row + 1..];
            let is_repeated = later.iter().any(|cells| cells[column] == *text);
            if is_long && is_repeated && !repeated.contains(text) {
                repeated.push(text.clone());
            }
        }
        for text in repeated {
            if self.notes.len() == MOST_NOTES {
                return;
            }
            let letter = char::from(b'a' + self.notes.len() as u8).to_string();
            for cells in &mut self.table.rows {
                if cells[column] == text {
                    cells[column].clone_from(&letter);
                }
            }
            self.notes.push(format!("{letter}: {text}."));
        }
    }
}

/// Returns the table without the columns in which every cell is empty or missing. A table that
/// would keep fewer than two columns is unchanged.
fn without_empty_columns(table: &Table) -> Table {
    let mut kept = Vec::new();
    for column in 0..table.columns.len() {
        let is_empty = table
            .rows
            .iter()
            .all(|cells| cells[column].is_empty() || cells[column] == MISSING);
        if !is_empty {
            kept.push(column);
        }
    }
    if kept.len() < 2 {
        return table.clone();
    }
    let mut columns = Vec::with_capacity(kept.len());
    for &column in &kept {
        columns.push(table.columns[column].clone());
    }
    let mut filled = Table::new(table.title.clone(), columns);
    for cells in &table.rows {
        let mut row = Vec::with_capacity(kept.len());
        for &column in &kept {
            row.push(cells[column].clone());
        }
        filled.rows.push(row);
    }
    filled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_of_several_rows_becomes_a_note_and_an_empty_column_is_left_out() {
        let long = "identification part from the band of the model";
        let mut table = Table::new("bars", ["response", "note", "J", "remark"]);
        table.row(["LAT → P", "", "1", long]);
        table.row(["LON → Q", "", "2", "short"]);
        table.row(["PED → R", MISSING, "3", long]);
        table.row(["COL → NZ", "", "4", "a long text that stands alone"]);
        let noted = NotedTable::new(&table);
        assert_eq!(noted.table.columns, ["response", "J", "remark"]);
        let remarks: Vec<&str> = noted.table.rows.iter().map(|row| row[2].as_str()).collect();
        assert_eq!(
            remarks,
            ["a", "short", "a", "a long text that stands alone"]
        );
        assert_eq!(noted.notes, [format!("a: {long}.")]);
    }
}
