//! Variables written as MATLAB or Octave statements: `A = [1 2; 3 4e-3]; % comment`.
//!
//! Supported are numbers, texts, matrices and cells of them, variables and fields assigned to them,
//! and models created by `ss`, `tf` and `zpk`. Nothing is computed or run: other statements are
//! reported with a remedy, and never guessed.

use std::collections::HashMap;

use crate::formats::strides::first_index_fastest;
use crate::formats::text::matlab_scanner::{
    MOST_NESTED, Position, Scanner, ValueError, begins_word, is_of_word, refused,
};
use crate::formats::text::separator::{excerpt, refuse_binary};
use crate::formats::variables::{
    Array, CellArray, ElementKind, StructArray, TextArray, Value, Variable,
};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Remedy for unsupported statements.
const REMEDY: &str = "write its numbers, or save the workspace in MATLAB: save -v7 workspace.mat";
/// Words that begin a block that may run never, once or repeatedly.
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
/// Functions that create a record from their arguments, and the corresponding fields. Name-value
/// pairs follow, after an optional sample time except for `struct`.
const RECORDS: [(&str, &[&str]); 4] = [
    ("ss", &["A", "B", "C", "D"]),
    ("tf", &["num", "den"]),
    ("zpk", &["z", "p", "k"]),
    ("struct", &[]),
];

/// Results of the statements.
#[derive(Clone, Debug, PartialEq)]
pub struct Statements {
    /// The variables in the order of their first assignment, with their last values. A value that
    /// is not understood is [`Value::Opaque`] with the reason, its line and its column.
    pub variables: Vec<Variable>,
    /// Descriptions of the statements that were not run.
    pub notes: Vec<String>,
}

/// Reads variables from MATLAB or Octave statements.
pub fn read_literals(text: &str, budget: &ReadingBudget) -> Result<Statements, VariableFault> {
    refuse_binary(text, "MATLAB statements")?;
    let mut reading = Reading {
        scanner: Scanner::new(text),
        budget,
        read: Statements {
            variables: Vec::new(),
            notes: Vec::new(),
        },
        places: HashMap::new(),
        blocks: 0,
    };
    while !reading.scanner.rest().is_empty() {
        budget.work(1, "")?;
        reading.statement()?;
    }
    Ok(reading.read)
}

struct Reading<'t, 'm> {
    scanner: Scanner<'t>,
    budget: &'m ReadingBudget<'m>,
    read: Statements,
    /// Indices of the variables.
    places: HashMap<&'t str, usize>,
    /// Number of open conditions and loops.
    blocks: usize,
}

impl<'t> Reading<'t, '_> {
    fn statement(&mut self) -> Result<(), VariableFault> {
        self.scanner.pass_blanks()?;
        let begin = self.scanner.position();
        let start = self.scanner.at;
        match self.scanner.peek() {
            None => return Ok(()),
            Some('\n' | '\r') => {
                self.scanner.new_line();
                return Ok(());
            }
            Some(';' | ',') => {
                self.scanner.at += 1;
                return Ok(());
            }
            Some('[') => return self.results(begin, start),
            Some(_) => {}
        }
        let path = self.scanner.path(self.budget)?;
        let behind = self.scanner.clone();
        self.scanner.pass_blanks()?;
        let is_equality = self.scanner.rest().starts_with("==");
        if !path.is_empty() && !is_equality && self.scanner.take("=") {
            return self.assignment(&path, begin);
        }
        match path.as_slice() {
            [word] if BLOCKS.contains(word) => {
                self.blocks += 1;
                self.pass_over(
                    begin,
                    start,
                    "is not run, and what is set in it is not read",
                )
            }
            [word] if BLOCK_ENDS.contains(word) => {
                self.blocks = self.blocks.saturating_sub(1);
                self.scanner.pass_statement(self.budget)
            }
            [] => self.pass_over(begin, start, "is not understood"),
            [name, ..] => {
                let changes_part = self.scanner.changes_part();
                self.scanner = behind;
                if !changes_part {
                    return self.pass_over(begin, start, "is not run");
                }
                let why = "only a part of it is set here; write the whole of it in one statement";
                self.set_unread(&[name], begin, why)?;
                self.scanner.pass_statement(self.budget)
            }
        }
    }

    fn pass_over(&mut self, begin: Position, start: usize, why: &str) -> Result<(), VariableFault> {
        let note = format!(
            "line {} (\"{}\") {why}",
            begin.line,
            excerpt(&self.scanner.text[start..])
        );
        self.budget.take(note.len() as u64 + 32, 1, "")?;
        self.read.notes.push(note);
        self.scanner.pass_statement(self.budget)
    }

    /// Skips "[a, b] = …", results of a function, which is not run.
    fn results(&mut self, begin: Position, start: usize) -> Result<(), VariableFault> {
        let line = self.scanner.rest_of_line();
        let names = line.split_once(']').filter(|(_, behind)| {
            let behind = behind.trim_start();
            behind.starts_with('=') && !behind.starts_with("==")
        });
        let Some((names, _)) = names else {
            return self.pass_over(begin, start, "is not run");
        };
        let why = "it is the result of a function, which is not run; write its value";
        let is_name = |name: &&str| begins_word(name);
        for name in names.split(|c: char| !is_of_word(c)).filter(is_name) {
            self.set_unread(&[name], begin, why)?;
        }
        self.scanner.pass_statement(self.budget)
    }

    fn assignment(&mut self, path: &[&'t str], begin: Position) -> Result<(), VariableFault> {
        let before = self.scanner.clone();
        let outcome = match self.blocks {
            0 => self.whole_value(),
            _ => refused(
                "it is set within a condition or a loop, which is not run; write its value outside",
                begin,
            ),
        };
        let name = || path.join(".");
        match outcome {
            Ok(value) => return self.set(path, value),
            Err(ValueError::Fault(fault)) => return Err(fault.of(name)),
            Err(ValueError::NotUnderstood { what, at }) => {
                self.scanner = before;
                self.set_unread(path, at, &what)?;
            }
        }
        self.scanner
            .pass_statement(self.budget)
            .map_err(|fault| fault.of(name))
    }

    /// Sets a variable to an unreadable value.
    fn set_unread(
        &mut self,
        path: &[&'t str],
        at: Position,
        what: &str,
    ) -> Result<(), VariableFault> {
        let why = format!("line {}, column {}: {what}", at.line, at.column);
        self.budget
            .take(why.len() as u64, 1, path.first().unwrap_or(&""))?;
        self.set(path, Value::opaque("an expression", why))
    }

    /// Sets a variable or one of its fields.
    fn set(&mut self, path: &[&'t str], value: Value) -> Result<(), VariableFault> {
        let Some((name, fields)) = path.split_first() else {
            return Ok(());
        };
        self.budget.take(
            path.iter().map(|part| part.len() as u64 + 128).sum(),
            2,
            name,
        )?;
        let variables = &mut self.read.variables;
        let place = *self.places.entry(name).or_insert_with(|| {
            variables.push(Variable {
                name: (*name).to_owned(),
                value: Value::Struct(StructArray::one(Vec::new())),
            });
            variables.len() - 1
        });
        set_field(&mut variables[place].value, fields, value);
        Ok(())
    }

    /// Reads a value with nothing after it.
    fn whole_value(&mut self) -> Result<Value, ValueError> {
        let value = self.value(0)?;
        self.scanner.pass_blanks()?;
        match self.scanner.peek() {
            None | Some(';' | ',' | '\n' | '\r') => Ok(value),
            Some(_) => refused(
                format!("nothing is computed here; {REMEDY}"),
                self.scanner.position(),
            ),
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, ValueError> {
        if depth > MOST_NESTED {
            return Err(VariableFault::too_deep("").into());
        }
        self.scanner.pass_blanks()?;
        let place = self.scanner.position();
        if let Some((re, im)) = self.complex(false)? {
            return Ok(Value::Array(Array {
                im: (im != 0.0).then(|| vec![im]),
                ..Array::matrix(1, 1, vec![re])
            }));
        }
        match self.scanner.peek() {
            Some('[') => self.matrix(),
            Some('{') => {
                let (rows, columns, values) = self.rows('}', place, |reading| {
                    reading.budget.take(4, 64, "")?;
                    reading.value(depth + 1)
                })?;
                Ok(Value::Cell(CellArray {
                    shape: vec![rows, columns],
                    values: first_index_fastest(&[rows, columns], values),
                }))
            }
            Some('\'' | '"') => Ok(Value::text(self.scanner.quoted(self.budget)?)),
            Some('@') => refused(format!("functions are not read; {REMEDY}"), place),
            None | Some('\n' | '\r' | ';' | ',') => {
                refused("a value is missing here; write it", place)
            }
            Some(_) => {
                let path = self.scanner.path(self.budget)?;
                let before = self.scanner.clone();
                self.scanner.pass_blanks()?;
                match path.as_slice() {
                    [] => refused(
                        format!("this is no number, text or matrix; {REMEDY}"),
                        place,
                    ),
                    [function] if self.scanner.take("(") => self.call(function, place, depth),
                    path => {
                        self.scanner = before;
                        self.copy(path, place)
                    }
                }
            }
        }
    }

    /// Reads a signed number, or a complex number such as `1 - 2i`, if there is one at this
    /// position.
    fn complex(&mut self, in_matrix: bool) -> Result<Option<(f64, f64)>, ValueError> {
        let before = self.scanner.clone();
        let Some((value, imaginary)) = self.signed()? else {
            self.scanner = before;
            return Ok(None);
        };
        let behind = self.scanner.clone();
        let spaced = self.scanner.pass_blanks()?;
        let is_sign = matches!(self.scanner.peek(), Some('+' | '-'));
        let separate = in_matrix
            && spaced
            && !self.scanner.rest()[usize::from(is_sign)..].starts_with([' ', '\t']);
        if is_sign
            && !imaginary
            && !separate
            && let Ok(Some((im, true))) = self.signed()
        {
            return Ok(Some((value, im)));
        }
        self.scanner = behind;
        Ok(Some(if imaginary {
            (0.0, value)
        } else {
            (value, 0.0)
        }))
    }

    fn signed(&mut self) -> Result<Option<(f64, bool)>, ValueError> {
        let mut sign = 1.0;
        loop {
            match self.scanner.peek() {
                Some('-') => sign = -sign,
                Some('+') => {}
                _ => break,
            }
            self.scanner.at += 1;
            self.scanner.pass_blanks()?;
            self.budget.work(1, "")?;
        }
        if let Some((value, imaginary)) = self.scanner.number()? {
            return Ok(Some((sign * value, imaginary)));
        }
        Ok(match self.scanner.name() {
            Some("inf" | "Inf") => Some((sign * f64::INFINITY, false)),
            Some("nan" | "NaN") => Some((f64::NAN, false)),
            _ => None,
        })
    }

    /// Reads rows of elements after an opening bracket up to the closing bracket; blanks separate
    /// elements.
    fn rows<T>(
        &mut self,
        close: char,
        opening: Position,
        mut element: impl FnMut(&mut Self) -> Result<T, ValueError>,
    ) -> Result<(usize, usize, Vec<T>), ValueError> {
        self.scanner.at += 1;
        let mut elements = Vec::new();
        let mut columns = 0;
        let mut row = 0;
        let mut rows = 0;
        loop {
            let spaced = self.scanner.pass_blanks()?;
            let place = self.scanner.position();
            let next = self.scanner.peek();
            let ends_row = matches!(next, Some(';' | '\n' | '\r')) || next == Some(close);
            if ends_row && row > 0 {
                columns = if rows == 0 { row } else { columns };
                rows += 1;
                if row != columns {
                    let what = format!(
                        "row {rows} has {row} columns, the first {columns}; complete the shorter"
                    );
                    return refused(what, opening);
                }
                row = 0;
            }
            match next {
                None => return refused("the bracket is never closed; close it", opening),
                Some('\n' | '\r') => self.scanner.new_line(),
                Some(';' | ',') => self.scanner.at += 1,
                Some(sign) => {
                    self.scanner.at += if sign == close { 1 } else { 0 };
                    if sign == close {
                        return Ok((rows, columns, elements));
                    }
                    let space_behind =
                        self.scanner.rest()[sign.len_utf8()..].starts_with([' ', '\t']);
                    let is_operator = if spaced {
                        space_behind && "+-*/^:.\\".contains(sign)
                    } else {
                        "+-*/^:.\\'".contains(sign)
                    };
                    let before = self.scanner.text[..self.scanner.at]
                        .trim_end()
                        .chars()
                        .next_back();
                    if row > 0 && before != Some(',') && is_operator {
                        return refused(format!("nothing is computed here; {REMEDY}"), place);
                    }
                    self.budget.take(2, size_of::<T>() as u64, "")?;
                    elements.push(element(self)?);
                    row += 1;
                }
            }
        }
    }

    /// Reads a matrix of numbers, transposed if a quote follows it, or of texts in double quotes.
    fn matrix(&mut self) -> Result<Value, ValueError> {
        enum Element {
            Number(f64, f64),
            Text(String),
        }
        let opening = self.scanner.position();
        let (rows, columns, elements) = self.rows(']', opening, |reading| {
            let place = reading.scanner.position();
            match reading.complex(true)? {
                Some((re, im)) => Ok(Element::Number(re, im)),
                None if reading.scanner.peek() == Some('"') => {
                    Ok(Element::Text(reading.scanner.quoted(reading.budget)?))
                }
                None if reading.scanner.peek() == Some('\'') => refused(
                    "texts in brackets are not put together; write {'A', 'B'}",
                    place,
                ),
                None => refused(
                    format!("only numbers are read in brackets; {REMEDY}"),
                    place,
                ),
            }
        })?;
        self.budget
            .take(elements.len() as u64, 2 * size_of::<Element>() as u64, "")?;
        let transposed = self.scanner.take("'");
        let count = elements.len();
        let elements = if transposed {
            elements
        } else {
            first_index_fastest(&[rows, columns], elements)
        };
        let (rows, columns) = if transposed {
            (columns, rows)
        } else {
            (rows, columns)
        };
        let mut re = Vec::new();
        let mut im = Vec::new();
        let mut texts = Vec::new();
        for element in elements {
            match element {
                Element::Number(real, imaginary) => {
                    re.push(real);
                    im.push(if transposed { -imaginary } else { imaginary });
                }
                Element::Text(text) => texts.push(text),
            }
        }
        let shape = vec![rows, columns];
        if texts.is_empty() {
            let im = im.iter().any(|part| *part != 0.0).then_some(im);
            return Ok(Value::Array(Array {
                shape,
                kind: ElementKind::Float,
                re,
                im,
            }));
        }
        match texts.len() == count && !transposed {
            true => Ok(Value::Text(TextArray { shape, texts })),
            false => refused(
                "numbers and texts cannot stand in the same brackets; write {…} instead of […]",
                opening,
            ),
        }
    }

    /// Reads a record that a function creates from its arguments, or a matrix of equal numbers.
    fn call(&mut self, function: &str, place: Position, depth: usize) -> Result<Value, ValueError> {
        let mut arguments = Vec::new();
        let known = RECORDS.iter().find(|(name, _)| *name == function);
        let is_known =
            known.is_some() || matches!(function, "zeros" | "ones" | "eye" | "string" | "char");
        if !is_known {
            return refused(
                format!("{function}(…) is not computed here; {REMEDY}"),
                place,
            );
        }
        loop {
            self.scanner.pass_blanks()?;
            if arguments.is_empty() && self.scanner.take(")") {
                break;
            }
            self.budget.take(2, size_of::<Value>() as u64, "")?;
            arguments.push(self.value(depth + 1)?);
            self.scanner.pass_blanks()?;
            if self.scanner.take(")") {
                break;
            }
            if !self.scanner.take(",") {
                return refused(
                    format!("nothing is computed here; {REMEDY}"),
                    self.scanner.position(),
                );
            }
        }
        match (known, function, arguments.as_slice()) {
            (Some((_, fields)), ..) => {
                record_of(function, fields, arguments).or_else(|what| refused(what, place))
            }
            (None, "string" | "char", [text @ Value::Text(_)]) => Ok(text.clone()),
            (None, ..) => filled(function, &arguments, self.budget, place),
        }
    }

    /// Copies a variable or one of its fields.
    fn copy(&self, path: &[&str], place: Position) -> Result<Value, ValueError> {
        let Some((name, fields)) = path.split_first() else {
            return refused("a name is missing", place);
        };
        let Some(&at) = self.places.get(name) else {
            return refused(format!("{name} is not known here; write its value"), place);
        };
        let mut value = &self.read.variables[at].value;
        for field in fields {
            value = match value {
                Value::Struct(records) if let Some([only]) = records.field(field) => only,
                _ => return refused(format!("{} has no field {field}", path.join(".")), place),
            };
        }
        if let Value::Opaque { .. } = value {
            return refused(
                format!("{} could not be read itself", path.join(".")),
                place,
            );
        }
        self.budget.take(memory_of(value, 0)?, 1, "")?;
        Ok(value.clone())
    }
}

/// Builds a record from arguments and field names, followed by the optional sample time Ts \[s\]
/// and name-value pairs.
fn record_of(function: &str, names: &[&str], arguments: Vec<Value>) -> Result<Value, String> {
    let mut rest = arguments.into_iter().peekable();
    let mut fields: Vec<(String, Vec<Value>)> = Vec::new();
    for name in names {
        let value = rest
            .next()
            .filter(|value| matches!(value, Value::Array(_) | Value::Cell(_)));
        let value =
            value.ok_or_else(|| format!("{function}(…) needs numbers for {}", names.join(", ")))?;
        fields.push(((*name).to_owned(), vec![value]));
    }
    if let Some(step) = rest.next_if(|value| !names.is_empty() && !matches!(value, Value::Text(_)))
    {
        fields.push(("Ts".to_owned(), vec![step]));
    }
    while let Some(name) = rest.next() {
        let (Value::Text(name), Some(value)) = (name, rest.next()) else {
            return Err(format!(
                "names and values must stand in turn: {function}(…,'InputName',{{'LAT'}})"
            ));
        };
        if names.is_empty() && matches!(value, Value::Cell(_)) {
            return Err(
                "struct(…) of cells is an array of records; write s.name = {…} instead".to_owned(),
            );
        }
        let name = name.texts.concat();
        fields.retain(|(known, _)| *known != name);
        fields.push((name, vec![value]));
    }
    Ok(Value::Struct(StructArray::one(fields)))
}

/// Builds `zeros`, `ones` or `eye` of a number of rows and columns.
fn filled(
    function: &str,
    sides: &[Value],
    budget: &ReadingBudget,
    place: Position,
) -> Result<Value, ValueError> {
    let side = |value: &Value| match value {
        Value::Array(array)
            if array.len() == 1 && array.re[0].fract() == 0.0 && array.re[0] < 1e15 =>
        {
            Some(array.re[0].max(0.0) as usize)
        }
        _ => None,
    };
    let (rows, columns) = match sides {
        [both] => (side(both), side(both)),
        [rows, columns] => (side(rows), side(columns)),
        _ => (None, None),
    };
    let Some((rows, columns)) = rows.zip(columns) else {
        return refused(
            format!("{function}(…) is read with its numbers of rows and columns only; {REMEDY}"),
            place,
        );
    };
    budget.take((rows as u64).saturating_mul(columns as u64), 8, "")?;
    let value = |at: usize| match function {
        "ones" => 1.0,
        "eye" if at % rows.max(1) == at / rows.max(1) => 1.0,
        _ => 0.0,
    };
    Ok(Value::Array(Array::matrix(
        rows,
        columns,
        (0..rows * columns).map(value).collect(),
    )))
}

fn set_field(target: &mut Value, path: &[&str], value: Value) {
    let Some((name, rest)) = path.split_first() else {
        *target = value;
        return;
    };
    let words = target.words();
    match target {
        Value::Struct(StructArray { fields, .. }) => {
            let place = fields
                .iter()
                .position(|(known, _)| known == name)
                .unwrap_or_else(|| {
                    fields.push((
                        (*name).to_owned(),
                        vec![Value::Struct(StructArray::one(Vec::new()))],
                    ));
                    fields.len() - 1
                });
            if let Some(slot) = fields[place].1.first_mut() {
                set_field(slot, rest, value);
            }
        }
        Value::Opaque { .. } => {}
        _ => {
            let why = format!("{words} is given a field {name}; use another name for one of them");
            *target = Value::opaque("a variable with a field", why);
        }
    }
}

/// Memory of a copy of a value \[bytes\].
fn memory_of(value: &Value, depth: usize) -> Result<u64, VariableFault> {
    if depth > MOST_NESTED {
        return Err(VariableFault::too_deep(""));
    }
    value.inner().try_fold(value.own_memory(), |memory, inner| {
        Ok(memory + memory_of(inner, depth + 1)?)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(text: &str) -> Result<Statements, VariableFault> {
        read_literals(text, &ReadingBudget::new(1 << 22))
    }

    fn value(text: &str) -> Value {
        let literals = read(text).unwrap();
        literals.variables.into_iter().next_back().unwrap().value
    }

    fn matrix(rows: usize, columns: usize, values: &[f64]) -> Value {
        Value::Array(Array::matrix(rows, columns, values.to_vec()))
    }

    fn why(text: &str) -> String {
        match value(text) {
            Value::Opaque { why, .. } => why,
            other => panic!("{}", other.words()),
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
            assert!(
                why(computed).contains("save -v7 workspace.mat"),
                "{computed}"
            );
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
    fn what_is_not_run_is_noted() {
        let text = "function out = f(x)\nclear all; clc\nclose all\nA = 1;\nplot(A)\nhold on\nend\n%{\nB = 2\n%}\n";
        let literals = read(text).unwrap();
        assert_eq!(literals.variables.len(), 1);
        assert_eq!(
            literals.notes[0],
            "line 1 (\"function out = f(x)\") is not run"
        );
        assert_eq!(literals.notes.len(), 6);
    }

    #[test]
    fn what_is_not_understood_is_opaque_and_the_rest_usable() {
        let text = "A = inv([1 2\n3 4]);\nB = A*2\nif x > 1, C = 1; end\nD = 5;\nE(2,1) = 3;\n[F, G] = size(A);\nD(1) = 2\nH = 7";
        let literals = read(text).unwrap();
        let reasons: Vec<_> = literals
            .variables
            .iter()
            .map(|variable| match &variable.value {
                Value::Opaque { why, .. } => format!("{} {why}", variable.name),
                _ => variable.name.clone(),
            })
            .collect();
        assert_eq!(
            reasons,
            [
                &format!("A line 1, column 5: inv(…) is not computed here; {REMEDY}"),
                "B line 3, column 5: A could not be read itself",
                "C line 4, column 11: it is set within a condition or a loop, which is not run; write its value outside",
                "D line 8, column 1: only a part of it is set here; write the whole of it in one statement",
                "E line 6, column 1: only a part of it is set here; write the whole of it in one statement",
                "F line 7, column 1: it is the result of a function, which is not run; write its value",
                "G line 7, column 1: it is the result of a function, which is not run; write its value",
                "H",
            ]
        );
    }

    #[test]
    fn errors_say_where_and_what_to_write() {
        assert_eq!(
            why("A = [1 2; 3];"),
            "line 1, column 5: row 2 has 1 columns, the first 2; complete the shorter"
        );
        assert_eq!(
            why("\nA = \n"),
            "line 2, column 5: a value is missing here; write it"
        );
        assert_eq!(
            why("A = @(x) x"),
            format!("line 1, column 5: functions are not read; {REMEDY}")
        );
        assert_eq!(
            why("A = 'open"),
            "line 1, column 5: a text begins here and has no end; write ' behind it"
        );
        let part = "line 1, column 8: only a part of it is set here; write the whole of it in one statement";
        assert_eq!(why("A = 1; A += 2"), part);
        assert_eq!(why("A = 1; A++"), part);
        assert_eq!(
            why("A = x(1)"),
            format!("line 1, column 5: x(…) is not computed here; {REMEDY}")
        );
        assert_eq!(why("A = 3x"), "line 1, column 5: \"3x\" is no number");
    }

    #[test]
    fn what_never_ends_is_one_clear_fault() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(
            message("x = 1\nA = [1 2\n3 4\n"),
            "variable A: line 2: the bracket [ in column 5 is never closed; close it"
        );
        assert!(
            message("%{\nA = 1").starts_with("line 1: the comment opened here is never closed")
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
