//! How the lines of a table are made.

use std::collections::BTreeMap;

use super::cell_number::cell_number;
use super::lines::lines;
use super::separator::Separator;
use crate::variables::{MemoryBudget, VariableFault};

/// As many lines of numbers are looked at before the way they are made is taken as known.
const SAMPLE: usize = 200;
/// What a line of comment begins with.
const COMMENT_MARKS: [&str; 5] = ["#", "%", "//", "!", ";"];

/// How the lines of a table are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// What stands between the cells.
    pub(super) separator: Separator,
    /// Whether the comma is the decimal mark.
    pub(super) decimal_comma: bool,
    /// Number of columns, without the empty one behind a separator at the end of every line.
    pub(super) columns: usize,
    /// Whether the separator at the end of the lines looked at leaves an empty cell.
    pub(super) trailing: bool,
}

/// How often lines of one width were found.
#[derive(Clone, Copy, Default)]
struct Count {
    lines: usize,
    ending_empty: usize,
}

/// The lines of numbers that are found if the lines are made in one way.
struct Tally {
    separator: Separator,
    decimal_comma: bool,
    widths: BTreeMap<usize, Count>,
    lines: usize,
}

impl Layout {
    /// Finds the separator and the decimal mark with which most lines are lines of numbers of one width; the wider table where
    /// several do; nothing where no line is a line of numbers.
    pub(super) fn recognise(text: &str, meter: &MemoryBudget) -> Result<Option<Self>, VariableFault> {
        let mut tallies: Vec<Tally> = Vec::with_capacity(2 * Separator::ALL.len());
        for decimal_comma in [false, true] {
            let tally = |&separator| Tally { separator, decimal_comma, widths: BTreeMap::new(), lines: 0 };
            tallies.extend(Separator::ALL.iter().map(tally));
        }
        for (_, line) in lines(text) {
            meter.take(0, 1, "")?;
            if line.trim().is_empty() || comment(line).is_some() {
                continue;
            }
            tallies.iter_mut().for_each(|tally| tally.count(line));
            if tallies.iter().any(|tally| tally.lines >= SAMPLE) {
                break;
            }
        }
        let mut best: Option<(usize, Layout)> = None;
        for (count, layout) in tallies.iter().filter_map(Tally::layout) {
            if best.is_none_or(|(most, known)| (count, layout.columns) > (most, known.columns)) {
                best = Some((count, layout));
            }
        }
        Ok(best.map(|(_, layout)| layout))
    }

    /// The cells of a line of numbers, without a comment behind them.
    pub(super) fn cells(self, line: &str) -> super::separator::Cells<'_> {
        self.separator.cells(without_comment(line))
    }

    /// Number of cells of a line if all are numbers or say that there is none, and at least one is a number; and whether the last
    /// is empty.
    pub(super) fn width(self, line: &str) -> Option<(usize, bool)> {
        width(self.separator, self.decimal_comma, line)
    }

    /// Whether a line of so many cells fits: one more, which is empty, stands behind a separator at the end. Where all lines end
    /// in a separator, the empty cell behind it is none.
    pub(super) fn fits(self, width: usize, ends_empty: bool) -> bool {
        let expected = if self.trailing && ends_empty { self.columns + 1 } else { self.columns };
        width == expected || (width == self.columns + 1 && ends_empty)
    }
}

impl Tally {
    fn count(&mut self, line: &str) {
        if let Some((width, ends_empty)) = width(self.separator, self.decimal_comma, line) {
            let count = self.widths.entry(width).or_default();
            count.lines += 1;
            count.ending_empty += usize::from(ends_empty);
            self.lines += 1;
        }
    }

    /// The most frequent width, the larger of two.
    fn layout(&self) -> Option<(usize, Layout)> {
        let (&width, count) = self.widths.iter().max_by_key(|(width, count)| (count.lines, **width))?;
        let trailing = count.ending_empty == count.lines && width > 1;
        let columns = if trailing { width - 1 } else { width };
        let Self { separator, decimal_comma, .. } = *self;
        Some((count.lines, Layout { separator, decimal_comma, columns, trailing }))
    }
}

fn width(separator: Separator, decimal_comma: bool, line: &str) -> Option<(usize, bool)> {
    let (mut width, mut numbers, mut empty) = (0, 0, false);
    for cell in separator.cells(without_comment(line)) {
        let number = cell_number(&cell, decimal_comma)?;
        width += 1;
        numbers += usize::from(!number.is_nan());
        empty = cell.trim().is_empty();
    }
    (numbers > 0).then_some((width, empty))
}

/// The text of a line of comment behind its mark.
pub(super) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let mark = COMMENT_MARKS.iter().find(|&&mark| line.starts_with(mark))?;
    Some(line.trim_start_matches(mark))
}

/// Whether a line only draws a rule: "-----", "|---|---|", "=====".
pub(super) fn is_rule(line: &str) -> bool {
    line.trim().len() >= 3 && line.bytes().all(|byte| b"-=+|:_ \t".contains(&byte)) && !line.trim().contains("- -")
}

/// A line without the comment behind its numbers; its mark stands between blanks, as "#N/A" and "50%" have such characters too.
fn without_comment(line: &str) -> &str {
    if !line.contains(['#', '%', '!', '/']) {
        return line;
    }
    let marks = [" # ", " % ", " ! ", " // ", "\t# ", "\t% ", "\t! "];
    marks.iter().filter_map(|mark| line.find(mark)).min().map_or(line, |end| &line[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<(Separator, bool, usize)> {
        let layout = Layout::recognise(text, &MemoryBudget::new(1 << 20, &|_| false)).unwrap()?;
        Some((layout.separator, layout.decimal_comma, layout.columns))
    }

    #[test]
    fn the_separator_and_the_decimal_mark_are_recognised() {
        assert_eq!(of("1,2,3\n4,5,6"), Some((Separator::Comma, false, 3)));
        assert_eq!(of("1,5;2,5"), Some((Separator::Semicolon, true, 2)));
        assert_eq!(of("1;2"), Some((Separator::Semicolon, false, 2)));
        assert_eq!(of("1,5 2,5"), Some((Separator::Blanks, true, 2)));
        assert_eq!(of("1,5\t2,5"), Some((Separator::Tab, true, 2)));
        assert_eq!(of("1.5 | 2 |\n3 | 4 |"), Some((Separator::Pipe, false, 2)));
        assert_eq!(of("\"1,5\",\"2,5\""), Some((Separator::Comma, true, 2)));
        assert_eq!(of("1.5\n2.5"), Some((Separator::Tab, false, 1)));
        assert_eq!(of("no numbers"), None);
    }

    #[test]
    fn tabulators_that_only_align_are_blanks() {
        assert_eq!(of("1\t\t2\n100\t2\n3\t\t4\n400\t5"), Some((Separator::Blanks, false, 2)));
        assert_eq!(of("1\t\t2\n3\t\t4"), Some((Separator::Tab, false, 3)));
    }

    #[test]
    fn a_comment_behind_numbers_is_left_out() {
        assert_eq!(of("1 2 # first\n3 4 ! second"), Some((Separator::Blanks, false, 2)));
        assert_eq!(without_comment("1 #N/A 50%"), "1 #N/A 50%");
    }

    #[test]
    fn rules_are_seen() {
        assert!(is_rule("|---|---|") && is_rule("====") && !is_rule("- - -") && !is_rule("-1"));
    }
}
