//! GNU Octave's `save -hdf5`: each value is a group with its type and parts.
//!
//! The container is read as any HDF5 file, with groups as structs, which are converted here to the
//! values they represent. Arrays are stored by columns, with their sides reversed.

use super::{Form, rows};
use crate::formats::strides::{Entries, Places, count};
use crate::formats::variables::{
    Array, CellArray, ElementKind, Object, StructArray, TextArray, Value, Variable,
};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Converts the values of a file written by Octave; returns the values of other files unchanged.
pub(crate) fn unwrapped(
    variables: Vec<Variable>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    if variables.is_empty()
        || !variables
            .iter()
            .all(|variable| typed(&variable.value).is_some())
    {
        return Ok(variables);
    }
    let value = |variable: Variable| {
        let value = decoded(&variable.value, &variable.name, budget)?;
        Ok(Variable {
            name: variable.name,
            value,
        })
    };
    variables.into_iter().map(value).collect()
}

/// Returns the type of a group, and its parts.
fn typed(value: &Value) -> Option<(&str, &Value)> {
    let Value::Struct(records) = value else {
        return None;
    };
    let [(first, kind), (second, value)] = records.fields.as_slice() else {
        return None;
    };
    match (kind.as_slice(), value.as_slice()) {
        ([Value::Text(kind)], [value]) if first == "type" && second == "value" => {
            Some((kind.texts.first()?, value))
        }
        _ => None,
    }
}

fn decoded(
    group: &Value,
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Value, VariableFault> {
    let Some((kind, value)) = typed(group) else {
        return Err(damaged(variable, "a group has no type and no value"));
    };
    budget.take(1, size_of::<Value>() as u64, variable)?;
    Ok(match (Form::of(kind), value) {
        (Some(Form::Text), Value::Array(codes)) => {
            Value::Text(texts(&turned(codes, variable, budget)?))
        }
        (Some(Form::Range), Value::Struct(parts)) => Value::Array(range(parts, variable, budget)?),
        (Some(Form::Cell), Value::Struct(parts)) => Value::Cell(cell(parts, variable, budget)?),
        (Some(Form::Cell), Value::Array(empty)) => Value::Cell(CellArray {
            shape: empty.shape.clone(),
            values: Vec::new(),
        }),
        (Some(Form::Sparse(_)), Value::Struct(parts)) => {
            Value::Array(sparse(parts, variable, budget)?)
        }
        (Some(Form::Struct | Form::Structs), Value::Struct(parts)) => Value::Struct(records(
            parts,
            Form::of(kind) == Some(Form::Structs),
            variable,
            budget,
        )?),
        (Some(Form::Class), Value::Struct(parts)) => {
            let class = parts.field("classname").and_then(<[Value]>::first);
            let Some(Value::Text(class)) = class else {
                return Err(damaged(variable, "an object has no class"));
            };
            let class = class.texts.first().cloned().unwrap_or_default();
            // The fields are in a separate group beside the class name.
            let Some(Value::Struct(fields)) = parts.field("value").and_then(<[Value]>::first)
            else {
                return Err(damaged(variable, "an object has no fields"));
            };
            Value::Object(Object {
                class,
                records: records(fields, true, variable, budget)?,
            })
        }
        (Some(Form::Scalar(_) | Form::Matrix(_) | Form::Diagonal(_)), Value::Array(array)) => {
            Value::Array(turned(array, variable, budget)?)
        }
        _ => Value::opaque(format!("a {kind} of GNU Octave"), "save it with -v7"),
    })
}

fn damaged(variable: &str, what: &str) -> VariableFault {
    VariableFault::damaged(variable, what, 0)
}

/// Returns the array with its sides reversed.
fn turned(
    array: &Array,
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Array, VariableFault> {
    budget.take(array.len() as u64, 16, variable)?;
    let Some(places) = Places::row_major(&array.shape) else {
        return Err(damaged(
            variable,
            "there are more elements than can be counted",
        ));
    };
    // Each element moves to its position in the file.
    let places: Vec<usize> = places.collect();
    let part = |values: &Vec<f64>| {
        let mut part = vec![0.0; values.len()];
        places
            .iter()
            .zip(values)
            .for_each(|(place, value)| part[*place] = *value);
        part
    };
    let shape = array.shape.iter().rev().copied().collect();
    Ok(Array {
        shape,
        kind: array.kind,
        re: part(&array.re),
        im: array.im.as_ref().map(part),
    })
}

/// Returns the texts in the rows of a byte array.
fn texts(codes: &Array) -> TextArray {
    let letters: Vec<u8> = codes.re.iter().map(|code| *code as i64 as u8).collect();
    rows(&letters, codes.shape.first().copied().unwrap_or(0))
}

fn number(parts: &StructArray, name: &str) -> Option<f64> {
    match parts.field(name)?.first()? {
        Value::Array(array) => array.re.first().copied(),
        _ => None,
    }
}

fn numbers<'p>(parts: &'p StructArray, name: &str) -> &'p [f64] {
    match parts.field(name).and_then(<[Value]>::first) {
        Some(Value::Array(array)) => &array.re,
        _ => &[],
    }
}

fn range(
    parts: &StructArray,
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Array, VariableFault> {
    let part = |name: &str| {
        number(parts, name).ok_or_else(|| damaged(variable, "a range has no base, limit and step"))
    };
    super::steps(
        [part("base")?, part("limit")?, part("increment")?],
        variable,
        budget,
    )
}

fn cell(
    parts: &StructArray,
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<CellArray, VariableFault> {
    let shape: Vec<usize> = numbers(parts, "dims")
        .iter()
        .rev()
        .map(|side| *side as usize)
        .collect();
    let members = parts
        .fields
        .iter()
        .filter(|(name, _)| name.starts_with('_'));
    let values = members.flat_map(|(_, values)| values).enumerate();
    let values: Vec<Value> = values
        .map(|(index, value)| decoded(value, &format!("{variable}{{{}}}", index + 1), budget))
        .collect::<Result<_, _>>()?;
    if count(&shape) != Some(values.len()) {
        return Err(damaged(
            variable,
            "a cell array has not as many values as its sides say",
        ));
    }
    Ok(CellArray { shape, values })
}

/// Returns records; fields that can have several values are cells with one value for each record.
fn records(
    parts: &StructArray,
    in_cells: bool,
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<StructArray, VariableFault> {
    let mut records = StructArray::one(Vec::new());
    for (name, values) in &parts.fields {
        let inner = format!("{variable}.{name}");
        let value = values
            .first()
            .map(|value| decoded(value, &inner, budget))
            .transpose()?;
        let values = match value {
            Some(Value::Cell(cell)) if in_cells => {
                if !records.fields.is_empty() && records.shape != cell.shape {
                    return Err(damaged(
                        &inner,
                        "a field has not as many values as there are records",
                    ));
                }
                records.shape = cell.shape;
                cell.values
            }
            value => value.into_iter().collect(),
        };
        records.fields.push((name.clone(), values));
    }
    Ok(records)
}

fn sparse(
    parts: &StructArray,
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Array, VariableFault> {
    let wrong = || damaged(variable, "the sparse matrix contradicts itself");
    let side = |name: &str| {
        number(parts, name)
            .filter(|side| *side >= 0.0)
            .map(|side| side as usize)
            .ok_or_else(wrong)
    };
    let rows = side("nr")?;
    let columns = side("nc")?;
    let whole = |name: &str| {
        numbers(parts, name)
            .iter()
            .map(|number| *number as usize)
            .collect::<Vec<usize>>()
    };
    let starts = whole("cidx");
    let indices = whole("ridx");
    let data = numbers(parts, "data").to_vec();
    budget.take(
        (starts.len() + 2 * indices.len() + data.len()) as u64,
        8,
        variable,
    )?;
    let stored = Entries::of_columns(
        [rows, columns],
        ElementKind::Float,
        indices,
        &starts,
        (data, None),
    );
    stored.ok_or_else(wrong)?.filled(variable, budget, wrong)
}
