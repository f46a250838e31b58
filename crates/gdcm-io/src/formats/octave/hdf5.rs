//! GNU Octave's `save -hdf5` format: each value is a group with its type and its parts.
//!
//! The file is read like any HDF5 file (`mat73`), with groups as structs, which are then converted
//! to the values that they represent:
//!
//! ```text
//! A/type    text such as "matrix"
//! A/value   numbers, text, or a group with the parts of the value:
//!             range          base, limit, increment
//!             cell array     dims, then _0, _1, ...: a group like A for each value
//!             struct         for each field, a group like A
//!             sparse matrix  nr, nc, cidx, ridx, data: compressed sparse columns
//!             object         classname, value: a group like that of a struct
//! ```
//!
//! Arrays are stored in column-major order with their dimensions reversed.

use crate::formats::element_order::{Places, element_count};
use crate::formats::octave::assembly::byte_rows;
use crate::formats::octave::form::Form;
use crate::formats::octave::range::Range;
use crate::formats::sparse_matrix::CompressedColumns;
use crate::formats::variables::{
    Array, CellArray, ElementKind, Object, StructArray, TextArray, Value, Variable,
};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unread::Unread;

/// How a struct's fields hold their values.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FieldValues {
    /// In a single record, each field holds its value directly.
    Direct,
    /// In a struct array or an object, each field is a cell array with a value per record.
    InCells,
}

/// Converts the groups in a file written by Octave to values; returns the values from any other
/// file unchanged. A file is from Octave if all its variables are groups with a type and a value.
pub(crate) fn convert_hdf5_groups(
    variables: Vec<Variable>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let is_from_octave = variables
        .iter()
        .all(|variable| OctaveGroup::from_value(&variable.value).is_some());
    if !is_from_octave {
        return Ok(variables);
    }
    let mut converted = Vec::new();
    for Variable { name, value } in variables {
        let value = convert_group(&value, &name, budget)?;
        converted.push(Variable { name, value });
    }
    Ok(converted)
}

/// Group that represents a value, with the members `type` and `value`.
struct OctaveGroup<'v> {
    type_name: &'v str,
    value: &'v Value,
}

impl<'v> OctaveGroup<'v> {
    /// Returns the type and the value; `None` unless these are the group's only members, and the
    /// type is a text.
    fn from_value(value: &'v Value) -> Option<Self> {
        let Value::Struct(records) = value else {
            return None;
        };
        let [(first, kinds), (second, values)] = records.fields.as_slice() else {
            return None;
        };
        if first != "type" || second != "value" {
            return None;
        }
        match (kinds.as_slice(), values.as_slice()) {
            ([Value::Text(kind)], [value]) => Some(Self {
                type_name: kind.texts.first()?,
                value,
            }),
            _ => None,
        }
    }
}

/// Converts a group to the value that it represents, which is opaque ([`Value::Opaque`]) if its
/// type is not supported; `variable` is the value's name in errors.
fn convert_group(
    group: &Value,
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Value, VariableFault> {
    let Some(OctaveGroup { type_name, value }) = OctaveGroup::from_value(group) else {
        return Err(damaged(variable, Damage::GroupParts));
    };
    budget.take(1, size_of::<Value>() as u64, variable)?;
    let Some(form) = Form::from_type_name(type_name) else {
        return Ok(unknown_value(type_name));
    };
    Ok(match (form, value) {
        (Form::Scalar(_) | Form::Matrix(_) | Form::Diagonal(_), Value::Array(array)) => {
            Value::Array(with_reversed_sides(array, variable, budget)?)
        }
        (Form::Text, Value::Array(codes)) => {
            Value::Text(texts(&with_reversed_sides(codes, variable, budget)?))
        }
        (Form::Cell, Value::Array(empty)) => Value::Cell(CellArray {
            shape: empty.shape.clone(),
            values: Vec::new(),
        }),
        (form, Value::Struct(parts)) => {
            let parts = GroupParts {
                parts,
                variable,
                budget,
            };
            match form {
                Form::Range => Value::Array(parts.range()?),
                Form::Cell => Value::Cell(parts.cell()?),
                Form::Sparse(_) => Value::Array(parts.sparse()?),
                Form::ScalarStruct => Value::Struct(parts.records(FieldValues::Direct)?),
                Form::StructArray => Value::Struct(parts.records(FieldValues::InCells)?),
                Form::Class => Value::Object(parts.object()?),
                _ => unknown_value(type_name),
            }
        }
        _ => unknown_value(type_name),
    })
}

/// Returns the opaque value for a type that is not supported.
fn unknown_value(type_name: &str) -> Value {
    Value::opaque(format!("a GNU Octave {type_name}"), Unread::OctaveType)
}

fn damaged(variable: &str, damage: Damage) -> VariableFault {
    VariableFault::damaged(variable, damage, 0)
}

/// Returns an array with its dimensions reversed: the elements, which the HDF5 reader moved from
/// row-major to column-major order, are put back into file order.
fn with_reversed_sides(
    array: &Array,
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Array, VariableFault> {
    budget.take(array.len() as u64, 16, variable)?;
    let Some(places) = Places::row_major(&array.shape) else {
        return Err(damaged(variable, Damage::ElementCount));
    };
    let places: Vec<usize> = places.collect();
    Ok(Array {
        shape: array.shape.iter().rev().copied().collect(),
        kind: array.kind,
        re: in_file_order(&array.re, &places),
        im: array.im.as_ref().map(|im| in_file_order(im, &places)),
    })
}

/// Moves each value to its position in the file; `places` holds the positions.
fn in_file_order(values: &[f64], places: &[usize]) -> Vec<f64> {
    let mut moved = vec![0.0; values.len()];
    for (&place, &value) in places.iter().zip(values) {
        moved[place] = value;
    }
    moved
}

/// Converts a byte array to a string for each row.
fn texts(codes: &Array) -> TextArray {
    let letters: Vec<u8> = codes.re.iter().map(|&code| code as i64 as u8).collect();
    byte_rows(&letters, codes.shape.first().copied().unwrap_or(0))
}

/// A value's parts: the members in its group.
struct GroupParts<'v> {
    parts: &'v StructArray,
    /// Value name for errors.
    variable: &'v str,
    budget: &'v ReadingBudget<'v>,
}

impl<'v> GroupParts<'v> {
    fn range(&self) -> Result<Array, VariableFault> {
        let range = Range {
            first: self.range_number("base")?,
            limit: self.range_number("limit")?,
            step: self.range_number("increment")?,
        };
        range.array(self.variable, self.budget)
    }

    fn range_number(&self, name: &str) -> Result<f64, VariableFault> {
        match self.number(name) {
            Some(number) => Ok(number),
            None => Err(self.damaged(Damage::RangeParts)),
        }
    }

    /// Converts a cell array, which has the dimensions `dims` and a member such as `_0` for each
    /// value.
    fn cell(&self) -> Result<CellArray, VariableFault> {
        let shape: Vec<usize> = self
            .numbers("dims")
            .iter()
            .rev()
            .map(|&side| side as usize)
            .collect();
        let mut values = Vec::new();
        for (name, members) in &self.parts.fields {
            if !name.starts_with('_') {
                continue;
            }
            for member in members {
                let inner = format!("{}{{{}}}", self.variable, values.len() + 1);
                values.push(convert_group(member, &inner, self.budget)?);
            }
        }
        if element_count(&shape) != Some(values.len()) {
            return Err(self.damaged(Damage::CellCount));
        }
        Ok(CellArray { shape, values })
    }

    fn object(&self) -> Result<Object, VariableFault> {
        let Some(Value::Text(class)) = self.member("classname") else {
            return Err(self.damaged(Damage::ObjectWithoutClass));
        };
        let class = class.texts.first().cloned().unwrap_or_default();
        // The fields are in a separate group next to the class name.
        let Some(Value::Struct(fields)) = self.member("value") else {
            return Err(self.damaged(Damage::ObjectWithoutFields));
        };
        let fields = GroupParts {
            parts: fields,
            ..*self
        };
        Ok(Object {
            class,
            records: fields.records(FieldValues::InCells)?,
        })
    }

    /// Converts the fields of a struct; the records are those of the fields' cell arrays, or a
    /// single one.
    fn records(&self, field_values: FieldValues) -> Result<StructArray, VariableFault> {
        let mut records = StructArray::one(Vec::new());
        for (name, values) in &self.parts.fields {
            let inner = format!("{}.{name}", self.variable);
            let values = match values.first() {
                None => Vec::new(),
                Some(value) => match convert_group(value, &inner, self.budget)? {
                    Value::Cell(cell) if field_values == FieldValues::InCells => {
                        if !records.fields.is_empty() && records.shape != cell.shape {
                            return Err(damaged(&inner, Damage::FieldLength));
                        }
                        records.shape = cell.shape;
                        cell.values
                    }
                    value => vec![value],
                },
            };
            records.fields.push((name.clone(), values));
        }
        Ok(records)
    }

    fn sparse(&self) -> Result<Array, VariableFault> {
        let shape = [self.side("nr")?, self.side("nc")?];
        let starts = self.integers("cidx");
        let rows = self.integers("ridx");
        let re = self.numbers("data").to_vec();
        let im = match self.member("data") {
            Some(Value::Array(array)) => array.im.clone(),
            _ => None,
        };
        let parts = if im.is_some() { 2 } else { 1 };
        let count = starts.len() + 2 * rows.len() + parts * re.len();
        self.budget.take(count as u64, 8, self.variable)?;
        let columns = CompressedColumns {
            shape,
            kind: ElementKind::Float,
            rows,
            starts,
            re,
            im,
        };
        columns
            .into_entries()
            .ok_or_else(|| self.sparse_contradiction())?
            .full_matrix(self.variable, self.budget, || self.sparse_contradiction())
    }

    /// Returns a dimension of a sparse matrix.
    fn side(&self, name: &str) -> Result<usize, VariableFault> {
        match self.number(name) {
            Some(side) if side >= 0.0 => Ok(side as usize),
            _ => Err(self.sparse_contradiction()),
        }
    }

    fn sparse_contradiction(&self) -> VariableFault {
        self.damaged(Damage::SparseMatrix)
    }

    fn damaged(&self, damage: Damage) -> VariableFault {
        damaged(self.variable, damage)
    }

    fn member(&self, name: &str) -> Option<&'v Value> {
        self.parts.field(name)?.first()
    }

    /// Returns the first number in the member `name`; `None` if the member is missing or has no
    /// numbers.
    fn number(&self, name: &str) -> Option<f64> {
        self.numbers(name).first().copied()
    }

    /// Returns the numbers in the member `name`; empty if the member is missing or not numeric.
    fn numbers(&self, name: &str) -> &'v [f64] {
        match self.member(name) {
            Some(Value::Array(array)) => &array.re,
            _ => &[],
        }
    }

    /// Returns the numbers in the member `name` as integers.
    fn integers(&self, name: &str) -> Vec<usize> {
        self.numbers(name)
            .iter()
            .map(|&number| number as usize)
            .collect()
    }
}
