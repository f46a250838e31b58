//! Column names and units, from the lines before the numbers.
//!
//! A *cell* is the text between two separators; a line can be a heading only if it has a cell for
//! each column (`heading_cells.rs`).

use crate::formats::reading_note::ReadingNote;
use crate::formats::text::heading_cells::heading_cells;
use crate::formats::text::heading_units::{is_unit, name_and_unit};
use crate::formats::text::layout::Layout;
use crate::formats::text::lines::{NumberedLine, comment, is_rule};

/// Number of lines before the first row that are searched for names and units.
const SEARCHED: usize = 100;

#[derive(Debug, PartialEq)]
pub(super) struct Heading {
    /// Column names; `None` if no line gives them.
    pub(super) names: Option<Vec<String>>,
    /// Each column's unit, where a line gives it.
    pub(super) units: Vec<Option<String>>,
    /// Notes for the user on the lines from which names and units were taken, or on a line with
    /// more or fewer cells.
    pub(super) notes: Vec<ReadingNote>,
}

/// A line with as many cells as the table has columns.
struct FittingLine {
    number: usize,
    cells: Vec<String>,
}

impl Heading {
    /// Finds names and units in the lines before the numbers.
    ///
    /// 1. Candidates are the lines with a cell for each column, nearest first, comments last. If
    ///    there are none, the nearest line that is no comment is noted if it has several cells.
    /// 2. If the nearest candidate holds units and the next is a line above it, the next gives the
    ///    names.
    /// 3. Otherwise the nearest gives the names, and units in brackets.
    pub(super) fn find(above: &[NumberedLine], layout: Layout) -> Self {
        let mut heading = Heading {
            names: None,
            units: vec![None; layout.columns],
            notes: Vec::new(),
        };
        // Step 1
        let mut lines = fitting_lines(above, layout).into_iter();
        let Some(nearest) = lines.next() else {
            heading.note_misfit(above, layout);
            return heading;
        };
        // Steps 2 and 3
        let names = match lines.next() {
            // The names must be above the units: the next candidate may be a comment below them.
            Some(next) if is_units_line(&nearest.cells) && next.number < nearest.number => {
                heading.units = nearest.cells.iter().map(|cell| unit_of(cell)).collect();
                heading.notes.push(ReadingNote::UnitsLine {
                    line: nearest.number,
                });
                next
            }
            _ => nearest,
        };
        heading.take_names(&names.cells);
        heading
            .notes
            .push(ReadingNote::NamesLine { line: names.number });
        heading
    }

    /// Takes the names, and the units that are still unknown, from a line's cells.
    fn take_names(&mut self, cells: &[String]) {
        let mut names = Vec::with_capacity(cells.len());
        for (cell, known_unit) in cells.iter().zip(&mut self.units) {
            let (name, unit) = name_and_unit(cell);
            if known_unit.is_none() {
                *known_unit = unit;
            }
            names.push(name);
        }
        self.names = Some(names);
    }

    /// Notes that the nearest line has several cells, but not as many as there are columns.
    fn note_misfit(&mut self, above: &[NumberedLine], layout: Layout) {
        let nearest = above
            .iter()
            .rev()
            .find(|line| comment(&line.text).is_none() && !is_rule(&line.text));
        let Some(NumberedLine { number, text }) = nearest else {
            return;
        };
        let found = layout.separator.cells(text).count();
        if found > 1 {
            self.notes.push(ReadingNote::HeadingMisfit {
                line: *number,
                found,
                columns: layout.columns,
            });
        }
    }
}

/// Returns the lines with a cell for each column, nearest to the numbers first, comments last.
fn fitting_lines(above: &[NumberedLine], layout: Layout) -> Vec<FittingLine> {
    let candidates: Vec<_> = above
        .iter()
        .rev()
        .filter(|line| !is_rule(&line.text))
        .take(SEARCHED)
        .collect();
    let mut fitting = Vec::new();
    for is_comment in [false, true] {
        for NumberedLine { number, text } in &candidates {
            let after_mark = comment(text);
            if after_mark.is_some() != is_comment {
                continue;
            }
            if let Some(cells) = heading_cells(after_mark.unwrap_or(text), layout) {
                fitting.push(FittingLine {
                    number: *number,
                    cells,
                });
            }
        }
    }
    fitting
}

/// Returns the unit in a cell, without its brackets; `None` for an empty cell.
fn unit_of(cell: &str) -> Option<String> {
    let unit = cell
        .trim()
        .trim_matches(['[', ']', '(', ')', '{', '}'])
        .trim();
    if unit.is_empty() {
        None
    } else {
        Some(unit.to_owned())
    }
}

/// Returns whether at least half the cells are units and the others are empty.
fn is_units_line(cells: &[String]) -> bool {
    let units: Vec<_> = cells.iter().filter_map(|cell| unit_of(cell)).collect();
    2 * units.len() >= cells.len() && units.iter().all(|unit| is_unit(unit))
}

#[cfg(test)]
mod heading_tests {
    use super::*;
    use crate::formats::text::separator::Separator;

    fn find(lines: &[&str], separator: Separator, columns: usize) -> Heading {
        let above: Vec<_> = lines
            .iter()
            .enumerate()
            .map(|(index, line)| NumberedLine {
                number: index + 1,
                text: (*line).to_owned(),
            })
            .collect();
        Heading::find(
            &above,
            Layout {
                separator,
                decimal_comma: false,
                columns,
                has_trailing_separator: false,
            },
        )
    }

    fn units(heading: &Heading) -> Vec<&str> {
        heading
            .units
            .iter()
            .map(|unit| unit.as_deref().unwrap_or(""))
            .collect()
    }

    #[test]
    fn a_whole_number_in_brackets_is_an_index() {
        assert_eq!(name_and_unit("xyz[0]"), ("xyz[0]".to_owned(), None));
        assert_eq!(
            name_and_unit("xyz [1/s]"),
            ("xyz".to_owned(), Some("1/s".to_owned()))
        );
    }

    #[test]
    fn names_and_units_stand_in_one_line_or_in_two() {
        let one = find(&["omega [rad/s],mag (dB),x"], Separator::Comma, 3);
        assert_eq!(one.names.as_deref().unwrap(), ["omega", "mag", "x"]);
        assert_eq!(units(&one), ["rad/s", "dB", ""]);
        let two = find(&["w,mag,phase", "rad/s,dB,deg"], Separator::Comma, 3);
        assert_eq!(two.names.as_deref().unwrap(), ["w", "mag", "phase"]);
        assert_eq!(units(&two), ["rad/s", "dB", "deg"]);
    }

    #[test]
    fn blanks_may_stand_in_names_and_before_units() {
        let joined = find(&["% omega [rad/s] mag [dB]"], Separator::Blanks, 2);
        assert_eq!(joined.names.as_deref().unwrap(), ["omega", "mag"]);
        let wide = find(&["mag P/LAT   phase P/LAT"], Separator::Blanks, 2);
        assert_eq!(wide.names.as_deref().unwrap(), ["mag P/LAT", "phase P/LAT"]);
        let commas = find(&["# w, re, im"], Separator::Blanks, 3);
        assert_eq!(commas.names.as_deref().unwrap(), ["w", "re", "im"]);
    }

    #[test]
    fn a_title_is_no_heading_and_a_misfit_is_noted() {
        let heading = find(&["Flight 12", "a,b"], Separator::Comma, 3);
        assert_eq!(heading.names, None);
        let misfit = ReadingNote::HeadingMisfit {
            line: 2,
            found: 2,
            columns: 3,
        };
        assert_eq!(heading.notes, [misfit]);
    }

    #[test]
    fn a_line_without_a_mark_goes_before_a_comment() {
        let heading = find(&["w,m,p", "# by, some, tool"], Separator::Comma, 3);
        assert_eq!(heading.names.as_deref().unwrap(), ["w", "m", "p"]);
    }
}
