//! Variables assigned by MATLAB or Octave statements.
//!
//! An *opaque* variable is one whose value could not be read; it holds the reason, and neither its
//! value nor its fields can be copied.

use std::collections::HashMap;

use crate::formats::text::matlab_value_position::{MOST_NESTED, Position, ValueError, refused};
use crate::formats::variables::{StructArray, Value, Variable};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};
use crate::variable_fault::matlab_value_fault::MatlabFault;
use crate::variable_fault::unread::Unread;

/// Variables and fields assigned so far.
#[derive(Default)]
pub(super) struct Workspace<'t> {
    /// Variables ordered by first assignment, with their last values.
    pub(super) variables: Vec<Variable>,
    /// Index in `variables`, by name.
    indices: HashMap<&'t str, usize>,
}

impl<'t> Workspace<'t> {
    /// Sets the variable or field at `path`; adds what is missing on the path.
    pub(super) fn set(
        &mut self,
        path: &[&'t str],
        value: Value,
        budget: &ReadingBudget,
    ) -> Result<(), VariableFault> {
        let Some((name, fields)) = path.split_first() else {
            return Ok(());
        };
        budget.take(
            path.iter().map(|part| part.len() as u64 + 128).sum(),
            2,
            name,
        )?;
        let index = match self.indices.get(name) {
            Some(index) => *index,
            None => self.add(name),
        };
        set_field(&mut self.variables[index].value, fields, value);
        Ok(())
    }

    /// Adds a variable with an empty struct as its value; returns its index.
    fn add(&mut self, name: &'t str) -> usize {
        let index = self.variables.len();
        self.indices.insert(name, index);
        self.variables.push(Variable {
            name: name.to_owned(),
            value: empty_struct(),
        });
        index
    }

    /// Returns a copy of the variable or field at `path`; `place` is the position of its name in
    /// the text.
    ///
    /// # Errors
    /// [`ValueError`] if the variable or field does not exist, is opaque or is nested too deeply,
    /// or if the budget is exhausted.
    pub(super) fn copy(
        &self,
        path: &[&str],
        place: Position,
        budget: &ReadingBudget,
    ) -> Result<Value, ValueError> {
        let Some((name, fields)) = path.split_first() else {
            return refused(MatlabFault::MissingName, place);
        };
        let Some(&index) = self.indices.get(name) else {
            return refused(
                MatlabFault::NotAssigned {
                    name: (*name).to_owned(),
                },
                place,
            );
        };
        let mut value = &self.variables[index].value;
        for field in fields {
            value = match value {
                Value::Struct(records) if let Some([only]) = records.field(field) => only,
                _ => {
                    let fault = MatlabFault::NoField {
                        path: path.join("."),
                        field: (*field).to_owned(),
                    };
                    return refused(fault, place);
                }
            };
        }
        if let Value::Opaque { .. } = value {
            return refused(
                MatlabFault::CopyOfUnread {
                    path: path.join("."),
                },
                place,
            );
        }
        budget.take(memory_of(value, 0)?, 1, NO_VARIABLE)?;
        Ok(value.clone())
    }
}

fn empty_struct() -> Value {
    Value::Struct(StructArray::one(Vec::new()))
}

/// Sets the field at `path` in a value, or the value itself for an empty path; adds missing fields.
/// A value that cannot have fields becomes opaque; an opaque value remains unchanged.
fn set_field(target: &mut Value, path: &[&str], value: Value) {
    let Some((name, rest)) = path.split_first() else {
        *target = value;
        return;
    };
    let words = target.words();
    match target {
        Value::Struct(StructArray { fields, .. }) => {
            let existing = fields.iter().position(|(existing, _)| existing == name);
            let index = existing.unwrap_or(fields.len());
            if existing.is_none() {
                fields.push(((*name).to_owned(), vec![empty_struct()]));
            }
            if let Some(field) = fields[index].1.first_mut() {
                set_field(field, rest, value);
            }
        }
        Value::Opaque { .. } => {}
        _ => {
            let why = Unread::FieldOfOtherValue {
                field: (*name).to_owned(),
                value: words,
            };
            *target = Value::opaque("a variable with a field", why);
        }
    }
}

/// Returns the memory that a copy of a value needs \[bytes\].
fn memory_of(value: &Value, depth: usize) -> Result<u64, VariableFault> {
    if depth > MOST_NESTED {
        return Err(VariableFault::too_deep(NO_VARIABLE));
    }
    let mut memory = value.own_memory();
    for inner in value.inner() {
        memory += memory_of(inner, depth + 1)?;
    }
    Ok(memory)
}
