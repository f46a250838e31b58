//! Matrices as text, as programs print them: a single matrix, or several with their names.
//!
//! ```text
//! A =                    name
//!   1.0e+03 *            common factor
//!   Columns 1 through 2  begins a part: a group of columns, printed in consecutive rows
//!     0.1   -2.0         row
//! B =
//!          u1     u2     column names, which may follow only a name with an equals sign
//!     x1  0.1   -2.0     row; it begins with a name, because there are column names
//! ```
//!
//! 1. Collect each matrix's rows, by part (`Reading::take_line`).
//! 2. Read each part as a table, join the parts side by side, and multiply the numbers by the
//!    common factor (`Reading::finish`).

use std::collections::HashSet;

use crate::formats::reading_note::ReadingNote;
use crate::formats::text::cell_number::cell_number;
use crate::formats::text::encoding::refuse_binary;
use crate::formats::text::lines::{comment, excerpt, is_rule, lines};
use crate::formats::text::matrix_lines::{
    NameLine, is_columns_line, is_number_word, is_row_of_numbers, name_line, scale_line,
};
use crate::formats::text::table_reader::read_table;
use crate::formats::text::text_table::TextTable;
use crate::formats::variables::{Array, Value, Variable};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};
use crate::variable_fault::found_content::FoundContent;
use crate::variable_fault::line_fault::LineFault;

/// Matrices read from a text, with notes.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMatrices {
    /// Matrices in order of appearance.
    pub variables: Vec<Variable>,
    /// Notes for the user on skipped lines and on choices.
    pub notes: Vec<ReadingNote>,
}

/// Reads a single matrix with a row on each line; skips comments, ruled lines and text above the
/// rows, such as column names.
///
/// # Errors
/// [`VariableFault`] if a row is incomplete or has an error, or if there are no numbers.
pub fn read_matrix(
    text: &str,
    name: &str,
    budget: &ReadingBudget,
) -> Result<Variable, VariableFault> {
    let table = read_table(text, budget)?;
    let single_number = table
        .skipped
        .iter()
        .find(|line| cell_number(&line.text, table.decimal_comma).is_some());
    if let Some(line) = single_number {
        return Err(VariableFault::line(
            name,
            line.number,
            LineFault::SingleNumber {
                columns: table.columns.len(),
            },
        ));
    }
    let value = joined(&[table], 1.0, budget, name)?;
    Ok(Variable {
        name: name.to_owned(),
        value,
    })
}

/// Reads named matrices: "A =", "A:" or "A" on a line, the rows on the following lines.
///
/// A common factor ("1.0e+03 *") is applied, columns printed in several parts ("Columns 1 through
/// 6") are joined, and row and column names are skipped.
///
/// # Errors
/// [`VariableFault`] for binary data, a duplicate name, numbers without a name, a row with an
/// error, parts with different row counts, a text without any named matrix, and an exhausted
/// budget.
pub fn read_matrices(text: &str, budget: &ReadingBudget) -> Result<NamedMatrices, VariableFault> {
    refuse_binary(text, "matrices with names")?;
    let mut reading = Reading {
        matrices: Vec::new(),
        notes: Vec::new(),
        budget,
    };
    // Step 1
    for (number, line) in lines(text) {
        budget.work(1, NO_VARIABLE)?;
        if !line.trim().is_empty() && comment(line).is_none() && !is_rule(line) {
            reading.take_line(number, line)?;
        }
    }
    // Step 2
    reading.finish()
}

/// Part of a matrix: consecutive rows with a group of columns.
#[derive(Default)]
struct Part {
    /// Each row's line number in the whole text.
    line_numbers: Vec<usize>,
    text: String,
}

/// A matrix as read, whose numbers are not yet parsed.
struct UnparsedMatrix {
    name: String,
    /// Line number of the matrix name.
    line: usize,
    /// Whether an equals sign follows the matrix name; then a single word below it is a column
    /// name.
    has_equals_sign: bool,
    /// Factor by which all numbers are multiplied.
    scale: f64,
    /// Whether each row begins with a name.
    has_row_names: bool,
    parts: Vec<Part>,
}

/// State while named matrices are read.
struct Reading<'m> {
    /// Matrices so far; new rows go to the last.
    matrices: Vec<UnparsedMatrix>,
    notes: Vec<ReadingNote>,
    budget: &'m ReadingBudget<'m>,
}

impl Reading<'_> {
    /// Reads a line that is neither empty nor a comment. Line kinds are tried in this order: matrix
    /// name, "Columns …", common factor, row, row that begins with a name, any other.
    fn take_line(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        if let Some(name_line) = name_line(line) {
            return if !name_line.has_equals_sign && self.awaits_columns() {
                self.take_column_names(number, line)
            } else {
                self.begin_matrix(number, &name_line)
            };
        }
        if is_columns_line(line) {
            self.begin_part();
            return Ok(());
        }
        if let Some(scale) = scale_line(line)
            && let Some(matrix) = self.matrices.last_mut()
        {
            matrix.scale = scale;
            return Ok(());
        }
        if is_row_of_numbers(line) {
            return self.take_row(number, line);
        }
        let has_row_names = self
            .matrices
            .last()
            .is_some_and(|matrix| matrix.has_row_names);
        if has_row_names
            && let Some((_, rest)) = line.trim_start().split_once(char::is_whitespace)
            && is_row_of_numbers(rest)
        {
            return self.take_row(number, rest);
        }
        self.take_other_line(number, line, has_row_names)
    }

    /// Reads a line that is neither a name nor a row. Words without numbers are column names where
    /// these may follow, or if the rows have names. Otherwise, a line with at least half numbers is
    /// a row with errors; any other line is skipped, with a note.
    fn take_other_line(
        &mut self,
        number: usize,
        line: &str,
        has_row_names: bool,
    ) -> Result<(), VariableFault> {
        let words = line.split_whitespace().count();
        let numbers = line
            .split_whitespace()
            .filter(|word| is_number_word(word))
            .count();
        if numbers == 0 && (self.awaits_columns() || has_row_names) {
            return self.take_column_names(number, line);
        }
        if 2 * numbers >= words {
            return Err(VariableFault::line(
                NO_VARIABLE,
                number,
                LineFault::NotARow {
                    start: excerpt(line),
                },
            ));
        }
        self.notes.push(ReadingNote::LineSkipped {
            line: number,
            start: excerpt(line),
        });
        Ok(())
    }

    /// Returns whether column names may follow: the last matrix has an equals sign and no rows yet.
    fn awaits_columns(&self) -> bool {
        self.matrices
            .last()
            .is_some_and(|matrix| matrix.has_equals_sign && matrix.parts.is_empty())
    }

    /// Begins a matrix at the line with its name.
    fn begin_matrix(
        &mut self,
        number: usize,
        name_line: &NameLine<'_>,
    ) -> Result<(), VariableFault> {
        let NameLine {
            name,
            has_equals_sign,
            rest,
        } = *name_line;
        self.budget.take(256 + name.len() as u64, 1, name)?;
        self.matrices.push(UnparsedMatrix {
            name: name.to_owned(),
            line: number,
            has_equals_sign,
            scale: 1.0,
            has_row_names: false,
            parts: Vec::new(),
        });
        if rest.is_empty() {
            Ok(())
        } else {
            self.take_row(number, rest)
        }
    }

    /// Reads a line with column names; the rows below it then begin with names.
    fn take_column_names(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        if let Some(matrix) = self.matrices.last_mut() {
            matrix.has_row_names = true;
        }
        self.notes.push(ReadingNote::ColumnNames {
            line: number,
            start: excerpt(line),
        });
        self.begin_part();
        Ok(())
    }

    /// Begins another part in the last matrix, unless its last part has no rows yet.
    fn begin_part(&mut self) {
        if let Some(matrix) = self.matrices.last_mut()
            && matrix
                .parts
                .last()
                .is_none_or(|part| !part.line_numbers.is_empty())
        {
            matrix.parts.push(Part::default());
        }
    }

    /// Adds a row to the last part of the last matrix.
    fn take_row(&mut self, number: usize, line: &str) -> Result<(), VariableFault> {
        let Some(matrix) = self.matrices.last_mut() else {
            return Err(VariableFault::line(
                NO_VARIABLE,
                number,
                LineFault::UnnamedNumbers,
            ));
        };
        self.budget
            .take(2 * line.len() as u64 + 32, 1, &matrix.name)?;
        if matrix.parts.is_empty() {
            matrix.parts.push(Part::default());
        }
        if let Some(part) = matrix.parts.last_mut() {
            part.line_numbers.push(number);
            part.text.push_str(line);
            part.text.push('\n');
        }
        Ok(())
    }

    /// Converts the matrices to variables; a name without numbers is only noted.
    fn finish(mut self) -> Result<NamedMatrices, VariableFault> {
        let mut variables: Vec<Variable> = Vec::with_capacity(self.matrices.len());
        let mut names = HashSet::with_capacity(self.matrices.len());
        for mut matrix in self.matrices {
            matrix.parts.retain(|part| !part.line_numbers.is_empty());
            let UnparsedMatrix { name, line, .. } = &matrix;
            if matrix.parts.is_empty() {
                self.notes.push(ReadingNote::NameWithoutNumbers {
                    line: *line,
                    name: name.clone(),
                });
                continue;
            }
            if !names.insert(name.clone()) {
                return Err(VariableFault::Duplicate { name: matrix.name });
            }
            if matrix.scale != 1.0 {
                self.notes.push(ReadingNote::PrintedWithFactor {
                    name: name.clone(),
                    factor: matrix.scale,
                });
            }
            let value = matrix.value(self.budget)?;
            variables.push(Variable {
                name: matrix.name,
                value,
            });
        }
        if variables.is_empty() {
            return Err(VariableFault::format(
                "matrices with names",
                FoundContent::NoNamedNumbers,
            ));
        }
        Ok(NamedMatrices {
            variables,
            notes: self.notes,
        })
    }
}

impl UnparsedMatrix {
    /// Parses the parts, and joins them.
    fn value(&self, budget: &ReadingBudget) -> Result<Value, VariableFault> {
        let mut tables = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            tables.push(part.table(&self.name, budget)?);
        }
        joined(&tables, self.scale, budget, &self.name)
    }
}

impl Part {
    /// Reads the part's rows; errors contain the line in the whole text.
    fn table(&self, name: &str, budget: &ReadingBudget) -> Result<TextTable, VariableFault> {
        let table = read_table(&self.text, budget).map_err(|fault| match fault {
            VariableFault::Line { line, fault, .. } => {
                VariableFault::line(name, self.line_number(line), fault)
            }
            other => other,
        })?;
        match table.skipped.first() {
            Some(line) => Err(VariableFault::line(
                name,
                self.line_number(line.number),
                LineFault::UnlikeOtherRows {
                    start: excerpt(&line.text),
                },
            )),
            None => Ok(table),
        }
    }

    /// Returns the line number in the whole text for a line number in the part.
    fn line_number(&self, line: usize) -> usize {
        let number = self.line_numbers.get(line.saturating_sub(1));
        number.copied().unwrap_or(line)
    }
}

/// Joins table columns into a matrix, and multiplies it by `scale`.
fn joined(
    tables: &[TextTable],
    scale: f64,
    budget: &ReadingBudget,
    name: &str,
) -> Result<Value, VariableFault> {
    let rows = tables.first().map_or(0, |table| table.lines.len());
    if let Some(other) = tables.iter().find(|table| table.lines.len() != rows) {
        return Err(VariableFault::line(
            name,
            other.lines.first().copied().unwrap_or(1),
            LineFault::PartRows {
                first: rows,
                other: other.lines.len(),
            },
        ));
    }
    let columns = tables.iter().map(|table| table.columns.len()).sum();
    budget.take((rows * columns) as u64, 8, name)?;
    // The tables hold their numbers by column: in order, these are the matrix columns.
    let values = tables
        .iter()
        .flat_map(|table| table.columns.iter().flatten())
        .map(|value| scale * value)
        .collect();
    Ok(Value::Array(Array::matrix(rows, columns, values)))
}

#[cfg(test)]
mod matrix_text_tests {
    use proptest::prelude::*;

    use super::*;

    fn read(text: &str) -> Result<NamedMatrices, VariableFault> {
        read_matrices(text, &ReadingBudget::new(1 << 22))
    }

    fn arrays(text: &str) -> Vec<(String, Array)> {
        let array = |variable: Variable| match variable.value {
            Value::Array(array) => (variable.name, array),
            other => panic!("{}", other.words()),
        };
        read(text)
            .unwrap()
            .variables
            .into_iter()
            .map(array)
            .collect()
    }

    #[test]
    fn one_matrix_fills_a_file() {
        let budget = ReadingBudget::new(1 << 20);
        let variable = read_matrix("x1,x2\n1,2\n3,4\n5,6", "A", &budget).unwrap();
        let expected = Array::matrix(3, 2, vec![1.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
        assert_eq!(
            variable,
            Variable {
                name: "A".to_owned(),
                value: Value::Array(expected)
            }
        );
        let ragged = read_matrix("1\n2 3\n4 5\n", "A", &budget).unwrap_err();
        assert_eq!(
            ragged,
            VariableFault::line("A", 1, LineFault::SingleNumber { columns: 2 })
        );
    }

    #[test]
    fn matrices_follow_their_names() {
        let found =
            arrays("# model\nA =\n\n  -1.0  2\n   0  1\n\nB:\n0\n1\nC (1x2)\n1;0,5\nx0 = 5\n");
        let matrix = |rows, columns, values: &[f64]| Array::matrix(rows, columns, values.to_vec());
        assert_eq!(
            found[0],
            ("A".to_owned(), matrix(2, 2, &[-1.0, 0.0, 2.0, 1.0]))
        );
        assert_eq!(found[1], ("B".to_owned(), matrix(2, 1, &[0.0, 1.0])));
        assert_eq!(found[2], ("C".to_owned(), matrix(1, 2, &[1.0, 0.5])));
        assert_eq!(found[3], ("x0".to_owned(), matrix(1, 1, &[5.0])));
    }

    #[test]
    fn factors_are_applied_and_parts_joined() {
        let text = "A =\n\n   1.0e+03 *\n\n  Columns 1 through 2\n\n    0.001  2\n    0.003  4\n\n  Column 3\n\n    5\n    6\n";
        let found = arrays(text);
        assert_eq!(
            found[0].1,
            Array::matrix(2, 3, vec![1.0, 3.0, 2000.0, 4000.0, 5000.0, 6000.0])
        );
    }

    #[test]
    fn a_printed_model_with_names_of_states_is_read() {
        let text = "sys =\n \n  A = \n       x1   x2\n   x1  -1    2\n   x2   0    1\n \n  B = \n       u1\n   x1   0\n   x2   1\n \
                    \nContinuous-time state-space model.\n";
        let found = arrays(text);
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].1, Array::matrix(2, 2, vec![-1.0, 0.0, 2.0, 1.0]));
        assert_eq!(
            found[1],
            ("B".to_owned(), Array::matrix(2, 1, vec![0.0, 1.0]))
        );
    }

    #[test]
    fn faults_name_the_line_and_the_matrix() {
        let fault = |text: &str| read(text).unwrap_err();
        assert_eq!(
            fault("1 2\n"),
            VariableFault::line("", 1, LineFault::UnnamedNumbers)
        );
        assert!(matches!(
            fault("A =\n1 2\n\n3\n"),
            VariableFault::Line { variable, line: 4, .. } if variable == "A"
        ));
        let start = "3 x".to_owned();
        assert_eq!(
            fault("A =\n1 2\n3 x\n"),
            VariableFault::line("", 3, LineFault::NotARow { start })
        );
        let name = "A".to_owned();
        assert_eq!(fault("A\n1\nA\n2\n"), VariableFault::Duplicate { name });
        assert_eq!(
            fault("A =\n"),
            VariableFault::format("matrices with names", FoundContent::NoNamedNumbers)
        );
    }

    proptest! {
        #[test]
        fn matrices_printed_come_back(values in prop::collection::vec(-1e9..1e9, 6), three: bool) {
            let (rows, columns) = if three { (3, 2) } else { (2, 3) };
            let array = Array::matrix(rows, columns, values);
            let row = |row: usize| (0..columns).map(|c| array.re[c * rows + row].to_string()).collect::<Vec<_>>().join("  ");
            let text = format!("M =\n{}\n", (0..rows).map(row).collect::<Vec<_>>().join("\n"));
            prop_assert_eq!(&arrays(&text)[0].1, &array);
        }

        #[test]
        fn any_text_is_read_or_refused(text in "[A-Cx0-9=:;,. \\n\\-e*+]{0,120}") {
            let _ = read(&text);
            let _ = read_matrix(&text, "A", &ReadingBudget::new(1 << 20));
        }
    }
}
