//! Layout of the lines in a table: separator, decimal mark and number of columns.
//!
//! A *row* is a line whose cells are numbers or missing, with at least one number; its *width* is
//! its number of cells. If the lines end in a *trailing separator*, an empty cell follows it.
//!
//! 1. For each separator and decimal mark, count the rows of each width (`Tally`).
//! 2. The most frequent width gives a layout (`Tally::score`).
//! 3. Take the layout with the most rows, in a tie the wider (`Score::beats`).

use std::collections::BTreeMap;

use crate::formats::text::cell_number::cell_number;
use crate::formats::text::lines::{comment, lines, without_comment};
use crate::formats::text::separator::{Cells, Separator};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};

/// Number of rows examined to recognise the layout.
const SAMPLE: usize = 200;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) separator: Separator,
    pub(super) decimal_comma: bool,
    /// Number of columns, not counting an empty column after a trailing separator.
    pub(super) columns: usize,
    /// Whether the examined lines end in a separator, after which there is an empty cell.
    pub(super) has_trailing_separator: bool,
}

/// A row's cell count, and whether the last cell is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RowShape {
    pub(super) width: usize,
    pub(super) ends_empty: bool,
}

impl Layout {
    /// Finds the separator and the decimal mark with which most lines are equally wide rows; in a
    /// tie the wider rows, then the first of [`candidates`]. Returns `None` if no line is a row.
    pub(super) fn recognise(
        text: &str,
        budget: &ReadingBudget,
    ) -> Result<Option<Self>, VariableFault> {
        // Step 1
        let mut tallies = candidates();
        for (_, line) in lines(text) {
            budget.work(1, NO_VARIABLE)?;
            if line.trim().is_empty() || comment(line).is_some() {
                continue;
            }
            for tally in &mut tallies {
                tally.count(line);
            }
            if tallies.iter().any(|tally| tally.rows >= SAMPLE) {
                break;
            }
        }
        // Steps 2 and 3
        let mut best: Option<Score> = None;
        for score in tallies.iter().filter_map(Tally::score) {
            if best.is_none_or(|best| score.beats(best)) {
                best = Some(score);
            }
        }
        Ok(best.map(|best| best.layout))
    }

    /// Returns the cells in a line, without a comment at its end.
    pub(super) fn cells(self, line: &str) -> Cells<'_> {
        self.separator.cells(without_comment(line))
    }

    /// Returns a line's shape; `None` unless all cells are numbers or missing numbers, and at least
    /// one is a number.
    pub(super) fn row_shape(self, line: &str) -> Option<RowShape> {
        let mut shape = RowShape {
            width: 0,
            ends_empty: false,
        };
        let mut has_number = false;
        for cell in self.cells(line) {
            let number = cell_number(&cell, self.decimal_comma)?;
            shape.width += 1;
            shape.ends_empty = cell.trim().is_empty();
            has_number |= !number.is_nan();
        }
        if has_number { Some(shape) } else { None }
    }

    /// Returns whether a row has this layout's columns. If its last cell is empty, this is either
    /// the cell after a trailing separator, or the last column with a missing number; the latter
    /// does not fit in a layout with trailing separators.
    pub(super) fn fits(self, row: RowShape) -> bool {
        if row.width == self.columns + 1 {
            row.ends_empty
        } else {
            let lacks_number = row.ends_empty && self.has_trailing_separator;
            row.width == self.columns && !lacks_number
        }
    }
}

/// Returns an empty tally for each separator and decimal mark; those with a decimal point come
/// first.
fn candidates() -> Vec<Tally> {
    let mut tallies = Vec::with_capacity(2 * Separator::ALL.len());
    for decimal_comma in [false, true] {
        for separator in Separator::ALL {
            tallies.push(Tally {
                separator,
                decimal_comma,
                widths: BTreeMap::new(),
                rows: 0,
            });
        }
    }
    tallies
}

/// Rows found with one separator and one decimal mark.
struct Tally {
    separator: Separator,
    decimal_comma: bool,
    /// Number of rows by row width.
    widths: BTreeMap<usize, RowCount>,
    /// Number of rows of any width.
    rows: usize,
}

/// Row counts for one row width.
#[derive(Clone, Copy, Default)]
struct RowCount {
    rows: usize,
    /// Number of rows whose last cell is empty.
    ending_empty: usize,
}

/// A layout, and how many examined rows have it.
#[derive(Clone, Copy)]
struct Score {
    rows: usize,
    layout: Layout,
}

impl Score {
    /// Returns whether this layout has more rows than `other`, or equally many rows with more
    /// columns.
    fn beats(self, other: Score) -> bool {
        (self.rows, self.layout.columns) > (other.rows, other.layout.columns)
    }
}

impl Tally {
    /// Counts a line if it is a row.
    fn count(&mut self, line: &str) {
        let layout = Layout {
            separator: self.separator,
            decimal_comma: self.decimal_comma,
            columns: 0,
            has_trailing_separator: false,
        };
        if let Some(RowShape { width, ends_empty }) = layout.row_shape(line) {
            let count = self.widths.entry(width).or_default();
            count.rows += 1;
            count.ending_empty += usize::from(ends_empty);
            self.rows += 1;
        }
    }

    /// Returns the layout with the most frequent row width, in a tie the larger; `None` without
    /// rows.
    fn score(&self) -> Option<Score> {
        let (&width, count) = self
            .widths
            .iter()
            .max_by_key(|(width, count)| (count.rows, **width))?;
        let has_trailing_separator = count.ending_empty == count.rows && width > 1;
        let columns = if has_trailing_separator {
            width - 1
        } else {
            width
        };
        Some(Score {
            rows: count.rows,
            layout: Layout {
                separator: self.separator,
                decimal_comma: self.decimal_comma,
                columns,
                has_trailing_separator,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(text: &str) -> Option<(Separator, bool, usize)> {
        let layout = Layout::recognise(text, &ReadingBudget::new(1 << 20)).unwrap()?;
        Some((layout.separator, layout.decimal_comma, layout.columns))
    }

    #[test]
    fn the_separator_and_the_decimal_mark_are_recognised() {
        assert_eq!(layout("1,2,3\n4,5,6"), Some((Separator::Comma, false, 3)));
        assert_eq!(layout("1,5;2,5"), Some((Separator::Semicolon, true, 2)));
        assert_eq!(layout("1;2"), Some((Separator::Semicolon, false, 2)));
        assert_eq!(layout("1,5 2,5"), Some((Separator::Blanks, true, 2)));
        assert_eq!(layout("1,5\t2,5"), Some((Separator::Tab, true, 2)));
        let strokes = layout("1.5 | 2 |\n3 | 4 |");
        assert_eq!(strokes, Some((Separator::Pipe, false, 2)));
        let quoted = layout("\"1,5\",\"2,5\"");
        assert_eq!(quoted, Some((Separator::Comma, true, 2)));
        assert_eq!(layout("1.5\n2.5"), Some((Separator::Tab, false, 1)));
        assert_eq!(layout("no numbers"), None);
    }

    #[test]
    fn tabulators_that_only_align_are_blanks() {
        assert_eq!(
            layout("1\t\t2\n100\t2\n3\t\t4\n400\t5"),
            Some((Separator::Blanks, false, 2))
        );
        assert_eq!(layout("1\t\t2\n3\t\t4"), Some((Separator::Tab, false, 3)));
    }

    #[test]
    fn trailing_comments_are_left_out() {
        assert_eq!(
            layout("1 2 # first\n3 4 ! second"),
            Some((Separator::Blanks, false, 2))
        );
    }
}
