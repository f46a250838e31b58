//! Printed text: labelled lines, lists and tables.

use std::path::PathBuf;

use gdcm_model::message_text::{sanitized, sanitized_path, shortened, shortened_message};
use gdcm_model::number_format::NO_VALUE;
use gdcm_words::Table;

/// Maximum line width, in columns.
const PAGE_WIDTH: usize = 110;

/// Label width, in columns.
const LABEL_WIDTH: usize = 14;

/// Indentation within a section, in columns.
const DETAIL_INDENT: usize = 2;

/// A label at the left of wrapped text.
#[derive(Clone, Copy)]
struct Label<'a> {
    text: &'a str,
    /// Columns to the left of the label.
    indent: usize,
}

impl<'a> Label<'a> {
    fn of_section(text: &'a str) -> Self {
        Self { text, indent: 0 }
    }

    fn of_detail(text: &'a str) -> Self {
        Self {
            text,
            indent: DETAIL_INDENT,
        }
    }

    /// Returns the label, padded to the column where the text begins.
    fn padded(self) -> String {
        let Self { text, indent } = self;
        let width = LABEL_WIDTH - indent;
        format!("{:indent$}{text:<width$}", "")
    }

    /// Returns the label followed by `words`, wrapped at [`PAGE_WIDTH`] columns and aligned.
    fn before(self, words: &str) -> String {
        self.before_pieces(shortened_message(words).split(' '))
    }

    /// Returns the label followed by pieces of text; lines break only between pieces.
    fn before_pieces<'p>(self, pieces: impl Iterator<Item = &'p str>) -> String {
        let mut text = self.padded();
        let start = text.chars().count();
        let mut column = start;
        for piece in pieces {
            let length = piece.chars().count();
            if column > start && column + 1 + length > PAGE_WIDTH {
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
}

/// Returns text with a section's label, wrapped at [`PAGE_WIDTH`] columns.
pub(super) fn line(label: &str, words: &str) -> String {
    Label::of_section(label).before(words)
}

/// Returns the line for a caution, without control characters.
pub(super) fn caution_line(words: &str) -> String {
    line("Caution", &sanitized(words))
}

/// Returns indented, labelled text within a section, wrapped at [`PAGE_WIDTH`] columns.
pub(super) fn detail(label: &str, words: &str) -> String {
    Label::of_detail(label).before(words)
}

/// Returns a comma-separated list within a section, wrapped between entries; "none" if empty.
pub(super) fn detail_list(label: &str, entries: &[String]) -> String {
    let Some((last, others)) = entries.split_last() else {
        return detail(label, "none");
    };
    let mut pieces: Vec<String> = Vec::with_capacity(entries.len());
    for entry in others {
        pieces.push(format!("{},", shortened_message(entry)));
    }
    pieces.push(shortened_message(last));
    Label::of_detail(label).before_pieces(pieces.iter().map(String::as_str))
}

/// Formats a table as lines indented by `indent` spaces; shortens long cells.
pub(super) fn indented(table: &Table, indent: usize) -> String {
    let mut table = table.clone();
    for cell in table.rows.iter_mut().flatten() {
        *cell = shortened(cell);
    }
    table
        .text()
        .lines()
        .map(|line| format!("{:indent$}{line}\n", ""))
        .collect()
}

/// Formats a table without its title, for use below a heading.
pub(super) fn indented_untitled(table: Table) -> String {
    let table = Table {
        title: String::new(),
        ..table
    };
    indented(&table, DETAIL_INDENT)
}

/// Formats a number with `digits` decimals, or with an exponent if its magnitude is 1e7 or larger;
/// "–" for `None`.
pub(super) fn fixed_digits(value: Option<f64>, digits: usize) -> String {
    let Some(value) = value else {
        return NO_VALUE.to_owned();
    };
    if value.abs() >= 1e7 || value.is_nan() {
        return format!("{value:.digits$e}");
    }
    // Adding zero turns a rounded minus zero into zero.
    let scale = 10_f64.powi(digits as i32);
    let rounded = (value * scale).round() / scale + 0.0;
    format!("{rounded:.digits$}")
}

/// Formats a number with `digits` decimals; a dash for `None`.
pub(super) fn decimals_or_dash(value: Option<f64>, digits: usize) -> String {
    match value {
        Some(value) => format!("{value:.digits$}"),
        None => NO_VALUE.to_owned(),
    }
}

/// Joins paths with commas.
pub(super) fn listed_paths(paths: &[PathBuf]) -> String {
    let paths: Vec<String> = paths.iter().map(|path| sanitized_path(path)).collect();
    paths.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_words_hang_under_their_start() {
        let text = detail("rejected", &"model ".repeat(40));
        assert!(text.lines().all(|line| line.chars().count() <= PAGE_WIDTH));
        for line in text.lines().skip(1) {
            assert!(line.starts_with(&" ".repeat(LABEL_WIDTH)), "{line}");
            assert_eq!(line.chars().nth(LABEL_WIDTH), Some('m'), "{line}");
        }
        assert_eq!(text.matches("model").count(), 40);
    }

    #[test]
    fn a_list_wraps_between_its_entries() {
        let entries = ["a b".to_owned(), "c".to_owned()];
        assert_eq!(detail_list("gains", &entries), "  gains       a b, c\n");
        assert_eq!(detail_list("gains", &[]), "  gains       none\n");
    }
}
