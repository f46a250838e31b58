//! MATLAB functions that create models, structs and filled matrices from their arguments.
//!
//! A model, such as `ss(A, B, C, D)`, becomes a struct with the arguments as its fields.

use crate::formats::text::matlab_value_position::{Position, ValueError, refused};
use crate::formats::variables::{Array, StructArray, Value};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget};
use crate::variable_fault::matlab_value_fault::MatlabFault;

/// Numbers of rows or columns from this limit on are rejected; all integers below it are exact as
/// floats.
const COUNT_LIMIT: f64 = 1e15;

/// A supported MATLAB function, by what it creates.
#[derive(Clone, Copy)]
pub(super) enum Function {
    /// A record: the first arguments are these fields, then follow an optional sample time (not for
    /// `struct`) and name-value pairs.
    Record(&'static [&'static str]),
    /// A matrix with zeros or ones, or the identity matrix.
    Fill(Fill),
    /// A string, returned unchanged (`string` and `char`); other arguments are treated as
    /// dimensions.
    Text,
}

/// Contents of a filled matrix.
#[derive(Clone, Copy)]
pub(super) enum Fill {
    Zeros,
    Ones,
    Identity,
}

#[derive(Clone, Copy)]
pub(super) struct Call<'n> {
    pub(super) name: &'n str,
    pub(super) function: Function,
    /// Position of the function name.
    pub(super) place: Position,
}

impl Function {
    /// Returns the function with this name; `None` for a function that is not supported.
    pub(super) fn find(name: &str) -> Option<Self> {
        Some(match name {
            "ss" => Self::Record(&["A", "B", "C", "D"]),
            "tf" => Self::Record(&["num", "den"]),
            "zpk" => Self::Record(&["z", "p", "k"]),
            "struct" => Self::Record(&[]),
            "zeros" => Self::Fill(Fill::Zeros),
            "ones" => Self::Fill(Fill::Ones),
            "eye" => Self::Fill(Fill::Identity),
            "string" | "char" => Self::Text,
            _ => return None,
        })
    }
}

impl Call<'_> {
    /// Creates the function's value; rejects unsuitable arguments at the position of the call.
    pub(super) fn value(
        self,
        arguments: Vec<Value>,
        budget: &ReadingBudget,
    ) -> Result<Value, ValueError> {
        match self.function {
            Function::Record(fields) => match record(self.name, fields, arguments) {
                Ok(record) => Ok(record),
                Err(fault) => refused(fault, self.place),
            },
            Function::Text => match arguments.as_slice() {
                [text @ Value::Text(_)] => Ok(text.clone()),
                // Treat other arguments as dimensions, as for `zeros`.
                sizes => self.filled(Fill::Zeros, sizes, budget),
            },
            Function::Fill(fill) => self.filled(fill, &arguments, budget),
        }
    }

    /// Creates a matrix from its numbers of rows and columns; a single number is used for both.
    fn filled(
        self,
        fill: Fill,
        sizes: &[Value],
        budget: &ReadingBudget,
    ) -> Result<Value, ValueError> {
        let size = match sizes {
            [both] => MatrixSize::parse(both, both),
            [rows, columns] => MatrixSize::parse(rows, columns),
            _ => None,
        };
        let Some(MatrixSize { rows, columns }) = size else {
            return refused(
                MatlabFault::FunctionDimensions {
                    function: self.name.to_owned(),
                },
                self.place,
            );
        };
        budget.take((rows as u64).saturating_mul(columns as u64), 8, NO_VARIABLE)?;
        let mut values = match fill {
            Fill::Ones => vec![1.0; rows * columns],
            Fill::Zeros | Fill::Identity => vec![0.0; rows * columns],
        };
        if let Fill::Identity = fill {
            for index in 0..rows.min(columns) {
                // Column-major order: a column has `rows` elements.
                values[index * rows + index] = 1.0;
            }
        }
        Ok(Value::Array(Array::matrix(rows, columns, values)))
    }
}

struct MatrixSize {
    rows: usize,
    columns: usize,
}

impl MatrixSize {
    fn parse(rows: &Value, columns: &Value) -> Option<Self> {
        Some(Self {
            rows: count_from(rows)?,
            columns: count_from(columns)?,
        })
    }
}

/// Converts a value to a number of rows or columns. Negative integers become 0, as in MATLAB;
/// returns `None` for anything but an integer below `COUNT_LIMIT`.
fn count_from(value: &Value) -> Option<usize> {
    let Value::Array(array) = value else {
        return None;
    };
    if array.len() != 1 || array.re[0].fract() != 0.0 || array.re[0] >= COUNT_LIMIT {
        return None;
    }
    Some(array.re[0].max(0.0) as usize)
}

/// Builds a record: the first arguments are the fields `names`, then follow an optional sample time
/// `Ts` \[s\] (only if there are `names`) and name-value pairs. Of fields with equal names, the
/// last is kept.
///
/// # Errors
/// The reason if arguments are missing or have the wrong type, or if a field for `struct` is a cell
/// array.
fn record(
    function: &str,
    names: &[&'static str],
    arguments: Vec<Value>,
) -> Result<Value, MatlabFault> {
    let mut rest = arguments.into_iter().peekable();
    let mut fields: Vec<(String, Vec<Value>)> = Vec::new();
    for name in names {
        match rest.next() {
            Some(value @ (Value::Array(_) | Value::Cell(_))) => {
                fields.push(((*name).to_owned(), vec![value]));
            }
            _ => {
                return Err(MatlabFault::FunctionArguments {
                    function: function.to_owned(),
                    names: names.to_vec(),
                });
            }
        }
    }
    let has_sample_time = !names.is_empty()
        && rest
            .peek()
            .is_some_and(|value| !matches!(value, Value::Text(_)));
    if has_sample_time && let Some(sample_time) = rest.next() {
        fields.push(("Ts".to_owned(), vec![sample_time]));
    }
    while let Some(name) = rest.next() {
        let (Value::Text(name), Some(value)) = (name, rest.next()) else {
            return Err(MatlabFault::NamesAndValues {
                function: function.to_owned(),
            });
        };
        if names.is_empty() && matches!(value, Value::Cell(_)) {
            return Err(MatlabFault::StructArray);
        }
        let name = name.texts.concat();
        fields.retain(|(known, _)| *known != name);
        fields.push((name, vec![value]));
    }
    Ok(Value::Struct(StructArray::one(fields)))
}
