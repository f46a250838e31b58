//! Tables of numbers in columns, written by programs and people.

use std::collections::BTreeMap;

use crate::formats::text::heading::{Heading, name_and_unit, names_one_more, numbers_mostly};
use crate::formats::text::separator::{Separator, cell_number, excerpt, lines, refuse_binary};
use crate::reading_budget::{ReadingBudget, VariableFault};

const EXPECTED: &str = "a table of numbers in columns";

/// A table of numbers in columns.
#[derive(Clone, Debug, PartialEq)]
pub struct TextTable {
    /// Column names, if the text has them.
    pub names: Option<Vec<String>>,
    /// Unit of each column, if the text has one.
    pub units: Vec<Option<String>>,
    /// The numbers, column by column. Missing numbers are NaN, which users of the table refuse with
    /// their position.
    pub columns: Vec<Vec<f64>>,
    /// Line number of each row, from 1.
    pub lines: Vec<usize>,
    /// Separator of the cells.
    pub separator: Separator,
    pub decimal_comma: bool,
    /// Comments and headings: line number and line.
    pub skipped: Vec<(usize, String)>,
    /// Decisions that could be different, in words.
    pub notes: Vec<String>,
}

impl TextTable {
    /// Returns the name of a column, if the text has it.
    pub(super) fn name(&self, column: usize) -> Option<&str> {
        self.names.as_ref()?.get(column).map(String::as_str)
    }

    /// Returns the column headings: "omega \[rad/s\]"; empty without a name.
    pub fn headings(&self) -> Vec<String> {
        let heading = |(column, unit): (usize, &Option<String>)| match unit {
            Some(unit) => format!("{} [{unit}]", self.name(column).unwrap_or_default())
                .trim()
                .to_owned(),
            None => self.name(column).unwrap_or_default().to_owned(),
        };
        self.units.iter().enumerate().map(heading).collect()
    }

    /// Returns the table with other headings, in the form of [`TextTable::headings`].
    ///
    /// # Errors
    /// The number of headings differs from the number of columns.
    pub fn with_headings(mut self, headings: &[String]) -> Result<Self, VariableFault> {
        if headings.len() != self.columns.len() {
            let found = format!(
                "{} headings for {} columns",
                headings.len(),
                self.columns.len()
            );
            return Err(VariableFault::format("one heading for each column", found));
        }
        let (names, units) = headings
            .iter()
            .map(|heading| name_and_unit(heading))
            .unzip();
        (self.names, self.units) = (Some(names), units);
        self.notes
            .push("the headings of the columns are those of the rules".to_owned());
        Ok(self)
    }
}

/// Reads a table of numbers in columns: recognises its separator, decimal mark, names and units.
pub fn read_table(text: &str, budget: &ReadingBudget) -> Result<TextTable, VariableFault> {
    refuse_binary(text, EXPECTED)?;
    let Some(layout) = Layout::recognise(text, budget)? else {
        return Err(no_numbers(text));
    };
    let mut reading = Reading::new(layout, budget)?;
    for (number, line) in lines(text) {
        reading.line(number, line)?;
    }
    reading.finish(text)
}

fn no_numbers(text: &str) -> VariableFault {
    let found = match excerpt(text).as_str() {
        "" => "an empty file".to_owned(),
        start => format!("no line that consists of numbers (it begins with \"{start}\")"),
    };
    VariableFault::format(EXPECTED, found)
}

/// A table during reading.
struct Reading<'m> {
    layout: Layout,
    budget: &'m ReadingBudget<'m>,
    columns: Vec<Vec<f64>>,
    lines: Vec<usize>,
    skipped: Vec<(usize, String)>,
    notes: Vec<String>,
}

impl<'m> Reading<'m> {
    fn new(layout: Layout, budget: &'m ReadingBudget<'m>) -> Result<Self, VariableFault> {
        // Memory of a column's header here, and of its unit and name later.
        budget.take(layout.columns as u64, 128, "")?;
        let columns = vec![Vec::new(); layout.columns];
        let lines = Vec::new();
        Ok(Self {
            layout,
            budget,
            columns,
            lines,
            skipped: Vec::new(),
            notes: Vec::new(),
        })
    }

    fn line(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        if line.trim().is_empty() {
            return Ok(());
        }
        let width = |layout: Layout| layout.width(line);
        if comment(line).is_some() {
            // "#N/A;1" and ";1;2" begin with a comment mark, but are rows.
            return match width(self.layout) {
                Some((width, empty)) if self.layout.fits(width, empty) => self.row(number, line),
                _ => self.skip(number, line),
            };
        }
        if is_rule(line) {
            return self.skip(number, line);
        }
        if !self.lines.is_empty() {
            return if self.repeats_heading(line) {
                self.notes
                    .push(format!("line {number} repeats a heading: the rows behind it are taken as more of the same"));
                self.skip(number, line)
            } else {
                self.row(number, line)
            };
        }
        match width(self.layout) {
            Some((width, empty)) if self.layout.fits(width, empty) => self.row(number, line),
            // A row count or a date: a single number is not a row of a table.
            Some((1, _)) => {
                let columns = self.layout.columns;
                self.notes.push(format!(
                    "line {number} holds one number, the table {columns} columns: passed over"
                ));
                self.skip(number, line)
            }
            Some(_) => self.row(number, line),
            None => self.heading(number, line),
        }
    }

    /// Whether a line repeats the heading, as written by programs that continue a record.
    fn repeats_heading(&self, line: &str) -> bool {
        let first_line = self.lines.first().copied().unwrap_or(0);
        let mut above = self
            .skipped
            .iter()
            .take(20)
            .take_while(|(number, _)| *number < first_line);
        above.any(|(_, heading)| heading.trim() == line.trim())
    }

    fn heading(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        let columns = self.layout.columns;
        let cells: Vec<_> = self
            .layout
            .cells(line)
            .take(columns + 2)
            .map(|cell| cell.into_owned())
            .collect();
        let fits = cells.len() == columns || cells.len() == columns + 1;
        if fits && numbers_mostly(&cells, self.layout) {
            self.row(number, line)
        } else {
            self.skip(number, line)
        }
    }

    fn skip(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        self.budget.take(2 * line.len() as u64 + 64, 1, "")?;
        self.skipped.push((number, line.to_owned()));
        Ok(())
    }

    fn row(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        if self.lines.is_empty()
            && self.layout.trailing
            && names_one_more(&self.skipped, self.layout)
        {
            self.layout.columns += 1;
            self.layout.trailing = false;
            self.columns.push(Vec::new());
        }
        // Vectors grow by doubling: up to half of their memory may be unused.
        self.budget.take(self.layout.columns as u64 + 1, 16, "")?;
        let mut cells = self.layout.cells(line);
        let mut ends_empty = false;
        for (index, column) in self.columns.iter_mut().enumerate() {
            let Some(cell) = cells.next() else {
                return Err(self.ragged(number, line));
            };
            let Some(value) = cell_number(&cell, self.layout.decimal_comma) else {
                return Err(VariableFault::line(
                    "",
                    number,
                    self.no_number(index, &cell, line),
                ));
            };
            ends_empty = cell.trim().is_empty();
            column.push(value);
        }
        let complete = match (cells.next(), cells.next()) {
            (None, _) => self.layout.fits(self.layout.columns, ends_empty),
            (Some(cell), None) => cell.trim().is_empty(),
            _ => false,
        };
        if !complete {
            return Err(self.ragged(number, line));
        }
        self.lines.push(number);
        Ok(())
    }

    fn no_number(&self, index: usize, cell: &str, line: &str) -> String {
        if self
            .layout
            .cells(line)
            .take(20)
            .all(|cell| cell_number(&cell, self.layout.decimal_comma).is_none())
        {
            let start = excerpt(line);
            return format!(
                "words among the rows (\"{start}\"); put # before them, or split the file if others follow"
            );
        }
        let mark = if self.layout.decimal_comma && cell.contains('.') {
            " (the decimal mark is the comma)"
        } else {
            ""
        };
        let cell = excerpt(cell);
        let place = index + 1;
        format!(
            "column {place} holds \"{cell}\", which is no number{mark}; correct it, or empty the cell"
        )
    }

    fn ragged(&self, number: usize, line: &str) -> VariableFault {
        let expected = self.layout.columns;
        let (found, ends_empty) = self
            .layout
            .cells(line)
            .fold((0, false), |(count, _), cell| {
                (count + 1, cell.trim().is_empty())
            });
        let found: usize = if self.layout.trailing && ends_empty {
            found - 1
        } else {
            found
        };
        let separator = self.layout.separator.words();
        let remedy = "complete the line, or split the file where the columns change";
        VariableFault::line(
            "",
            number,
            format!(
                "{found} columns, where the table has {expected} (between {separator}); {remedy}"
            ),
        )
    }

    fn finish(mut self, text: &str) -> Result<TextTable, VariableFault> {
        let Some(&first_line) = self.lines.first() else {
            return Err(no_numbers(text));
        };
        let above = self
            .skipped
            .iter()
            .take_while(|(number, _)| *number < first_line)
            .count();
        let Heading {
            names,
            units,
            notes,
        } = Heading::find(&self.skipped[..above], self.layout);
        self.notes.extend(notes);
        let Layout {
            separator,
            decimal_comma,
            columns,
            ..
        } = self.layout;
        if separator == Separator::Comma
            && columns == 2
            && !decimal_comma
            && names.is_none()
            && self.all_whole()
        {
            let note = "each line has one comma: read as two columns; numbers with a decimal comma look the same";
            self.notes.push(note.to_owned());
        }
        let Self {
            columns,
            lines,
            skipped,
            notes,
            ..
        } = self;
        Ok(TextTable {
            names,
            units,
            columns,
            lines,
            separator,
            decimal_comma,
            skipped,
            notes,
        })
    }

    fn all_whole(&self) -> bool {
        self.columns
            .iter()
            .flatten()
            .all(|value| value.fract() == 0.0)
    }
}

// Layout of the lines of a table.

/// Number of lines examined to recognise the layout.
const SAMPLE: usize = 200;
/// Marks at the beginning of a comment line.
const COMMENT_MARKS: [&str; 5] = ["#", "%", "//", "!", ";"];

/// Layout of the lines of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Separator of the cells.
    pub(super) separator: Separator,
    pub(super) decimal_comma: bool,
    /// Number of columns, without the empty column after a trailing separator on every line.
    pub(super) columns: usize,
    /// Whether a trailing separator on the examined lines leaves an empty cell.
    pub(super) trailing: bool,
}

/// Frequency of lines of one width.
#[derive(Clone, Copy, Default)]
struct Count {
    lines: usize,
    ending_empty: usize,
}

/// Number lines found with one candidate layout.
struct Tally {
    /// Its columns are not counted yet.
    layout: Layout,
    widths: BTreeMap<usize, Count>,
    lines: usize,
}

impl Layout {
    /// Finds the separator and the decimal mark for which most lines are number lines of one width;
    /// prefers the wider table in a tie; returns nothing if no line is a number line.
    pub(super) fn recognise(
        text: &str,
        budget: &ReadingBudget,
    ) -> Result<Option<Self>, VariableFault> {
        let mut tallies: Vec<Tally> = Vec::with_capacity(2 * Separator::ALL.len());
        for decimal_comma in [false, true] {
            let layout = |separator| Layout {
                separator,
                decimal_comma,
                columns: 0,
                trailing: false,
            };
            let tally = |separator| Tally {
                layout: layout(separator),
                widths: BTreeMap::new(),
                lines: 0,
            };
            tallies.extend(Separator::ALL.map(tally));
        }
        for (_, line) in lines(text) {
            budget.work(1, "")?;
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

    /// Returns the cells of a number line, without a trailing comment.
    pub(super) fn cells(self, line: &str) -> crate::formats::text::separator::Cells<'_> {
        self.separator.cells(without_comment(line))
    }

    /// Returns the number of cells of a line if all are numbers or missing and at least one is a
    /// number, and whether the last cell is empty.
    pub(super) fn width(self, line: &str) -> Option<(usize, bool)> {
        let mut width = 0;
        let mut numbers = 0;
        let mut empty = false;
        for cell in self.cells(line) {
            let number = cell_number(&cell, self.decimal_comma)?;
            width += 1;
            numbers += usize::from(!number.is_nan());
            empty = cell.trim().is_empty();
        }
        (numbers > 0).then_some((width, empty))
    }

    /// Whether a line with `width` cells fits: an additional empty cell may follow a trailing
    /// separator. If all lines end in a separator, the empty cell after it is not counted.
    pub(super) fn fits(self, width: usize, ends_empty: bool) -> bool {
        let expected = if self.trailing && ends_empty {
            self.columns + 1
        } else {
            self.columns
        };
        width == expected || (width == self.columns + 1 && ends_empty)
    }
}

impl Tally {
    fn count(&mut self, line: &str) {
        if let Some((width, ends_empty)) = self.layout.width(line) {
            let count = self.widths.entry(width).or_default();
            count.lines += 1;
            count.ending_empty += usize::from(ends_empty);
            self.lines += 1;
        }
    }

    /// Returns the most frequent width, the larger in a tie.
    fn layout(&self) -> Option<(usize, Layout)> {
        let (&width, count) = self
            .widths
            .iter()
            .max_by_key(|(width, count)| (count.lines, **width))?;
        let trailing = count.ending_empty == count.lines && width > 1;
        let columns = if trailing { width - 1 } else { width };
        Some((
            count.lines,
            Layout {
                columns,
                trailing,
                ..self.layout
            },
        ))
    }
}

/// Returns the text of a comment line after its mark.
pub(super) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let mark = COMMENT_MARKS.iter().find(|&&mark| line.starts_with(mark))?;
    Some(line.trim_start_matches(mark))
}

/// Whether a line is only a rule: "-----", "|---|---|", "=====".
pub(super) fn is_rule(line: &str) -> bool {
    line.trim().len() >= 3
        && line.bytes().all(|byte| b"-=+|:_ \t".contains(&byte))
        && !line.trim().contains("- -")
}

/// Returns a line without a trailing comment, whose mark is between blanks: "#N/A" and "50%"
/// contain such characters too.
fn without_comment(line: &str) -> &str {
    if !line.contains(['#', '%', '!', '/']) {
        return line;
    }
    let marks = [" # ", " % ", " ! ", " // ", "\t# ", "\t% ", "\t! "];
    marks
        .iter()
        .filter_map(|mark| line.find(mark))
        .min()
        .map_or(line, |end| &line[..end])
}

#[cfg(test)]
mod columns_tests {
    use proptest::prelude::*;

    use super::*;

    fn read(text: &str) -> Result<TextTable, VariableFault> {
        read_table(text, &ReadingBudget::new(1 << 24))
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
    fn headings_can_be_said_in_place_of_the_file_s() {
        let table = read("w,P [dB],x\n1,2,3\n2,3,4\n").unwrap();
        assert_eq!(table.headings(), ["w", "P [dB]", "x"]);
        let said = ["f [Hz]", "", "phase [deg]"].map(str::to_owned);
        let table = table.with_headings(&said).unwrap();
        assert_eq!((table.headings(), table.columns.len()), (said.to_vec(), 3));
        assert_eq!(table.units[2].as_deref(), Some("deg"));
        let fault = table.with_headings(&said[..2]).unwrap_err().to_string();
        assert!(fault.contains("2 headings for 3 columns"), "{fault}");
    }

    #[test]
    fn comments_rules_and_blank_lines_are_passed_over() {
        let text = "% by a tool\n# w mag ph\n-------\n1 2 3\n\n! middle\n4 5 6 # behind\n// end\n";
        let table = read(text).unwrap();
        assert_eq!(table.names.as_deref().unwrap(), ["w", "mag", "ph"]);
        assert_eq!(table.columns, [[1.0, 4.0], [2.0, 5.0], [3.0, 6.0]]);
        assert_eq!(
            table
                .skipped
                .iter()
                .map(|(line, _)| *line)
                .collect::<Vec<_>>(),
            [1, 2, 3, 6, 8]
        );
    }

    #[test]
    fn fortran_writes_a_count_and_exponents_with_d() {
        let table = read("2\n 1.0D+03 -2.0D-01\n 2.0D+03  ****\n").unwrap();
        assert_eq!(table.columns[0], [1000.0, 2000.0]);
        assert_eq!(
            table.notes[0],
            "line 1 holds one number, the table 2 columns: passed over"
        );
        assert_eq!(missing(&table), 1);
    }

    #[test]
    fn faults_name_the_line() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(
            message("a,b,c\n1,2,3\n4,5\n"),
            "line 3: 2 columns, where the table has 3 (between commas); \
             complete the line, or split the file where the columns change"
        );
        assert_eq!(
            message("1,2,3\n4,x,6\n"),
            "line 2: column 2 holds \"x\", which is no number; correct it, or empty the cell"
        );
        assert_eq!(
            message("1,5;2\n1.5;3\n1,6;2\n"),
            "line 2: column 1 holds \"1.5\", which is no number (the decimal mark is the comma); \
             correct it, or empty the cell"
        );
        assert!(
            message("t;x;\n1;2;\n3;4;\n5;\n")
                .starts_with("line 4: 1 columns, where the table has 2")
        );
        assert_eq!(
            message("1,2\n3,4\nt,x\n"),
            "line 3: words among the rows (\"t,x\"); put # before them, or split the file if others follow"
        );
        assert_eq!(
            message(" \n"),
            "expected a table of numbers in columns, found an empty file"
        );
        assert!(
            message("hello world")
                .contains("no line that consists of numbers (it begins with \"hello world\")")
        );
    }

    #[test]
    fn headings_in_the_middle_are_passed_over_with_a_note() {
        let table = read("t,x\n1,2\n3,4\nt,x\n1,5\n").unwrap();
        assert_eq!(table.columns, [[1.0, 3.0, 1.0], [2.0, 4.0, 5.0]]);
        assert!(
            table
                .notes
                .iter()
                .any(|note| note.starts_with("line 4 repeats a heading"))
        );
        assert!(read("t,x\n1,2\nt,y\n").is_err());
    }

    #[test]
    fn a_slip_in_the_first_row_is_no_heading() {
        assert!(
            read("w,m,p\n1,2,x\n4,5,6\n7,8,9")
                .unwrap_err()
                .to_string()
                .starts_with("line 2: column 3")
        );
        assert!(
            read("1,2\n4,5,6\n7,8,9")
                .unwrap_err()
                .to_string()
                .starts_with("line 1: 2 columns")
        );
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
    fn what_claims_too_much_is_refused_before_it_is_taken() {
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

#[cfg(test)]
mod layout_tests {
    use super::*;

    fn of(text: &str) -> Option<(Separator, bool, usize)> {
        let layout = Layout::recognise(text, &ReadingBudget::new(1 << 20)).unwrap()?;
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
        assert_eq!(
            of("1\t\t2\n100\t2\n3\t\t4\n400\t5"),
            Some((Separator::Blanks, false, 2))
        );
        assert_eq!(of("1\t\t2\n3\t\t4"), Some((Separator::Tab, false, 3)));
    }

    #[test]
    fn a_comment_behind_numbers_is_left_out() {
        assert_eq!(
            of("1 2 # first\n3 4 ! second"),
            Some((Separator::Blanks, false, 2))
        );
        assert_eq!(without_comment("1 #N/A 50%"), "1 #N/A 50%");
    }

    #[test]
    fn rules_are_seen() {
        assert!(is_rule("|---|---|") && is_rule("====") && !is_rule("- - -") && !is_rule("-1"));
    }
}
