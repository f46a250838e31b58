//! Columns with words or clock times in numeric tables: each word is replaced by a number, each
//! time by seconds. The result is again a text, which is read like any other table.
//!
//! 1. Recognise the separator, and whether a column holds numbers, words or clock times
//!    (`Numbering::recognise`).
//! 2. Replace the words and times in each row (`Numbering::line`).
//! 3. Note which number each word has (`Numbering::notes`).

use std::collections::BTreeMap;

use crate::formats::reading_note::{NamedColumn, ReadingNote};
use crate::formats::text::cell_number::is_number;
use crate::formats::text::clock_time::clock_s;
use crate::formats::text::lines::{comment, lines};
use crate::formats::text::separator::Separator;
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};

/// Number of lines examined to recognise the columns.
const SAMPLE: usize = 200;
/// Maximum number of distinct words numbered in a column. A column with more does not hold labels:
/// its further cells are left empty.
const MOST_WORDS: usize = 500;
/// Minimum number of columns with numbers: text with fewer is not a table of numbers.
const FEWEST_NUMBER_COLUMNS: usize = 2;
/// Minimum number of cells in a line: `FEWEST_NUMBER_COLUMNS`, and one with words or clock times.
const FEWEST_CELLS: usize = FEWEST_NUMBER_COLUMNS + 1;
const DAY_S: f64 = 86_400.0;

/// A text whose columns have numbers instead of words and clock times.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberedText {
    pub text: String,
    /// Notes for the user: each word's number, and the columns with clock times.
    pub notes: Vec<ReadingNote>,
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ColumnContent {
    Numbers,
    /// Clock times, with or without a date.
    Clock,
    Words,
}

/// Replaces words in columns by numbers, in the order of their first occurrence, and clock times by
/// seconds. Returns `None` if the text does not have such columns next to numeric columns, with a
/// separator other than blanks.
pub fn numbered_words(
    text: &str,
    budget: &ReadingBudget,
) -> Result<Option<NumberedText>, VariableFault> {
    // Step 1
    let Some(mut numbering) = Numbering::recognise(text) else {
        return Ok(None);
    };
    budget.take(text.len() as u64, 2, NO_VARIABLE)?;
    // Step 2
    let mut numbered = String::with_capacity(text.len());
    for (_, line) in lines(text) {
        budget.work(1, NO_VARIABLE)?;
        let cells = trimmed_cells(line, numbering.separator);
        if cells.len() == numbering.columns.len() && comment(line).is_none() {
            numbered.push_str(&numbering.line(cells));
        } else {
            numbered.push_str(line);
        }
        numbered.push('\n');
    }
    // Step 3
    Ok(Some(NumberedText {
        text: numbered,
        notes: numbering.notes(),
    }))
}

/// Returns a line's cells without blanks around them.
fn trimmed_cells(line: &str, separator: Separator) -> Vec<String> {
    separator
        .cells(line)
        .map(|cell| cell.trim().to_owned())
        .collect()
}

/// State while the words in a text are numbered.
struct Numbering {
    separator: Separator,
    columns: Vec<Column>,
    /// Cells from the first line that is not a row but has a cell for each column.
    heading: Option<Vec<String>>,
}

/// State of a column while its distinct words are numbered.
struct Column {
    content: ColumnContent,
    /// Number assigned to each word, from 1.
    words: BTreeMap<String, usize>,
    clock: Option<ClockSpan>,
}

/// First and last clock time in a column so far.
#[derive(Clone, Copy)]
struct ClockSpan {
    first_s: f64,
    /// Last time \[s\], including a day for each midnight since the first time.
    last_s: f64,
}

impl Numbering {
    /// Finds the separator and what each column holds. Returns `None` unless at least
    /// `FEWEST_NUMBER_COLUMNS` hold numbers, and at least one holds words or clock times.
    fn recognise(text: &str) -> Option<Self> {
        let sample: Vec<&str> = lines(text)
            .map(|(_, line)| line)
            .filter(|line| !line.trim().is_empty() && comment(line).is_none())
            .take(SAMPLE)
            .collect();
        let Candidate {
            separator, width, ..
        } = best_candidate(&sample)?;
        let mut rows = Vec::new();
        for line in &sample {
            let cells = trimmed_cells(line, separator);
            if cells.len() == width {
                rows.push(cells);
            }
        }
        let mut columns = Vec::with_capacity(width);
        let mut number_columns = 0;
        for index in 0..width {
            let content = content_of_column(&rows, index);
            number_columns += usize::from(content == ColumnContent::Numbers);
            columns.push(Column {
                content,
                words: BTreeMap::new(),
                clock: None,
            });
        }
        if number_columns < FEWEST_NUMBER_COLUMNS || number_columns == width {
            return None;
        }
        Some(Self {
            separator,
            columns,
            heading: None,
        })
    }

    /// Returns a row with its words and times replaced. A line whose numeric columns do not all
    /// hold numbers is returned unchanged; the first such line is kept as the heading.
    fn line(&mut self, mut cells: Vec<String>) -> String {
        let is_row = cells
            .iter()
            .zip(&self.columns)
            .all(|(cell, column)| column.content != ColumnContent::Numbers || is_number(cell));
        if is_row {
            for (cell, column) in cells.iter_mut().zip(&mut self.columns) {
                match column.content {
                    ColumnContent::Numbers => {}
                    ColumnContent::Clock => *cell = column.seconds(cell),
                    ColumnContent::Words => *cell = column.number(cell),
                }
            }
        } else if self.heading.is_none() {
            self.heading = Some(cells.clone());
        }
        self.separator.line(cells.into_iter())
    }

    fn notes(&self) -> Vec<ReadingNote> {
        let mut notes = Vec::new();
        for (index, column) in self.columns.iter().enumerate() {
            let place = self.column_place(index);
            match column.content {
                ColumnContent::Numbers => {}
                ColumnContent::Clock => notes.push(ReadingNote::TimesOfDay { column: place }),
                ColumnContent::Words if column.words.len() > MOST_WORDS => {
                    notes.push(ReadingNote::TooManyWords { column: place });
                }
                ColumnContent::Words => notes.push(ReadingNote::NumberedWords {
                    column: place,
                    words: column.numbered_words(),
                }),
            }
        }
        notes
    }

    fn column_place(&self, index: usize) -> NamedColumn {
        let heading = self.heading.as_ref().and_then(|cells| cells.get(index));
        match heading {
            Some(name) if !name.is_empty() => NamedColumn::Name(name.clone()),
            _ => NamedColumn::Number(index + 1),
        }
    }
}

impl Column {
    /// Returns the number for a word. Returns an empty string for an empty cell, and for all cells
    /// once the column has more than `MOST_WORDS` distinct words.
    fn number(&mut self, word: &str) -> String {
        if word.is_empty() || self.words.len() > MOST_WORDS {
            return String::new();
        }
        let next = self.words.len() + 1;
        self.words
            .entry(word.to_owned())
            .or_insert(next)
            .to_string()
    }

    /// Returns the time since the first time in the column \[s\]; a time without a date that goes
    /// back by more than half a day is on the next day. Returns an empty string for any other cell.
    fn seconds(&mut self, cell: &str) -> String {
        // Without a date, the time is since midnight and below `DAY_S`.
        let Some(mut now_s) = clock_s(cell) else {
            return String::new();
        };
        let ClockSpan { first_s, last_s } = self.clock.unwrap_or(ClockSpan {
            first_s: now_s,
            last_s: now_s,
        });
        if now_s < DAY_S && now_s < last_s - DAY_S / 2.0 {
            // Add whole days, so that the time is as near as possible to the last.
            now_s += DAY_S * ((last_s - now_s) / DAY_S).round();
        }
        self.clock = Some(ClockSpan {
            first_s,
            last_s: now_s,
        });
        // Integer nanoseconds are finer than any clock, and need no decimal mark, which may be a
        // point or a comma in this text.
        format!("{:.0}e-9", (now_s - first_s) * 1e9)
    }

    /// Returns the words ordered by their numbers.
    fn numbered_words(&self) -> Vec<String> {
        let mut words: Vec<_> = self.words.iter().collect();
        words.sort_unstable_by_key(|(_, number)| **number);
        words.into_iter().map(|(word, _)| word.clone()).collect()
    }
}

/// A separator, and the line width that is most frequent with it.
struct Candidate {
    separator: Separator,
    width: usize,
    /// Number of lines with this width.
    lines: usize,
}

/// Returns the separator, other than blanks, with which most lines have equal width, in a tie the
/// larger width; `None` if no separator qualifies.
fn best_candidate(sample: &[&str]) -> Option<Candidate> {
    Separator::ALL
        .into_iter()
        .filter(|separator| *separator != Separator::Blanks)
        .filter_map(|separator| candidate(sample, separator))
        .max_by_key(|candidate| (candidate.lines, candidate.width))
}

/// Returns the most frequent line width for a separator; `None` unless it has at least
/// `FEWEST_CELLS` cells and more than half the lines have it.
fn candidate(sample: &[&str], separator: Separator) -> Option<Candidate> {
    let mut lines_by_width: BTreeMap<usize, usize> = BTreeMap::new();
    for line in sample {
        *lines_by_width
            .entry(separator.cells(line).count())
            .or_default() += 1;
    }
    let (width, lines) = lines_by_width
        .into_iter()
        .max_by_key(|(width, lines)| (*lines, *width))?;
    if width < FEWEST_CELLS || 2 * lines <= sample.len() {
        return None;
    }
    Some(Candidate {
        separator,
        width,
        lines,
    })
}

/// Returns what more than half the filled cells in a column hold; words if neither numbers nor
/// clock times prevail. An empty column counts as numbers.
fn content_of_column(rows: &[Vec<String>], index: usize) -> ColumnContent {
    let mut filled = 0;
    let mut numbers = 0;
    let mut clock_times = 0;
    for row in rows {
        let cell = row[index].as_str();
        if cell.is_empty() {
            continue;
        }
        filled += 1;
        numbers += usize::from(is_number(cell));
        clock_times += usize::from(clock_s(cell).is_some());
    }
    if filled == 0 || 2 * numbers > filled {
        ColumnContent::Numbers
    } else if 2 * clock_times > filled {
        ColumnContent::Clock
    } else {
        ColumnContent::Words
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::text::table_reader::read_table;

    fn numbered(text: &str) -> Option<NumberedText> {
        numbered_words(text, &ReadingBudget::new(1 << 20)).unwrap()
    }

    #[test]
    fn words_are_numbered_in_order_of_occurrence() {
        let text = "t,mode,P,Q\n0,SAS,1,2\n0.1,SAS,3,4\n0.2,\"ATT, on\",5,6\n0.3,SAS,7,8\n";
        let found = numbered(text).unwrap();
        assert_eq!(
            found.text,
            "t,mode,P,Q\n0,1,1,2\n0.1,1,3,4\n0.2,2,5,6\n0.3,1,7,8\n\n"
        );
        let numbered = ReadingNote::NumberedWords {
            column: NamedColumn::Name("mode".to_owned()),
            words: vec!["SAS".to_owned(), "ATT, on".to_owned()],
        };
        assert_eq!(found.notes, [numbered]);
        let table = read_table(&found.text, &ReadingBudget::new(1 << 20)).unwrap();
        assert_eq!(table.columns[1], [1.0, 1.0, 2.0, 1.0]);
    }

    #[test]
    fn clock_times_become_seconds_across_midnight() {
        let text = "time;P;Q\n23:59:59,90;1,5;2\n23:59:59,95;1,5;2\n00:00:00,00;1,5;2\n00:00:00,05;1,5;2\n";
        let found = numbered(text).unwrap();
        let table = read_table(&found.text, &ReadingBudget::new(1 << 20)).unwrap();
        // Times are written in nanoseconds.
        assert!(
            table.columns[0]
                .iter()
                .zip([0.0, 0.05, 0.1, 0.15])
                .all(|(a, b)| (a - b).abs() < 1e-9),
            "{table:?}"
        );
        assert_eq!(table.columns[1], [1.5; 4]);
    }

    #[test]
    fn a_table_of_numbers_and_a_text_are_left_alone() {
        assert_eq!(numbered("t,P,Q\n0,1,2\n1,2,3\n"), None);
        assert_eq!(
            numbered("Dear sir,\nthis is, as you say, a text,\nof words\n"),
            None
        );
        assert_eq!(numbered(""), None);
    }
}
