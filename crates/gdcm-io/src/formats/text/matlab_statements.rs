//! Variables written as MATLAB or Octave statements: `A = [1 2; 3 4e-3]; % comment`.
//!
//! Supported are numbers, strings, matrices and cell arrays containing these, variables and fields
//! on either side of `=`, and the functions `ss`, `tf`, `zpk`, `struct`, `zeros`, `ones`, `eye`,
//! `string` and `char`. Expressions are not evaluated and other statements not executed: they make
//! the assigned variable opaque, with a remedy, or are noted. An *opaque* value
//! ([`Value::Opaque`]) holds only the reason why the value could not be read.

use crate::formats::reading_note::{ReadingNote, SkippedStatement};
use crate::formats::text::encoding::refuse_binary;
use crate::formats::text::lines::excerpt;
use crate::formats::text::matlab_scanner::{Scanner, begins_name, is_name_character};
use crate::formats::text::matlab_statement_values::ValueReader;
use crate::formats::text::matlab_value_position::{Position, ValueError, refused};
use crate::formats::text::matlab_workspace::Workspace;
use crate::formats::variables::{Value, Variable};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};
use crate::variable_fault::matlab_value_fault::MatlabFault;
use crate::variable_fault::unread::Unread;

/// Words that begin a block, whose statements may be executed any number of times.
const BLOCKS: [&str; 8] = [
    "if",
    "for",
    "while",
    "switch",
    "try",
    "parfor",
    "do",
    "unwind_protect",
];
/// Words that end a block.
const BLOCK_ENDS: [&str; 9] = [
    "end",
    "endif",
    "endfor",
    "endwhile",
    "endswitch",
    "end_try_catch",
    "endparfor",
    "until",
    "end_unwind_protect",
];

/// Variables assigned by MATLAB or Octave statements, with notes.
#[derive(Clone, Debug, PartialEq)]
pub struct Statements {
    /// Variables ordered by first assignment, with their last values. An unsupported value is
    /// [`Value::Opaque`] with the reason, its line and its column.
    pub variables: Vec<Variable>,
    /// Notes for the user on statements that were skipped.
    pub notes: Vec<ReadingNote>,
}

/// Reads variables from MATLAB or Octave statements.
///
/// # Errors
/// [`VariableFault`] for binary data, unclosed brackets and block comments, and values nested too
/// deeply, and if the budget is exhausted. An unsupported value makes its variable opaque, and an
/// unsupported statement is noted instead.
pub fn read_statements(text: &str, budget: &ReadingBudget) -> Result<Statements, VariableFault> {
    refuse_binary(text, "MATLAB statements")?;
    let mut reading = Reading {
        scanner: Scanner::new(text),
        budget,
        workspace: Workspace::default(),
        notes: Vec::new(),
        open_blocks: 0,
    };
    while !reading.scanner.rest().is_empty() {
        budget.work(1, NO_VARIABLE)?;
        reading.read_statement()?;
    }
    Ok(Statements {
        variables: reading.workspace.variables,
        notes: reading.notes,
    })
}

/// State while statements are read.
struct Reading<'t, 'm> {
    scanner: Scanner<'t>,
    budget: &'m ReadingBudget<'m>,
    workspace: Workspace<'t>,
    notes: Vec<ReadingNote>,
    /// Number of blocks (`BLOCKS`) that are not closed.
    open_blocks: usize,
}

/// Beginning of a statement.
#[derive(Clone, Copy)]
struct Beginning {
    position: Position,
    /// Offset in the text \[bytes\].
    offset: usize,
}

impl<'t> Reading<'t, '_> {
    /// Reads or skips the next statement, or moves past a separator between statements.
    fn read_statement(&mut self) -> Result<(), VariableFault> {
        self.scanner.pass_blanks()?;
        let begin = Beginning {
            position: self.scanner.position(),
            offset: self.scanner.at,
        };
        match self.scanner.peek() {
            None => Ok(()),
            Some('\n' | '\r') => {
                self.scanner.new_line();
                Ok(())
            }
            Some(';' | ',') => {
                self.scanner.at += 1;
                Ok(())
            }
            Some('[') => self.read_function_results(begin),
            Some(_) => self.read_named_statement(begin),
        }
    }

    /// Reads a statement that does not assign function results. The first case that applies:
    ///
    /// 1. name and equals sign: an assignment;
    /// 2. no name, or a word that begins a block: skipped with a note; until the block ends,
    ///    assignments make their variables opaque;
    /// 3. a word that ends a block: skipped;
    /// 4. a name whose value is changed in part: the variable becomes opaque;
    /// 5. any other name: skipped with a note.
    fn read_named_statement(&mut self, begin: Beginning) -> Result<(), VariableFault> {
        let path = self.scanner.read_path(self.budget)?;
        let behind = self.scanner.clone();
        self.scanner.pass_blanks()?;
        let is_equality = self.scanner.rest().starts_with("==");
        // Case 1
        if !path.is_empty() && !is_equality && self.scanner.take("=") {
            return self.read_assignment(&path, begin.position);
        }
        match path.as_slice() {
            // Case 2
            [] => self.pass_over(begin, SkippedStatement::NotUnderstood),
            [word] if BLOCKS.contains(word) => {
                self.open_blocks += 1;
                self.pass_over(begin, SkippedStatement::Block)
            }
            // Case 3
            [word] if BLOCK_ENDS.contains(word) => {
                self.open_blocks = self.open_blocks.saturating_sub(1);
                self.scanner.pass_statement(self.budget)
            }
            // Cases 4 and 5
            [name, ..] => {
                let changes_part = self.scanner.changes_part();
                self.scanner = behind;
                if !changes_part {
                    return self.pass_over(begin, SkippedStatement::NotExecuted);
                }
                self.set_unread(&[name], begin.position, MatlabFault::PartSet)?;
                self.scanner.pass_statement(self.budget)
            }
        }
    }

    /// Skips a statement, and notes the reason.
    fn pass_over(
        &mut self,
        begin: Beginning,
        reason: SkippedStatement,
    ) -> Result<(), VariableFault> {
        let note = ReadingNote::StatementSkipped {
            line: begin.position.line,
            start: excerpt(&self.scanner.text[begin.offset..]),
            reason,
        };
        self.budget
            .take(note.to_string().len() as u64 + 32, 1, NO_VARIABLE)?;
        self.notes.push(note);
        self.scanner.pass_statement(self.budget)
    }

    /// Skips "[a, b] = …" and makes the variables opaque, because functions are not executed. Skips
    /// any other statement that begins with a square bracket, with a note.
    fn read_function_results(&mut self, begin: Beginning) -> Result<(), VariableFault> {
        let line = self.scanner.rest_of_line();
        let Some(names) = assigned_names(line) else {
            return self.pass_over(begin, SkippedStatement::NotExecuted);
        };
        for name in names.split(|c: char| !is_name_character(c)) {
            if begins_name(name) {
                self.set_unread(&[name], begin.position, MatlabFault::FunctionResult)?;
            }
        }
        self.scanner.pass_statement(self.budget)
    }

    /// Reads an assignment's value; an unsupported value makes the variable opaque.
    fn read_assignment(&mut self, path: &[&'t str], begin: Position) -> Result<(), VariableFault> {
        let before = self.scanner.clone();
        match self.read_assigned_value(begin) {
            Ok(value) => return self.workspace.set(path, value, self.budget),
            Err(ValueError::Fault(fault)) => return Err(fault.in_variable(|| path.join("."))),
            Err(ValueError::NotUnderstood { fault, at }) => {
                self.scanner = before;
                self.set_unread(path, at, fault)?;
            }
        }
        self.scanner
            .pass_statement(self.budget)
            .map_err(|fault| fault.in_variable(|| path.join(".")))
    }

    /// Reads the value after an assignment's equals sign; refuses it inside a block, which is not
    /// executed.
    fn read_assigned_value(&mut self, begin: Position) -> Result<Value, ValueError> {
        if self.open_blocks > 0 {
            return refused(MatlabFault::InBlock, begin);
        }
        let mut reader = ValueReader {
            scanner: &mut self.scanner,
            budget: self.budget,
            workspace: &self.workspace,
        };
        reader.read_whole_value()
    }

    /// Makes a variable or field opaque, for the reason `fault`.
    fn set_unread(
        &mut self,
        path: &[&'t str],
        at: Position,
        fault: MatlabFault,
    ) -> Result<(), VariableFault> {
        let why = Unread::Statement {
            line: at.line,
            column: at.column,
            fault,
        };
        self.budget
            .take(why.to_string().len() as u64, 1, path.first().unwrap_or(&""))?;
        let value = Value::opaque("an expression", why);
        self.workspace.set(path, value, self.budget)
    }
}

/// Returns "[a, b" from a line "[a, b] = …"; `None` if the line is not such an assignment.
fn assigned_names(line: &str) -> Option<&str> {
    let (names, behind) = line.split_once(']')?;
    let behind = behind.trim_start();
    if behind.starts_with('=') && !behind.starts_with("==") {
        Some(names)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formats::variables::{Array, CellArray, StructArray, TextArray};
    use crate::variable_fault::line_fault::LineFault;

    fn read(text: &str) -> Result<Statements, VariableFault> {
        read_statements(text, &ReadingBudget::new(1 << 22))
    }

    fn value(text: &str) -> Value {
        let literals = read(text).unwrap();
        literals.variables.into_iter().next_back().unwrap().value
    }

    fn matrix(rows: usize, columns: usize, values: &[f64]) -> Value {
        Value::Array(Array::matrix(rows, columns, values.to_vec()))
    }

    /// Returns the position of an unread value, and the reason.
    fn why(text: &str) -> (usize, usize, MatlabFault) {
        unread_statement(&value(text)).unwrap()
    }

    fn unread_statement(value: &Value) -> Option<(usize, usize, MatlabFault)> {
        let Value::Opaque { why, .. } = value else {
            return None;
        };
        match why.as_ref() {
            Unread::Statement {
                line,
                column,
                fault,
            } => Some((*line, *column, fault.clone())),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn matrices_are_rows_of_numbers() {
        assert_eq!(
            value("A = [1 2; 3, 4e-3]; % comment"),
            matrix(2, 2, &[1.0, 3.0, 2.0, 0.004])
        );
        assert_eq!(
            value("A = [1 2 ...\n 3\n 4,5,6 # six\n];"),
            matrix(2, 3, &[1.0, 4.0, 2.0, 5.0, 3.0, 6.0])
        );
        assert_eq!(value("A = []"), matrix(0, 0, &[]));
        assert_eq!(value("A = [1;2;3]'"), matrix(1, 3, &[1.0, 2.0, 3.0]));
        assert_eq!(value("a = 2, b = a"), matrix(1, 1, &[2.0]));
        assert_eq!(value("D = zeros(2, 1);"), matrix(2, 1, &[0.0, 0.0]));
        assert_eq!(value("E = eye(2);"), matrix(2, 2, &[1.0, 0.0, 0.0, 1.0]));
        assert_eq!(
            value("k = [1.5D2, -inf .5]"),
            matrix(1, 3, &[150.0, f64::NEG_INFINITY, 0.5])
        );
    }

    #[test]
    fn blanks_decide_between_sign_and_operator() {
        assert_eq!(value("A = [1 -2]"), matrix(1, 2, &[1.0, -2.0]));
        assert_eq!(value("A = [1, - 2]"), matrix(1, 2, &[1.0, -2.0]));
        for computed in [
            "A = [1 - 2]",
            "A = [1-2]",
            "A = [1 2*3]",
            "A = [1:3]",
            "A = 1 + 2",
            "A = 2*pi",
            "A = [1 2]*3",
        ] {
            assert_eq!(why(computed).2, MatlabFault::Expression, "{computed}");
        }
    }

    #[test]
    fn complex_numbers_are_written_with_i_or_j() {
        let Value::Array(array) = value("p = [1+2i, 3 - 1j; 0 1i]'") else {
            panic!()
        };
        assert_eq!(array.shape, [2, 2]);
        assert_eq!(
            (array.re, array.im.unwrap()),
            (vec![1.0, 3.0, 0.0, 0.0], vec![-2.0, 1.0, 0.0, -1.0])
        );
        let Value::Array(array) = value("p = [1 -2i]") else {
            panic!()
        };
        assert_eq!(
            (array.re, array.im.unwrap()),
            (vec![1.0, 0.0], vec![0.0, -2.0])
        );
    }

    #[test]
    fn texts_and_cells_of_texts_are_read() {
        let text = |text: &str| {
            Value::Text(TextArray {
                shape: vec![1, 1],
                texts: vec![text.to_owned()],
            })
        };
        assert_eq!(value("s = 'it''s'"), text("it's"));
        let cell = CellArray {
            shape: vec![1, 2],
            values: vec![text("LAT"), text("PED")],
        };
        assert_eq!(value("u = {'LAT','PED'};"), Value::Cell(cell.clone()));
        assert_eq!(value("u = {'LAT' 'PED'};"), Value::Cell(cell));
        let strings = TextArray {
            shape: vec![2, 1],
            texts: vec!["a".to_owned(), "bc".to_owned()],
        };
        assert_eq!(value("u = [\"a\"; \"bc\"]"), Value::Text(strings));
    }

    #[test]
    fn models_are_records_of_their_matrices() {
        let fields_of = |text: &str| {
            let Value::Struct(StructArray { fields, .. }) = value(text) else {
                panic!("{text}")
            };
            fields
        };
        let names = |text: &str| {
            fields_of(text)
                .into_iter()
                .map(|(name, _)| name)
                .collect::<Vec<_>>()
        };
        let text =
            "A=1; B=2; C=3; D=0;\nsys = ss(A,B,C,D);\nsys.InputName = {'LAT'};\nsys.Ts = 0.1;";
        assert_eq!(names(text), ["A", "B", "C", "D", "InputName", "Ts"]);
        assert_eq!(fields_of(text)[5].1, [matrix(1, 1, &[0.1])]);
        assert_eq!(
            names("s = ss(1,2,3,0,0.02,'InputName',{'LAT'});"),
            ["A", "B", "C", "D", "Ts", "InputName"]
        );
        assert_eq!(names("s = tf([1 2], [1 0 1]);"), ["num", "den"]);
        assert_eq!(names("s = zpk([], [-1 -2], 3);"), ["z", "p", "k"]);
        assert_eq!(value("s.a = 1; s.b.c = 2; t = s.b.c"), matrix(1, 1, &[2.0]));
    }

    #[test]
    fn statements_that_are_not_run_are_noted() {
        let text = "function out = f(x)\nclear all; clc\nclose all\nA = 1;\nplot(A)\nhold on\nend\n%{\nB = 2\n%}\n";
        let literals = read(text).unwrap();
        assert_eq!(literals.variables.len(), 1);
        let function = ReadingNote::StatementSkipped {
            line: 1,
            start: "function out = f(x)".to_owned(),
            reason: SkippedStatement::NotExecuted,
        };
        assert_eq!(literals.notes[0], function);
        assert_eq!(literals.notes.len(), 6);
    }

    #[test]
    fn values_not_understood_are_opaque_and_the_rest_usable() {
        let text = "A = inv([1 2\n3 4]);\nB = A*2\nif x > 1, C = 1; end\nD = 5;\nE(2,1) = 3;\n[F, G] = size(A);\nD(1) = 2\nH = 7";
        let literals = read(text).unwrap();
        let reasons: Vec<_> = literals
            .variables
            .iter()
            .map(|variable| (variable.name.as_str(), unread_statement(&variable.value)))
            .collect();
        let function = "inv".to_owned();
        let path = "A".to_owned();
        assert_eq!(
            reasons,
            [
                ("A", Some((1, 5, MatlabFault::FunctionCall { function }))),
                ("B", Some((3, 5, MatlabFault::CopyOfUnread { path }))),
                ("C", Some((4, 11, MatlabFault::InBlock))),
                ("D", Some((8, 1, MatlabFault::PartSet))),
                ("E", Some((6, 1, MatlabFault::PartSet))),
                ("F", Some((7, 1, MatlabFault::FunctionResult))),
                ("G", Some((7, 1, MatlabFault::FunctionResult))),
                ("H", None),
            ]
        );
    }

    #[test]
    fn unread_values_have_their_place_and_the_reason() {
        let row_length = MatlabFault::RowLength {
            row: 2,
            found: 1,
            expected: 2,
        };
        assert_eq!(why("A = [1 2; 3];"), (1, 5, row_length));
        assert_eq!(why("\nA = \n"), (2, 5, MatlabFault::MissingValue));
        assert_eq!(why("A = @(x) x"), (1, 5, MatlabFault::FunctionHandle));
        let open = MatlabFault::OpenString { quote: '\'' };
        assert_eq!(why("A = 'open"), (1, 5, open));
        assert_eq!(why("A = 1; A += 2"), (1, 8, MatlabFault::PartSet));
        assert_eq!(why("A = 1; A++"), (1, 8, MatlabFault::PartSet));
        let function = "x".to_owned();
        assert_eq!(
            why("A = x(1)"),
            (1, 5, MatlabFault::FunctionCall { function })
        );
        let text = "3x".to_owned();
        assert_eq!(why("A = 3x"), (1, 5, MatlabFault::NotANumber { text }));
    }

    #[test]
    fn unclosed_and_endless_statements_are_refused() {
        let open_bracket = LineFault::OpenBracket {
            bracket: '[',
            column: 5,
        };
        assert_eq!(
            read("x = 1\nA = [1 2\n3 4\n"),
            Err(VariableFault::line("A", 2, open_bracket))
        );
        assert_eq!(
            read("%{\nA = 1"),
            Err(VariableFault::line("", 1, LineFault::OpenComment))
        );
        assert!(matches!(
            read(&format!("A = {}", "[".repeat(100_000))),
            Err(VariableFault::TooDeep { .. })
        ));
        assert!(matches!(
            read(&format!("A = {}", "{".repeat(100_000))),
            Err(VariableFault::TooDeep { .. })
        ));
        assert!(matches!(
            read("A = zeros(1e5)"),
            Err(VariableFault::TooLarge { .. })
        ));
        assert!(matches!(read("A = 1\0"), Err(VariableFault::Format { .. })));
        let doubled = format!("a = {{1}};\n{}", "a = {a a};\n".repeat(60));
        assert!(matches!(
            read(&doubled),
            Err(VariableFault::TooLarge { .. })
        ));
        let nested = format!("a = {{1}};\n{}", "a = {a};\n".repeat(100));
        assert!(matches!(read(&nested), Err(VariableFault::TooDeep { .. })));
        let path = format!("a{} = 1", ".b".repeat(100));
        assert!(matches!(read(&path), Err(VariableFault::TooDeep { .. })));
    }

    #[test]
    fn long_lines_and_continuations_are_read() {
        let row = format!("A = [{}];", "1 ".repeat(20_000));
        assert!(matches!(value(&row), Value::Array(array) if array.len() == 20_000));
        assert_eq!(
            value(&format!("A = {}1", "- ".repeat(50_000))),
            matrix(1, 1, &[1.0])
        );
        assert_eq!(read(&"...\n".repeat(50_000)).unwrap().variables, []);
    }

    proptest! {
        #[test]
        fn matrices_written_come_back(values in prop::collection::vec(-1e300..1e300, 6)) {
            let row = |row: usize| format!("{:e} {:e}, {}", values[row], values[2 + row], values[4 + row]);
            let text = format!("M = [{};\n{}];", row(0), row(1));
            prop_assert_eq!(value(&text), matrix(2, 3, &values));
        }

        #[test]
        fn any_text_is_read_or_refused(text in "[A-Cijx0-9=:;,.'\"{}()\\[\\] \\n\\-+*/^%#e@]{0,120}") {
            let _ = read(&text);
        }

        #[test]
        fn any_characters_are_read_or_refused(text in ".{0,80}") {
            let _ = read(&text);
        }
    }
}
