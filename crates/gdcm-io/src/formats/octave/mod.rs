//! Files of GNU Octave's `save`: `-text` (the default), `-binary` and `-hdf5`, with or without
//! `-zip`.
//!
//! The formats are documented only by the source of Octave 7 (`ls-oct-text.cc`, `ls-oct-binary.cc`,
//! `ls-hdf5.cc` and the `ov-*.cc` files). Each value follows its name and the name of its type; its
//! form depends on the type. Text and binary encodings give the parts of a value in the same order,
//! so values are assembled here for both.

mod binary;
mod hdf5;
mod text;

use super::strides::{Entries, NumberClass, Places, count};
use super::variables::{Array, CellArray, ElementKind, Object, StructArray, TextArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};

pub(crate) use binary::OCTAVE_BINARY;
pub(crate) use hdf5::unwrapped;
pub(crate) use text::OCTAVE_TEXT;

/// Deepest nesting of values.
const DEEPEST: usize = 64;

/// Element type: kind of number, and whether each has an imaginary part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Element {
    /// Storage type in the binary form, and its size in bytes; a preceding byte gives the type of
    /// floats.
    stored: Option<(NumberClass, usize)>,
    complex: bool,
}

impl Element {
    const FLOAT: Self = Self {
        stored: None,
        complex: false,
    };

    fn kind(self) -> ElementKind {
        match self.stored {
            None => ElementKind::Float,
            Some((NumberClass::Logical, _)) => ElementKind::Logical,
            Some(_) => ElementKind::Integer,
        }
    }

    /// Separates real and imaginary parts; complex numbers are stored in pairs.
    fn parts(self, numbers: Vec<f64>) -> (Vec<f64>, Option<Vec<f64>>) {
        if !self.complex {
            return (numbers, None);
        }
        let part = |part: usize| numbers.iter().skip(part).step_by(2).copied().collect();
        (part(0), Some(part(1)))
    }

    /// Returns an array of numbers in the order of this program.
    fn array(self, shape: Vec<usize>, numbers: Vec<f64>) -> Array {
        let (re, im) = self.parts(numbers);
        Array {
            shape,
            kind: self.kind(),
            re,
            im,
        }
    }
}

/// Storage form of a value, from its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Scalar(Element),
    Matrix(Element),
    /// Only the diagonal is stored.
    Diagonal(Element),
    /// Only nonzero numbers are stored.
    Sparse(Element),
    /// First number, limit and step.
    Range,
    Text,
    Cell,
    /// A scalar struct.
    Struct,
    Structs,
    /// An object of an `@`-folder class.
    Class,
}

impl Form {
    /// Returns the form of a named type: "matrix", "float complex scalar", "uint8 matrix", "sparse
    /// bool matrix".
    fn of(name: &str) -> Option<Self> {
        match name {
            "string" | "sq_string" | "null_string" | "null_sq_string" => return Some(Self::Text),
            "cell" => return Some(Self::Cell),
            "scalar struct" => return Some(Self::Struct),
            "struct" => return Some(Self::Structs),
            "class" | "object" => return Some(Self::Class),
            "range" | "double_range" => return Some(Self::Range),
            _ => {}
        }
        let mut element = Element::FLOAT;
        let mut form: Option<fn(Element) -> Self> = None;
        for word in name.split(' ') {
            match word {
                "float" | "null" | "null_matrix" => {}
                "complex" => element.complex = true,
                "bool" => element.stored = Some((NumberClass::Logical, 1)),
                "diagonal" => form = Some(Self::Diagonal),
                "sparse" => form = Some(Self::Sparse),
                "scalar" => form = Some(Self::Scalar),
                "matrix" => form = form.or(Some(Self::Matrix)),
                _ => {
                    let bits = word.trim_start_matches('u').strip_prefix("int")?;
                    let size = ["8", "16", "32", "64"]
                        .iter()
                        .position(|known| *known == bits)?;
                    let class = if word.starts_with('u') {
                        NumberClass::Unsigned
                    } else {
                        NumberClass::Signed
                    };
                    element.stored = Some((class, 1 << size));
                }
            }
        }
        match (form, name) {
            (Some(form), _) => Some(form(element)),
            (None, "bool") => Some(Self::Scalar(element)),
            (None, "null_matrix") => Some(Self::Matrix(element)),
            _ => None,
        }
    }
}

/// Sides of an array, and whether its numbers are stored by rows.
struct Sides {
    shape: Vec<usize>,
    by_rows: bool,
}

/// Reads the consecutive parts of values in one of the encodings; `variable` is the name of the
/// value in faults.
trait Parts {
    fn budget(&self) -> &ReadingBudget<'_>;
    /// Reads name and type of the next value.
    fn member(&mut self, variable: &str) -> Result<(String, String), VariableFault>;
    fn sides(&mut self, variable: &str) -> Result<Sides, VariableFault>;
    /// Reads `count` numbers, or pairs of complex parts.
    fn numbers(
        &mut self,
        element: Element,
        count: usize,
        variable: &str,
    ) -> Result<Vec<f64>, VariableFault>;
    /// Reads the nonzero entries of a sparse matrix.
    fn sparse(&mut self, element: Element, variable: &str) -> Result<Entries, VariableFault>;
    fn text(&mut self, variable: &str) -> Result<TextArray, VariableFault>;
    /// Reads the number of members of a record.
    fn members(&mut self, form: Form, variable: &str) -> Result<usize, VariableFault>;
    fn class(&mut self, variable: &str) -> Result<String, VariableFault>;
    /// Returns a fault at this position.
    fn wrong(&self, variable: &str, what: &str) -> VariableFault;
}

/// Reads a value of a type.
fn value(
    parts: &mut dyn Parts,
    kind: &str,
    variable: &str,
    depth: usize,
) -> Result<Value, VariableFault> {
    if depth >= DEEPEST {
        return Err(VariableFault::too_deep(variable));
    }
    parts
        .budget()
        .take(1, size_of::<Value>() as u64, variable)?;
    let Some(form) = Form::of(kind.strip_prefix("global ").unwrap_or(kind)) else {
        let remedy = "save it without this variable, or with -v7";
        return Err(VariableFault::unsupported(
            variable,
            format!("a {kind} of GNU Octave"),
            remedy,
        ));
    };
    Ok(match form {
        Form::Scalar(element) => {
            Value::Array(element.array(vec![1, 1], parts.numbers(element, 1, variable)?))
        }
        Form::Matrix(element) => Value::Array(matrix(parts, element, variable)?),
        Form::Diagonal(element) => {
            let shape = parts.sides(variable)?.shape;
            let rows = shape[0];
            let columns = shape[1];
            let (re, im) = element.parts(parts.numbers(element, rows.min(columns), variable)?);
            let places = || (0..rows.min(columns)).collect();
            let stored = Entries {
                shape: [rows, columns],
                kind: element.kind(),
                rows: places(),
                columns: places(),
                re,
                im,
            };
            Value::Array(filled(parts, &stored, variable)?)
        }
        Form::Sparse(element) => {
            let stored = parts.sparse(element, variable)?;
            Value::Array(filled(parts, &stored, variable)?)
        }
        Form::Range => Value::Array(range(parts, variable)?),
        Form::Text => Value::Text(parts.text(variable)?),
        Form::Cell => {
            let shape = parts.sides(variable)?.shape;
            let length = counted(parts, &shape, size_of::<Value>() as u64, variable)?;
            let mut values = Vec::new();
            for index in 1..=length {
                let inner = format!("{variable}{{{index}}}");
                let (_, kind) = parts.member(&inner)?;
                values.push(value(parts, &kind, &inner, depth + 1)?);
            }
            Value::Cell(CellArray { shape, values })
        }
        Form::Struct => Value::Struct(records(parts, form, vec![1, 1], (variable, depth))?),
        Form::Structs => {
            let shape = parts.sides(variable)?.shape;
            Value::Struct(records(parts, form, shape, (variable, depth))?)
        }
        Form::Class => {
            let class = parts.class(variable)?;
            Value::Object(Object {
                class,
                records: records(parts, form, vec![1, 1], (variable, depth))?,
            })
        }
    })
}

/// Returns the number of elements after taking their memory.
fn counted(
    parts: &dyn Parts,
    shape: &[usize],
    size: u64,
    variable: &str,
) -> Result<usize, VariableFault> {
    let length = count(shape)
        .ok_or_else(|| parts.wrong(variable, "there are more elements than can be counted"))?;
    parts.budget().take(length as u64, size, variable)?;
    Ok(length)
}

fn matrix(parts: &mut dyn Parts, element: Element, variable: &str) -> Result<Array, VariableFault> {
    let Sides { shape, by_rows } = parts.sides(variable)?;
    let width = if element.complex { 2 } else { 1 };
    let length = counted(parts, &shape, 16 * width as u64, variable)?;
    let mut numbers = parts.numbers(element, length, variable)?;
    if by_rows && let Some(places) = Places::row_major(&shape) {
        numbers = places
            .flat_map(|place| &numbers[place * width..(place + 1) * width])
            .copied()
            .collect();
    }
    Ok(element.array(shape, numbers))
}

fn filled(parts: &dyn Parts, stored: &Entries, variable: &str) -> Result<Array, VariableFault> {
    stored.filled(variable, parts.budget(), || {
        parts.wrong(variable, "a number lies outside the matrix")
    })
}

/// Returns the texts in the rows of a byte array stored by columns.
fn rows(letters: &[u8], height: usize) -> TextArray {
    if letters.is_empty() {
        return TextArray::one("");
    }
    let row = |row: usize| {
        letters
            .iter()
            .skip(row)
            .step_by(height)
            .copied()
            .collect::<Vec<u8>>()
    };
    let texts = (0..height)
        .map(|of| String::from_utf8_lossy(&row(of)).into_owned())
        .collect();
    TextArray {
        shape: vec![height, 1],
        texts,
    }
}

/// Returns the fault for character arrays of more than two dimensions.
fn texts_in_pages(variable: &str) -> VariableFault {
    let what = "an array of texts of more than two dimensions";
    VariableFault::unsupported(variable, what, "save it as a cell array")
}

fn range(parts: &mut dyn Parts, variable: &str) -> Result<Array, VariableFault> {
    let numbers = parts.numbers(Element::FLOAT, 3, variable)?;
    match *numbers.as_slice() {
        [first, limit, step] => steps([first, limit, step], variable, parts.budget()),
        _ => Err(parts.wrong(variable, "a range has three numbers")),
    }
}

/// Returns the row of numbers from a first number to a limit in steps.
fn steps(
    [first, limit, step]: [f64; 3],
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Array, VariableFault> {
    // As in Octave: a limit missed by rounding alone is reached.
    let steps = ((limit - first) / step * (1.0 + f64::EPSILON)).floor();
    let length = if steps >= 0.0 {
        (steps as usize).saturating_add(1)
    } else {
        0
    };
    budget.take(length as u64, 8, variable)?;
    Ok(Array::matrix(
        1,
        length,
        (0..length)
            .map(|index| first + index as f64 * step)
            .collect(),
    ))
}

/// Returns the records of a struct or an object, whose members are cells of one value for each
/// record.
fn records(
    parts: &mut dyn Parts,
    form: Form,
    shape: Vec<usize>,
    (variable, depth): (&str, usize),
) -> Result<StructArray, VariableFault> {
    let count = counted(parts, &shape, size_of::<Value>() as u64, variable)?;
    let mut fields = Vec::new();
    for _ in 0..parts.members(form, variable)? {
        let (name, kind) = parts.member(variable)?;
        let inner = format!("{variable}.{name}");
        let values = match (form, value(parts, &kind, &inner, depth + 1)?) {
            (Form::Structs | Form::Class, Value::Cell(cell)) => cell.values,
            (_, value) => vec![value],
        };
        if values.len() != count {
            return Err(parts.wrong(
                &inner,
                "a field has not as many values as there are records",
            ));
        }
        fields.push((name, values));
    }
    Ok(StructArray { shape, fields })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::formats::variables::{Array, Value, Variable};
    use crate::formats::{Contents, import_bytes};
    use crate::reading_budget::ReadingBudget;

    fn bytes(name: &str) -> Vec<u8> {
        std::fs::read(format!(
            "{}/../../tests/data/foreign/octave/{name}",
            env!("CARGO_MANIFEST_DIR")
        ))
        .unwrap()
    }

    fn variables(bytes: &[u8], name: &str) -> Result<Vec<Variable>, String> {
        let budget = ReadingBudget::new(1 << 24);
        match import_bytes(bytes, Path::new(name), name, &budget)
            .map_err(|error| error.to_string())?
            .contents
        {
            Contents::Variables { variables, .. } => Ok(variables),
            _ => Err("no variables".to_owned()),
        }
    }

    /// Values saved by Octave 7.3 in three forms.
    const FORMS: [&str; 3] = ["kinds.txt", "kinds.bin", "kinds.h5.gz"];

    fn each_form(check: impl Fn(&dyn Fn(&str) -> Value, &str)) {
        for form in FORMS {
            let variables = variables(&bytes(form), form).unwrap();
            let value = |name: &str| {
                let found = variables.iter().find(|variable| variable.name == name);
                found
                    .unwrap_or_else(|| panic!("{form}: no {name}"))
                    .value
                    .clone()
            };
            check(&value, form);
        }
    }

    fn array(value: Value) -> Array {
        let Value::Array(array) = value else {
            panic!("{value:?} is no array")
        };
        array
    }

    #[test]
    fn numbers_of_every_kind_are_the_same_in_every_form() {
        each_form(|value, form| {
            let array = |name: &str| array(value(name));
            assert_eq!(array("x").re, [2.5], "{form}");
            assert_eq!(
                (array("z").re, array("z").im),
                (vec![1.0], Some(vec![2.0])),
                "{form}"
            );
            assert_eq!(
                array("M"),
                Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0]),
                "{form}"
            );
            assert_eq!(
                (array("Z").re, array("Z").im),
                (vec![1.0, 5.0, 3.0, 0.0], Some(vec![2.0, 0.0, -4.0, 6.0])),
                "{form}"
            );
            let cube = array("N3");
            assert_eq!(
                (cube.shape, cube.re[1], cube.re[6]),
                (vec![2, 3, 4], 2.0, 7.0),
                "{form}"
            );
            assert_eq!(
                (array("e").shape, array("e2").shape),
                (vec![0, 0], vec![0, 3]),
                "{form}"
            );
            assert_eq!(
                (array("b").re, array("bm").re, array("i8").re),
                (vec![1.0], vec![1.0, 0.0], vec![-3.0, 100.0])
            );
            assert_eq!(
                (array("u16").re, array("f").re, array("fs").re),
                (vec![7.0], vec![0.5, -0.25], vec![1.5])
            );
            assert_eq!(
                (array("r").re, array("r2").re),
                (vec![0.0, 0.5, 1.0, 1.5, 2.0], vec![5.0, 4.0, 3.0, 2.0, 1.0])
            );
            let sparse = vec![0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2.0];
            assert_eq!(
                (array("S").shape, array("S").re),
                (vec![3, 4], [&[0.0; 3][..], &sparse[3..]].concat()),
                "{form}"
            );
            assert_eq!(
                (array("col").shape, array("col").re),
                (vec![2, 1], vec![0.0, 5.0]),
                "{form}"
            );
            let odd = array("nanm").re;
            assert!(
                odd[0].is_nan()
                    && odd[1] == f64::INFINITY
                    && odd[2] == f64::NEG_INFINITY
                    && odd[3].is_nan(),
                "{form}"
            );
        });
    }

    #[test]
    fn texts_cells_structs_and_objects_are_the_same_in_every_form() {
        each_form(|value, form| {
            let texts = |value: Value| match value {
                Value::Text(text) => text.texts,
                other => panic!("{form}: {other:?} is no text"),
            };
            assert_eq!(texts(value("s")), ["hover"]);
            assert_eq!(texts(value("s2")), ["ab ", "cde"]);
            assert_eq!(
                (texts(value("sq")), texts(value("es"))),
                (vec!["it's".to_owned()], vec![String::new()]),
                "{form}"
            );
            let Value::Cell(cell) = value("c") else {
                panic!("{form}: no cell")
            };
            assert_eq!(
                (cell.shape, array(cell.values[1].clone()).re),
                (vec![2, 2], vec![3.0, 4.0]),
                "{form}"
            );
            assert_eq!(texts(cell.values[2].clone()), ["two"], "{form}");
            assert!(
                matches!(value("c0"), Value::Cell(cell) if cell.values.is_empty()),
                "{form}"
            );
            let Value::Struct(one) = value("st") else {
                panic!("{form}: no struct")
            };
            assert_eq!(texts(one.field("b").unwrap()[0].clone()), ["x"], "{form}");
            let Value::Struct(several) = value("sa") else {
                panic!("{form}: no structs")
            };
            assert_eq!(
                (several.shape.clone(), several.field("g").unwrap().len()),
                (vec![1, 3], 3),
                "{form}"
            );
            assert_eq!(
                texts(several.field("n").unwrap()[2].clone()),
                ["w"],
                "{form}"
            );
            assert!(
                matches!(value("t"), Value::Object(object) if object.class == "tf" && object.records.field("num").is_some())
            );
        });
    }

    #[test]
    fn a_diagonal_matrix_is_filled_up_and_what_is_not_read_is_named() {
        for form in ["kinds.txt", "kinds.bin"] {
            let variables = variables(&bytes(form), form).unwrap();
            let value = |name: &str| {
                variables
                    .iter()
                    .find(|variable| variable.name == name)
                    .unwrap()
                    .value
                    .clone()
            };
            assert_eq!(
                array(value("D2")),
                Array::matrix(2, 3, vec![2.0, 0.0, 0.0, 2.0, 0.0, 0.0])
            );
            let words = value("p").words();
            assert!(words.contains("permutation matrix"), "{words}");
        }
    }

    #[test]
    fn a_file_that_is_cut_off_or_damaged_is_an_error_or_fewer_values_and_never_a_panic() {
        for form in FORMS {
            let whole = bytes(form);
            for cut in (0..whole.len()).step_by(17) {
                let _ = variables(&whole[..cut], form);
                let mut damaged = whole.clone();
                damaged[cut] = damaged[cut].wrapping_add(1 + (cut % 200) as u8);
                let _ = variables(&damaged, form);
            }
        }
        let error = variables(&bytes("m_bin.bin")[..200], "m_bin.bin").unwrap_err();
        assert!(error.contains("cut off"), "{error}");
        let text = "# name: A\n# type: matrix\n# rows: 1\n# columns: 2\n 1 x\n";
        let error = variables(text.as_bytes(), "a.txt").unwrap_err();
        assert!(
            error.contains("variable A: line 5: expected a number"),
            "{error}"
        );
    }
}
