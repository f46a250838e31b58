//! Splits a heading into a cell for each column.
//!
//! A heading may have another separator than the numbers below it, and blanks within its names. At
//! most two cells more than there are columns are taken, which suffices to detect that a line has
//! too many.

use crate::formats::text::cell_number::has_number;
use crate::formats::text::layout::Layout;
use crate::formats::text::lines::{NumberedLine, comment};
use crate::formats::text::separator::Separator;

/// Splits a heading into a cell for each column, in the first of these ways that gives a heading;
/// `None` if none does:
///
/// 1. at the numbers' separator, unless this is blanks;
/// 2. for a single column: the whole line as a cell; for more, at each other separator;
/// 3. at two or more blanks, so that the names may contain single blanks;
/// 4. at blanks outside brackets, so that the units may contain blanks;
/// 5. at any blanks.
pub(super) fn heading_cells(line: &str, layout: Layout) -> Option<Vec<String>> {
    let columns = layout.columns;
    // Way 1
    if layout.separator != Separator::Blanks
        && let Some(cells) = if_heading(trimmed_cells(line, layout.separator, columns), layout)
    {
        return Some(cells);
    }
    // Way 2
    if columns == 1 {
        return if_heading(vec![line.trim().to_owned()], layout);
    }
    let others = [
        Separator::Tab,
        Separator::Semicolon,
        Separator::Pipe,
        Separator::Comma,
    ];
    for separator in others {
        if let Some(cells) = if_heading(trimmed_cells(line, separator, columns), layout) {
            return Some(cells);
        }
    }
    // Ways 3 to 5
    if_heading(cells_at_wide_blanks(line, columns), layout)
        .or_else(|| if_heading(cells_with_brackets_joined(line, columns), layout))
        .or_else(|| if_heading(trimmed_cells(line, Separator::Blanks, columns), layout))
}

/// Returns the cells if they can be a heading: there is one for each column, some contain letters,
/// and they are not a row with errors. First removes an additional empty cell at the end.
fn if_heading(mut cells: Vec<String>, layout: Layout) -> Option<Vec<String>> {
    let ends_empty = cells.last().is_some_and(|cell| cell.trim().is_empty());
    if cells.len() == layout.columns + 1 && ends_empty {
        cells.pop();
    }
    let fits = cells.len() == layout.columns
        && cells.iter().any(|cell| has_letters(cell))
        && !is_mostly_numbers(&cells, layout);
    if fits { Some(cells) } else { None }
}

fn has_letters(cell: &str) -> bool {
    cell.chars().any(char::is_alphabetic)
}

/// Splits a line into at most two cells more than there are columns.
fn trimmed_cells(line: &str, separator: Separator, columns: usize) -> Vec<String> {
    separator
        .cells(line)
        .take(columns + 2)
        .map(|cell| cell.trim().to_owned())
        .collect()
}

/// Returns whether a line is probably a row with errors: the first cell and more than half the
/// cells are numbers.
pub(super) fn is_mostly_numbers(cells: &[String], layout: Layout) -> bool {
    let Some(first) = cells.first() else {
        return false;
    };
    let decimal_comma = layout.decimal_comma;
    if !has_number(first, decimal_comma) {
        return false;
    }
    let numbers = cells
        .iter()
        .filter(|cell| has_number(cell, decimal_comma))
        .count();
    2 * numbers > cells.len()
}

/// Splits a line at two or more blanks, so that names can contain single blanks.
fn cells_at_wide_blanks(line: &str, columns: usize) -> Vec<String> {
    line.trim()
        .split("  ")
        .map(str::trim)
        .filter(|cell| !cell.is_empty())
        .take(columns + 2)
        .map(str::to_owned)
        .collect()
}

/// Splits a line at blanks; text in brackets is joined to the preceding cell.
fn cells_with_brackets_joined(line: &str, columns: usize) -> Vec<String> {
    const OPENING: [char; 3] = ['[', '(', '{'];
    const CLOSING: [char; 3] = [']', ')', '}'];
    let mut cells: Vec<String> = Vec::new();
    let mut is_open = false;
    for word in line.split_whitespace() {
        let count = cells.len();
        match cells.last_mut() {
            Some(last) if is_open || word.starts_with(OPENING) => {
                last.push(' ');
                last.push_str(word);
            }
            _ if count > columns => break,
            _ => cells.push(word.to_owned()),
        }
        let closed = word.matches(CLOSING).count();
        is_open = if is_open {
            closed == 0
        } else {
            word.matches(OPENING).count() > closed
        };
    }
    cells
}

/// Returns whether a heading has one name more than `layout` has columns: then the empty cells
/// after a trailing separator are a column.
pub(super) fn names_one_more_column(above: &[NumberedLine], layout: Layout) -> bool {
    above.iter().any(|NumberedLine { text, .. }| {
        let named_columns = layout
            .separator
            .cells(comment(text).unwrap_or(text))
            .take(layout.columns + 2)
            .filter(|cell| has_letters(cell))
            .count();
        named_columns == layout.columns + 1
    })
}
