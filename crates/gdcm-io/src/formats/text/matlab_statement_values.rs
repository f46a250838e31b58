//! Values in MATLAB or Octave statements: numbers, strings, matrices, cell arrays and models.
//!
//! Expressions are not evaluated. Anything that is not supported is refused at its position
//! (`refused`); the reader of statements then continues with the next statement.

use crate::formats::element_order::first_index_fastest;
use crate::formats::text::matlab_functions::{Call, Function};
use crate::formats::text::matlab_scanner::{Number, Scanner};
use crate::formats::text::matlab_value_position::{MOST_NESTED, Position, ValueError, refused};
use crate::formats::text::matlab_workspace::Workspace;
use crate::formats::variables::{Array, CellArray, ElementKind, TextArray, Value};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};
use crate::variable_fault::matlab_value_fault::MatlabFault;

/// Operators within brackets if blanks surround them. A sign with a blank before but not after it
/// begins the next element: `[1 -2]`.
const OPERATORS: &str = "+-*/^:.\\";
/// Operators within brackets if no blank precedes them; the quotation mark transposes.
const ATTACHED_OPERATORS: &str = "+-*/^:.\\'";

/// Where a number is written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum NumberPlace {
    /// Outside square brackets, where blanks do not matter.
    Alone,
    /// Between square brackets, where a blank may separate two elements.
    InMatrix,
}

/// Reads values, beginning at the scanner's position.
pub(super) struct ValueReader<'r, 't, 'm> {
    pub(super) scanner: &'r mut Scanner<'t>,
    pub(super) budget: &'r ReadingBudget<'m>,
    /// Variables assigned by earlier statements.
    pub(super) workspace: &'r Workspace<'t>,
}

struct ComplexNumber {
    re: f64,
    im: f64,
}

/// Elements between brackets, in row-major order.
struct Rows<T> {
    rows: usize,
    columns: usize,
    elements: Vec<T>,
}

enum Element {
    Number { re: f64, im: f64 },
    Text(String),
}

impl ValueReader<'_, '_, '_> {
    /// Reads a value; rejects a statement that continues after it.
    pub(super) fn read_whole_value(&mut self) -> Result<Value, ValueError> {
        let value = self.read_value(0)?;
        self.scanner.pass_blanks()?;
        match self.scanner.peek() {
            None | Some(';' | ',' | '\n' | '\r') => Ok(value),
            Some(_) => refuse_expression(self.scanner.position()),
        }
    }

    /// Reads a value, at nesting depth `depth`: a number, if there is one; else by the first
    /// character a matrix, a cell array or a string; else a function call, or a copy of a variable.
    fn read_value(&mut self, depth: usize) -> Result<Value, ValueError> {
        if depth > MOST_NESTED {
            return Err(VariableFault::too_deep(NO_VARIABLE).into());
        }
        self.scanner.pass_blanks()?;
        let place = self.scanner.position();
        if let Some(ComplexNumber { re, im }) = self.read_complex(NumberPlace::Alone)? {
            let im = if im == 0.0 { None } else { Some(vec![im]) };
            return Ok(Value::Array(Array {
                im,
                ..Array::matrix(1, 1, vec![re])
            }));
        }
        match self.scanner.peek() {
            Some('[') => self.read_matrix(),
            Some('{') => self.read_cell_array(place, depth),
            Some('\'' | '"') => Ok(Value::text(self.scanner.read_quoted(self.budget)?)),
            Some('@') => refused(MatlabFault::FunctionHandle, place),
            None | Some('\n' | '\r' | ';' | ',') => refused(MatlabFault::MissingValue, place),
            Some(_) => self.read_named_value(place, depth),
        }
    }

    /// Reads a function call, or a copy of a variable or field.
    fn read_named_value(&mut self, place: Position, depth: usize) -> Result<Value, ValueError> {
        let path = self.scanner.read_path(self.budget)?;
        let before = self.scanner.clone();
        self.scanner.pass_blanks()?;
        match path.as_slice() {
            [] => refused(MatlabFault::NotAValue, place),
            [function] if self.scanner.take("(") => self.read_call(function, place, depth),
            path => {
                *self.scanner = before;
                self.workspace.copy(path, place, self.budget)
            }
        }
    }

    /// Reads a real, imaginary or complex number at this position.
    ///
    /// 1. A number with its signs; `None`, without moving, if there is none.
    /// 2. If it is real, and a sign follows that continues it: the imaginary part, as in `1 - 2i`.
    /// 3. Otherwise, or if no imaginary number follows, the number of step 1 alone.
    fn read_complex(&mut self, place: NumberPlace) -> Result<Option<ComplexNumber>, ValueError> {
        // Step 1
        let before = self.scanner.clone();
        let Some(Number {
            value,
            is_imaginary,
        }) = self.read_signed()?
        else {
            *self.scanner = before;
            return Ok(None);
        };
        // Step 2
        let behind = self.scanner.clone();
        let is_spaced = self.scanner.pass_blanks()?;
        if !is_imaginary
            && self.sign_continues_number(place, is_spaced)
            && let Ok(Some(Number {
                value: im,
                is_imaginary: true,
            })) = self.read_signed()
        {
            return Ok(Some(ComplexNumber { re: value, im }));
        }
        // Step 3
        *self.scanner = behind;
        Ok(Some(if is_imaginary {
            ComplexNumber { re: 0.0, im: value }
        } else {
            ComplexNumber { re: value, im: 0.0 }
        }))
    }

    /// Returns whether a sign follows that continues the number before it; `is_spaced` states
    /// whether a blank is between them. In a matrix, the blank in `[1 -2i]` separates two elements,
    /// but not in `[1 - 2i]`, where another blank follows the sign.
    fn sign_continues_number(&self, place: NumberPlace, is_spaced: bool) -> bool {
        let Some(after_sign) = self.scanner.rest().strip_prefix(['+', '-']) else {
            return false;
        };
        place == NumberPlace::Alone || !is_spaced || after_sign.starts_with([' ', '\t'])
    }

    /// Reads a number, `Inf` or `NaN` with any signs before it. Returns `None` if there is no
    /// number, possibly after moving past signs or a name.
    fn read_signed(&mut self) -> Result<Option<Number>, ValueError> {
        let mut sign = 1.0;
        loop {
            match self.scanner.peek() {
                Some('-') => sign = -sign,
                Some('+') => {}
                _ => break,
            }
            self.scanner.at += 1;
            self.scanner.pass_blanks()?;
            self.budget.work(1, NO_VARIABLE)?;
        }
        if let Some(number) = self.scanner.read_number()? {
            return Ok(Some(Number {
                value: sign * number.value,
                ..number
            }));
        }
        let value = match self.scanner.read_name() {
            Some("inf" | "Inf") => sign * f64::INFINITY,
            Some("nan" | "NaN") => f64::NAN,
            _ => return Ok(None),
        };
        Ok(Some(Number {
            value,
            is_imaginary: false,
        }))
    }

    /// Reads rows from an opening bracket, at this position, to the closing bracket `close`;
    /// `read_element` reads an element. Commas or blanks separate elements, semicolons or line ends
    /// separate rows; empty rows do not count.
    fn read_rows<T>(
        &mut self,
        close: char,
        opening: Position,
        mut read_element: impl FnMut(&mut Self) -> Result<T, ValueError>,
    ) -> Result<Rows<T>, ValueError> {
        self.scanner.at += 1;
        let mut elements = Vec::new();
        let mut columns = 0;
        let mut rows = 0;
        let mut row_length = 0;
        loop {
            let is_spaced = self.scanner.pass_blanks()?;
            let place = self.scanner.position();
            let next = self.scanner.peek();
            let ends_row = matches!(next, Some(';' | '\n' | '\r')) || next == Some(close);
            if ends_row && row_length > 0 {
                if rows == 0 {
                    columns = row_length;
                }
                rows += 1;
                if row_length != columns {
                    let fault = MatlabFault::RowLength {
                        row: rows,
                        found: row_length,
                        expected: columns,
                    };
                    return refused(fault, opening);
                }
                row_length = 0;
            }
            match next {
                None => return refused(MatlabFault::OpenBracket, opening),
                Some('\n' | '\r') => self.scanner.new_line(),
                Some(';' | ',') => self.scanner.at += 1,
                Some(sign) if sign == close => {
                    self.scanner.at += 1;
                    return Ok(Rows {
                        rows,
                        columns,
                        elements,
                    });
                }
                Some(sign) => {
                    if row_length > 0 && self.is_operator(sign, is_spaced) {
                        return refuse_expression(place);
                    }
                    self.budget.take(2, size_of::<T>() as u64, NO_VARIABLE)?;
                    elements.push(read_element(self)?);
                    row_length += 1;
                }
            }
        }
    }

    /// Returns whether a character after an element is an operator, which this reader cannot
    /// evaluate: true in `[1 - 2]` and `[1-2]`, false in `[1 -2]` and `[1, - 2]`.
    fn is_operator(&self, sign: char, is_spaced: bool) -> bool {
        let before = self.scanner.text[..self.scanner.at]
            .trim_end()
            .chars()
            .next_back();
        if before == Some(',') {
            return false;
        }
        if !is_spaced {
            return ATTACHED_OPERATORS.contains(sign);
        }
        let behind = &self.scanner.rest()[sign.len_utf8()..];
        behind.starts_with([' ', '\t']) && OPERATORS.contains(sign)
    }

    fn read_cell_array(&mut self, opening: Position, depth: usize) -> Result<Value, ValueError> {
        let Rows {
            rows,
            columns,
            elements,
        } = self.read_rows('}', opening, |reader| {
            reader.budget.take(4, 64, NO_VARIABLE)?;
            reader.read_value(depth + 1)
        })?;
        Ok(Value::Cell(CellArray {
            shape: vec![rows, columns],
            values: first_index_fastest(&[rows, columns], elements),
        }))
    }

    /// Reads a numeric matrix, transposed if a quotation mark follows it, or a matrix of strings in
    /// double quotation marks.
    fn read_matrix(&mut self) -> Result<Value, ValueError> {
        let opening = self.scanner.position();
        let Rows {
            rows,
            columns,
            elements,
        } = self.read_rows(']', opening, Self::read_matrix_element)?;
        let count = elements.len();
        self.budget
            .take(count as u64, 2 * size_of::<Element>() as u64, NO_VARIABLE)?;
        let is_transposed = self.scanner.take("'");
        // Values are stored in column-major order, which for the transpose is the order as read,
        // row by row.
        let shape = if is_transposed {
            vec![columns, rows]
        } else {
            vec![rows, columns]
        };
        let by_column = if is_transposed {
            elements
        } else {
            first_index_fastest(&[rows, columns], elements)
        };
        let mut real_parts = Vec::new();
        let mut imaginary_parts = Vec::new();
        let mut texts = Vec::new();
        for element in by_column {
            match element {
                Element::Number { re, im } => {
                    real_parts.push(re);
                    // The quotation mark denotes the conjugate transpose.
                    imaginary_parts.push(if is_transposed { -im } else { im });
                }
                Element::Text(text) => texts.push(text),
            }
        }
        if texts.is_empty() {
            let is_complex = imaginary_parts.iter().any(|part| *part != 0.0);
            return Ok(Value::Array(Array {
                shape,
                kind: ElementKind::Float,
                re: real_parts,
                im: if is_complex {
                    Some(imaginary_parts)
                } else {
                    None
                },
            }));
        }
        if texts.len() < count || is_transposed {
            return refused(MatlabFault::MixedBrackets, opening);
        }
        Ok(Value::Text(TextArray { shape, texts }))
    }

    /// Reads an element between square brackets.
    fn read_matrix_element(&mut self) -> Result<Element, ValueError> {
        let place = self.scanner.position();
        if let Some(ComplexNumber { re, im }) = self.read_complex(NumberPlace::InMatrix)? {
            return Ok(Element::Number { re, im });
        }
        match self.scanner.peek() {
            Some('"') => Ok(Element::Text(self.scanner.read_quoted(self.budget)?)),
            Some('\'') => refused(MatlabFault::StringsInBrackets, place),
            _ => refused(MatlabFault::NotANumberInBrackets, place),
        }
    }

    /// Reads the arguments after a function call's opening bracket, and returns the function's
    /// value.
    fn read_call(
        &mut self,
        name: &str,
        place: Position,
        depth: usize,
    ) -> Result<Value, ValueError> {
        let Some(function) = Function::find(name) else {
            let function = name.to_owned();
            return refused(MatlabFault::FunctionCall { function }, place);
        };
        let mut arguments = Vec::new();
        loop {
            self.scanner.pass_blanks()?;
            if arguments.is_empty() && self.scanner.take(")") {
                break;
            }
            self.budget
                .take(2, size_of::<Value>() as u64, NO_VARIABLE)?;
            arguments.push(self.read_value(depth + 1)?);
            self.scanner.pass_blanks()?;
            if self.scanner.take(")") {
                break;
            }
            if !self.scanner.take(",") {
                return refuse_expression(self.scanner.position());
            }
        }
        let call = Call {
            name,
            function,
            place,
        };
        call.value(arguments, self.budget)
    }
}

/// Returns the error for an expression, because this reader evaluates none.
fn refuse_expression<T>(place: Position) -> Result<T, ValueError> {
    refused(MatlabFault::Expression, place)
}
