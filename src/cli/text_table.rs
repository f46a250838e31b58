//! Aligned columns of text.

/// Which side of its column a cell stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Words.
    Left,
    /// Figures.
    Right,
}

/// Rows of cells, printed in columns as wide as their widest cell.
pub(super) struct TextTable<const COLUMNS: usize> {
    sides: [Side; COLUMNS],
    rows: Vec<[String; COLUMNS]>,
}

impl<const COLUMNS: usize> TextTable<COLUMNS> {
    /// A table with a heading and no rows.
    pub(super) fn new(columns: [(&str, Side); COLUMNS]) -> Self {
        Self { sides: columns.map(|(_, side)| side), rows: vec![columns.map(|(heading, _)| heading.to_owned())] }
    }

    /// Adds a row.
    pub(super) fn row(&mut self, cells: [String; COLUMNS]) {
        self.rows.push(cells);
    }

    /// The table as lines, each behind `indent` spaces, with no spaces at their ends.
    pub(super) fn lines(&self, indent: usize) -> String {
        let width = |column: usize| self.rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: [usize; COLUMNS] = std::array::from_fn(width);
        let mut lines = String::new();
        for row in &self.rows {
            let cells = row.iter().zip(widths).zip(self.sides).map(|((cell, width), side)| match side {
                Side::Left => format!("{cell:<width$}"),
                Side::Right => format!("{cell:>width$}"),
            });
            let line = format!("{:indent$}{}", "", cells.collect::<Vec<_>>().join("  "));
            lines.push_str(line.trim_end());
            lines.push('\n');
        }
        lines
    }
}

/// Most columns of a page.
pub(super) const PAGE: usize = 110;

/// Words behind a label, broken between words into lines of at most [`PAGE`] columns that stand under one another.
pub(super) fn labelled(indent: usize, label: &str, width: usize, words: &str) -> String {
    hanging(indent, label, width, words.split(' '))
}

/// A list behind a label, with commas, broken between its entries.
pub(super) fn listed(indent: usize, label: &str, width: usize, entries: &[String]) -> String {
    let last = entries.len().saturating_sub(1);
    let with_comma = |(index, entry): (usize, &String)| {
        if index < last { format!("{entry},") } else { entry.clone() }
    };
    let entries: Vec<String> = entries.iter().enumerate().map(with_comma).collect();
    hanging(indent, label, width, entries.iter().map(String::as_str))
}

fn hanging<'w>(indent: usize, label: &str, width: usize, pieces: impl Iterator<Item = &'w str>) -> String {
    let mut text = format!("{:indent$}{label:<width$}", "");
    let start = text.chars().count();
    let mut column = start;
    for piece in pieces {
        let length = piece.chars().count();
        if column > start && column + 1 + length > PAGE {
            text.push_str(&format!("\n{:start$}", ""));
            column = start;
        }
        if column > start {
            text.push(' ');
            column += 1;
        }
        text.push_str(piece);
        column += length;
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_stand_under_one_another() {
        let mut table = TextTable::new([("response", Side::Left), ("G", Side::Right)]);
        table.row(["LON → Q".to_owned(), "1.346".to_owned()]);
        table.row(["COL → NZ".to_owned(), "-".to_owned()]);
        assert_eq!(table.lines(2), "  response      G\n  LON → Q   1.346\n  COL → NZ      -\n");
    }

    #[test]
    fn long_words_hang_under_their_start() {
        let text = labelled(2, "rejected", 10, &"model ".repeat(40));
        assert!(text.lines().all(|line| line.chars().count() <= PAGE));
        assert!(
            text.lines().skip(1).all(|line| line.starts_with(&" ".repeat(12)) && line.chars().nth(12) == Some('m'))
        );
        assert_eq!(text.matches("model").count(), 40);
    }
}
