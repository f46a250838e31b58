//! Reads tables of numbers in columns, written by programs or by hand.
//!
//! A *row* is a line with a number, or a missing number, for each column.
//!
//! 1. Recognise separator, decimal mark and column count (`layout.rs`).
//! 2. Take each line as a row, or keep it as skipped.
//! 3. Find names and units in the lines above the first row (`heading.rs`).

use crate::formats::reading_note::ReadingNote;
use crate::formats::text::cell_number::cell_number;
use crate::formats::text::encoding::refuse_binary;
use crate::formats::text::heading::Heading;
use crate::formats::text::heading_cells::{is_mostly_numbers, names_one_more_column};
use crate::formats::text::layout::{Layout, RowShape};
use crate::formats::text::lines::{NumberedLine, comment, excerpt, is_rule, lines};
use crate::formats::text::separator::Separator;
use crate::formats::text::text_table::TextTable;
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};
use crate::variable_fault::found_content::FoundContent;
use crate::variable_fault::line_fault::LineFault;

/// Expected contents, as named in error messages.
const EXPECTED: &str = "a table of numbers in columns";
/// Number of skipped lines at the beginning with which a line is compared to find a repeated
/// heading.
const COMPARED_HEADINGS: usize = 20;

/// Reads a table of numbers in columns, and recognises its separator, decimal mark, names and
/// units.
///
/// # Errors
/// [`VariableFault`] for binary data, a text without a row of numbers, a line among the rows that
/// is not a complete row, and an exhausted budget.
pub fn read_table(text: &str, budget: &ReadingBudget) -> Result<TextTable, VariableFault> {
    refuse_binary(text, EXPECTED)?;
    // Step 1
    let Some(layout) = Layout::recognise(text, budget)? else {
        return Err(no_numbers(text));
    };
    // Step 2
    let mut reading = Reading::new(layout, budget)?;
    for (number, line) in lines(text) {
        reading.take_line(number, line)?;
    }
    // Step 3
    reading.finish(text)
}

/// Returns the error for a text without any row of numbers.
fn no_numbers(text: &str) -> VariableFault {
    let found = match excerpt(text).as_str() {
        "" => FoundContent::EmptyFile,
        start => FoundContent::NoRow {
            start: start.to_owned(),
        },
    };
    VariableFault::format(EXPECTED, found)
}

/// State while a table is read. Each line is a row, or it is skipped: an empty line, a comment, a
/// ruled line, and a line before the first row that may be a heading. Skipped lines other than
/// empty lines are kept, because names and units are looked up in them at the end.
struct Reading<'m> {
    layout: Layout,
    budget: &'m ReadingBudget<'m>,
    columns: Vec<Vec<f64>>,
    /// Each row's line number.
    lines: Vec<usize>,
    skipped: Vec<NumberedLine>,
    notes: Vec<ReadingNote>,
}

impl<'m> Reading<'m> {
    fn new(layout: Layout, budget: &'m ReadingBudget<'m>) -> Result<Self, VariableFault> {
        // Memory for an empty column, and later for its unit and name.
        budget.take(layout.columns as u64, 128, NO_VARIABLE)?;
        Ok(Self {
            layout,
            budget,
            columns: vec![Vec::new(); layout.columns],
            lines: Vec::new(),
            skipped: Vec::new(),
            notes: Vec::new(),
        })
    }

    /// Adds a line as a row, or skips it. The first case that applies:
    ///
    /// 1. empty line: skipped;
    /// 2. line with a comment mark: a row if its cells fit, else skipped;
    /// 3. ruled line: skipped;
    /// 4. before the first row: `take_line_before_rows`;
    /// 5. repeated heading: skipped, with a note;
    /// 6. anything else must be a row.
    ///
    /// # Errors
    /// [`VariableFault`] if a row has the wrong number of columns, or text follows the first row.
    fn take_line(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        // Case 1
        if line.trim().is_empty() {
            return Ok(());
        }
        // Case 2
        if comment(line).is_some() {
            // Check for rows first: "#N/A;1" and ";1;2" are rows that begin with a comment mark.
            return match self.layout.row_shape(line) {
                Some(shape) if self.layout.fits(shape) => self.take_row(number, line),
                _ => self.skip_line(number, line),
            };
        }
        // Case 3
        if is_rule(line) {
            return self.skip_line(number, line);
        }
        // Cases 4 to 6
        if self.lines.is_empty() {
            self.take_line_before_rows(number, line)
        } else if self.repeats_heading(line) {
            self.notes
                .push(ReadingNote::RepeatedHeading { line: number });
            self.skip_line(number, line)
        } else {
            self.take_row(number, line)
        }
    }

    /// Adds a line as the first row, or skips it: numbers with the layout's columns are a row, a
    /// single number is skipped with a note, other numbers are a row with an error, and text is
    /// skipped unless it is mostly numbers.
    fn take_line_before_rows(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        match self.layout.row_shape(line) {
            Some(shape) if self.layout.fits(shape) => self.take_row(number, line),
            // A single number in a wider table is no row: it may be a number of rows or a date.
            Some(RowShape { width: 1, .. }) => {
                self.notes.push(ReadingNote::SingleNumber {
                    line: number,
                    columns: self.layout.columns,
                });
                self.skip_line(number, line)
            }
            Some(_) => self.take_row(number, line),
            None => self.take_text_before_rows(number, line),
        }
    }

    /// Returns whether a line repeats the heading, as programs do when they continue a record.
    fn repeats_heading(&self, line: &str) -> bool {
        self.skipped_above_rows()
            .iter()
            .take(COMPARED_HEADINGS)
            .any(|heading| heading.text.trim() == line.trim())
    }

    /// Returns the lines before the first row that were skipped.
    fn skipped_above_rows(&self) -> &[NumberedLine] {
        let first_row = self.lines.first().copied().unwrap_or(0);
        let count = self.skipped.partition_point(|line| line.number < first_row);
        &self.skipped[..count]
    }

    /// Adds a line that is not a row of numbers as the first row if it is probably a row with
    /// errors, which are then reported; otherwise skips it.
    fn take_text_before_rows(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        let columns = self.layout.columns;
        let cells: Vec<_> = self
            .layout
            .cells(line)
            .take(columns + 2)
            .map(|cell| cell.into_owned())
            .collect();
        let fits = cells.len() == columns || cells.len() == columns + 1;
        if fits && is_mostly_numbers(&cells, self.layout) {
            self.take_row(number, line)
        } else {
            self.skip_line(number, line)
        }
    }

    /// Stores a line that is not a row.
    fn skip_line(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        self.budget
            .take(2 * line.len() as u64 + 64, 1, NO_VARIABLE)?;
        self.skipped.push(NumberedLine {
            number,
            text: line.to_owned(),
        });
        Ok(())
    }

    /// Appends the numbers in a line to the columns.
    ///
    /// # Errors
    /// [`VariableFault`] if a cell is not a number, or the number of columns is wrong.
    fn take_row(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        let is_first = self.lines.is_empty();
        // An empty last cell is a column, not a trailing separator, if the heading names it.
        if is_first
            && self.layout.has_trailing_separator
            && names_one_more_column(&self.skipped, self.layout)
        {
            self.layout.columns += 1;
            self.layout.has_trailing_separator = false;
            self.columns.push(Vec::new());
        }
        // Take twice a row's memory: vectors grow by doubling.
        self.budget
            .take(self.layout.columns as u64 + 1, 16, NO_VARIABLE)?;
        let mut cells = self.layout.cells(line);
        let mut ends_empty = false;
        for (index, column) in self.columns.iter_mut().enumerate() {
            let Some(cell) = cells.next() else {
                return Err(self.wrong_width(number, line));
            };
            let Some(value) = cell_number(&cell, self.layout.decimal_comma) else {
                let fault = self.no_number(index, &cell, line);
                return Err(VariableFault::line(NO_VARIABLE, number, fault));
            };
            ends_empty = cell.trim().is_empty();
            column.push(value);
        }
        let is_complete = match cells.next() {
            None => self.layout.fits(RowShape {
                width: self.layout.columns,
                ends_empty,
            }),
            // One empty cell is allowed, after a trailing separator.
            Some(extra) => cells.next().is_none() && extra.trim().is_empty(),
        };
        if !is_complete {
            return Err(self.wrong_width(number, line));
        }
        self.lines.push(number);
        Ok(())
    }

    /// Returns the fault of a cell that is not a number, or of a line without numbers.
    fn no_number(&self, index: usize, cell: &str, line: &str) -> LineFault {
        /// Maximum number of cells examined in a line.
        const EXAMINED: usize = 20;
        let decimal_comma = self.layout.decimal_comma;
        let mut cells = self.layout.cells(line).take(EXAMINED);
        if cells.all(|cell| cell_number(&cell, decimal_comma).is_none()) {
            return LineFault::TextAmongRows {
                start: excerpt(line),
            };
        }
        LineFault::NotANumber {
            column: index + 1,
            cell: excerpt(cell),
            is_decimal_comma: decimal_comma && cell.contains('.'),
        }
    }

    /// Returns the error for a line with the wrong number of columns.
    fn wrong_width(&self, number: usize, line: &str) -> VariableFault {
        let mut found: usize = 0;
        let mut ends_empty = false;
        for cell in self.layout.cells(line) {
            found += 1;
            ends_empty = cell.trim().is_empty();
        }
        if self.layout.has_trailing_separator && ends_empty {
            found -= 1;
        }
        VariableFault::line(
            NO_VARIABLE,
            number,
            LineFault::ColumnCount {
                found,
                expected: self.layout.columns,
                separator: self.layout.separator.words(),
            },
        )
    }

    /// Finds names and units in the skipped lines, and returns the table.
    fn finish(mut self, text: &str) -> Result<TextTable, VariableFault> {
        if self.lines.is_empty() {
            return Err(no_numbers(text));
        }
        let heading = Heading::find(self.skipped_above_rows(), self.layout);
        self.notes.extend(heading.notes);
        if heading.names.is_none() && self.may_have_decimal_commas() {
            self.notes.push(ReadingNote::CommaSeparates);
        }
        Ok(TextTable {
            names: heading.names,
            units: heading.units,
            columns: self.columns,
            lines: self.lines,
            separator: self.layout.separator,
            decimal_comma: self.layout.decimal_comma,
            skipped: self.skipped,
            notes: self.notes,
        })
    }

    /// Returns whether the table could instead be a single column with decimal commas: it has two
    /// integer columns, separated by commas.
    fn may_have_decimal_commas(&self) -> bool {
        self.layout.separator == Separator::Comma
            && self.layout.columns == 2
            && !self.layout.decimal_comma
            && self
                .columns
                .iter()
                .flatten()
                .all(|value| value.fract() == 0.0)
    }
}

#[cfg(test)]
mod columns_tests {
    use proptest::prelude::*;

    use super::*;

    fn read(text: &str) -> Result<TextTable, VariableFault> {
        read_table(text, &ReadingBudget::new(1 << 24))
    }

    /// Returns the line of an error, and the fault in it.
    fn line_fault(text: &str) -> (usize, LineFault) {
        match read(text) {
            Err(VariableFault::Line { line, fault, .. }) => (line, fault),
            other => panic!("{other:?}"),
        }
    }

    fn missing(table: &TextTable) -> usize {
        table
            .columns
            .iter()
            .flatten()
            .filter(|value| value.is_nan())
            .count()
    }

    #[test]
    fn a_comma_can_be_the_decimal_mark() {
        let table = read("\u{feff}omega [rad/s];Re;Im\r\n0,1;1,5;-2,5E-1\r\n0,2;1,0;\r\n").unwrap();
        assert_eq!(table.names.as_deref().unwrap(), ["omega", "Re", "Im"]);
        assert_eq!(table.units, [Some("rad/s".to_owned()), None, None]);
        assert_eq!(table.columns[..2], [vec![0.1, 0.2], vec![1.5, 1.0]]);
        assert_eq!(table.columns[2][0], -0.25);
        assert!(table.columns[2][1].is_nan());
        assert_eq!(
            (missing(&table), table.lines[0], table.decimal_comma),
            (1, 2, true)
        );
        assert_eq!(table.lines, [2, 3]);
    }

    #[test]
    fn strokes_align_columns_and_end_lines() {
        let table = read(
            "  _Vind,_kias |   ____Q,rad/s | \n   -10.42649 |       0.00079 | \n   1 | 2 | \n",
        )
        .unwrap();
        assert_eq!(table.names.as_deref().unwrap(), ["Vind", "Q"]);
        assert_eq!(
            table.units,
            [Some("kias".to_owned()), Some("rad/s".to_owned())]
        );
        assert_eq!(table.columns, [[-10.42649, 1.0], [0.00079, 2.0]]);
    }

    #[test]
    fn headings_can_be_given_instead_of_those_in_the_file() {
        let table = read("w,P [dB],x\n1,2,3\n2,3,4\n").unwrap();
        assert_eq!(table.headings(), ["w", "P [dB]", "x"]);
        let said = ["f [Hz]", "", "phase [deg]"].map(str::to_owned);
        let table = table.with_headings(&said).unwrap();
        assert_eq!((table.headings(), table.columns.len()), (said.to_vec(), 3));
        assert_eq!(table.units[2].as_deref(), Some("deg"));
        let found = FoundContent::HeadingCount {
            headings: 2,
            columns: 3,
        };
        assert!(matches!(
            table.with_headings(&said[..2]),
            Err(VariableFault::Format { found: reported, .. }) if reported == found
        ));
    }

    #[test]
    fn comments_rules_and_blank_lines_are_skipped() {
        let text = "% by a tool\n# w mag ph\n-------\n1 2 3\n\n! middle\n4 5 6 # behind\n// end\n";
        let table = read(text).unwrap();
        assert_eq!(table.names.as_deref().unwrap(), ["w", "mag", "ph"]);
        assert_eq!(table.columns, [[1.0, 4.0], [2.0, 5.0], [3.0, 6.0]]);
        assert_eq!(
            table
                .skipped
                .iter()
                .map(|line| line.number)
                .collect::<Vec<_>>(),
            [1, 2, 3, 6, 8]
        );
    }

    #[test]
    fn fortran_writes_a_count_and_exponents_with_d() {
        let table = read("2\n 1.0D+03 -2.0D-01\n 2.0D+03  ****\n").unwrap();
        assert_eq!(table.columns[0], [1000.0, 2000.0]);
        let skipped = ReadingNote::SingleNumber {
            line: 1,
            columns: 2,
        };
        assert_eq!(table.notes[0], skipped);
        assert_eq!(missing(&table), 1);
    }

    #[test]
    fn faults_name_the_line() {
        let column_count = |found, expected, separator| LineFault::ColumnCount {
            found,
            expected,
            separator,
        };
        assert_eq!(
            line_fault("a,b,c\n1,2,3\n4,5\n"),
            (3, column_count(2, 3, "commas"))
        );
        let not_a_number = |column, cell: &str, is_decimal_comma| LineFault::NotANumber {
            column,
            cell: cell.to_owned(),
            is_decimal_comma,
        };
        assert_eq!(
            line_fault("1,2,3\n4,x,6\n"),
            (2, not_a_number(2, "x", false))
        );
        assert_eq!(
            line_fault("1,5;2\n1.5;3\n1,6;2\n"),
            (2, not_a_number(1, "1.5", true))
        );
        assert_eq!(
            line_fault("t;x;\n1;2;\n3;4;\n5;\n"),
            (4, column_count(1, 2, "semicolons"))
        );
        let text = LineFault::TextAmongRows {
            start: "t,x".to_owned(),
        };
        assert_eq!(line_fault("1,2\n3,4\nt,x\n"), (3, text));
        let found = |text: &str| match read(text) {
            Err(VariableFault::Format { found, .. }) => found,
            other => panic!("{other:?}"),
        };
        assert_eq!(found(" \n"), FoundContent::EmptyFile);
        let start = "hello world".to_owned();
        assert_eq!(found("hello world"), FoundContent::NoRow { start });
    }

    #[test]
    fn headings_in_the_middle_are_skipped_with_a_note() {
        let table = read("t,x\n1,2\n3,4\nt,x\n1,5\n").unwrap();
        assert_eq!(table.columns, [[1.0, 3.0, 1.0], [2.0, 4.0, 5.0]]);
        let repeated = ReadingNote::RepeatedHeading { line: 4 };
        assert!(table.notes.contains(&repeated));
        assert!(read("t,x\n1,2\nt,y\n").is_err());
    }

    #[test]
    fn a_slip_in_the_first_row_is_no_heading() {
        assert!(matches!(
            line_fault("w,m,p\n1,2,x\n4,5,6\n7,8,9"),
            (2, LineFault::NotANumber { column: 3, .. })
        ));
        assert!(matches!(
            line_fault("1,2\n4,5,6\n7,8,9"),
            (1, LineFault::ColumnCount { found: 2, .. })
        ));
    }

    #[test]
    fn an_empty_cell_is_no_separator_at_the_end() {
        let named = read("a,b,c,\n1,2,3,\n4,5,6,").unwrap();
        assert_eq!(named.columns.len(), 3);
        let empty = read(";1;2\n3;4;5\n").unwrap();
        assert!(empty.columns[0][0].is_nan());
    }

    #[test]
    fn columns_with_nothing_in_the_last_keep_it_if_it_has_a_name() {
        let table = read("a,b,c\n1,2,\n4,5,\n").unwrap();
        assert_eq!(table.names.as_deref().unwrap(), ["a", "b", "c"]);
        assert_eq!((table.columns.len(), missing(&table)), (3, 2));
    }

    #[test]
    fn tables_beyond_the_limit_are_refused_before_their_memory_is_taken() {
        let wide = "1,".repeat(1_000_000);
        assert!(matches!(read(&wide), Err(VariableFault::TooLarge { .. })));
        let stopped = read_table(
            "1,2",
            &ReadingBudget::new(1 << 20).stopped_by(std::sync::Arc::new(true.into())),
        );
        assert_eq!(stopped, Err(VariableFault::Stopped));
        assert!(matches!(read("1,2\0"), Err(VariableFault::Format { .. })));
    }

    proptest! {
        #[test]
        fn numbers_written_come_back(
            rows in prop::collection::vec(prop::collection::vec(-1e300..1e300, 3), 1..20),
            separator in prop::sample::select(vec![",", ";", "\t", " | ", "  "]),
        ) {
            let line = |row: &Vec<f64>| row.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(separator);
            let text = rows.iter().map(line).collect::<Vec<_>>().join("\n");
            let table = read(&text).unwrap();
            for (index, row) in rows.iter().enumerate() {
                let back: Vec<f64> = table.columns.iter().map(|column| column[index]).collect();
                prop_assert_eq!(&back, row);
            }
        }

        #[test]
        fn any_text_is_read_or_refused(text in "[0-9a-z,;| \\t\\n\"#%.eE+\\-\\[\\]()]{0,200}") {
            let _ = read(&text);
        }
    }
}
