//! The variables that statements have set.

use std::collections::HashMap;

use super::functions::record;
use super::trouble::Trouble;
use crate::variables::{MemoryBudget, StructArray, Value, Variable, VariableFault};

/// Values in values that are followed.
const MOST_NESTED: usize = 64;

/// The variables in the order in which they were first set.
#[derive(Default)]
pub(super) struct Scope {
    variables: Vec<Variable>,
    places: HashMap<String, usize>,
}

impl Scope {
    /// The variables, each with its last value.
    pub(super) fn into_variables(self) -> Vec<Variable> {
        self.variables
    }

    /// Whether there is a variable.
    pub(super) fn knows(&self, name: &str) -> bool {
        self.places.contains_key(name)
    }

    /// A copy of a variable or of one of its fields.
    pub(super) fn copy(&self, path: &[&str], meter: &MemoryBudget) -> Result<Value, Trouble> {
        let (name, fields) = path.split_first().ok_or_else(|| Trouble::new("a name is missing"))?;
        let Some(&place) = self.places.get(*name) else {
            return Err(Trouble::new(format!("{name} is not known here; write its value")));
        };
        let mut value = &self.variables[place].value;
        for field in fields {
            value = match value {
                Value::Struct(records) => match records.field(field) {
                    Some([only]) => only,
                    _ => return Err(Trouble::new(format!("{} has no field {field}", path.join(".")))),
                },
                _ => return Err(Trouble::new(format!("{} has no fields", path.join(".")))),
            };
        }
        if let Value::Opaque { .. } = value {
            return Err(Trouble::new(format!("{} could not be read itself", path.join("."))));
        }
        meter.take(cost(value, 0)?, 1, name)?;
        Ok(value.clone())
    }

    /// Sets a variable or one of its fields.
    pub(super) fn set(&mut self, path: &[&str], value: Value, meter: &MemoryBudget) -> Result<(), VariableFault> {
        let Some((name, fields)) = path.split_first() else { return Ok(()) };
        if path.len() > MOST_NESTED {
            return Err(VariableFault::TooDeep { variable: (*name).to_owned() });
        }
        meter.take(path.iter().map(|part| part.len() as u64 + 128).sum(), 2, name)?;
        let place = *self.places.entry((*name).to_owned()).or_insert_with(|| {
            self.variables.push(Variable { name: (*name).to_owned(), value: record(Vec::new()) });
            self.variables.len() - 1
        });
        set_field(&mut self.variables[place].value, fields, value);
        Ok(())
    }
}

fn set_field(target: &mut Value, path: &[&str], value: Value) {
    let Some((name, rest)) = path.split_first() else {
        *target = value;
        return;
    };
    let words = target.words();
    match target {
        Value::Struct(StructArray { fields, .. }) => {
            let place = fields.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
                fields.push(((*name).to_owned(), vec![record(Vec::new())]));
                fields.len() - 1
            });
            if let Some(slot) = fields[place].1.first_mut() {
                set_field(slot, rest, value);
            }
        }
        Value::Opaque { .. } => {}
        _ => {
            let why = format!("{words} is given a field {name}; use another name for one of them");
            *target = Value::Opaque { class: "a variable with a field".to_owned(), why };
        }
    }
}

/// Memory that a copy of a value takes \[bytes\].
pub(super) fn cost(value: &Value, depth: usize) -> Result<u64, VariableFault> {
    if depth > MOST_NESTED {
        return Err(VariableFault::TooDeep { variable: String::new() });
    }
    let mut inner = 0;
    match value {
        Value::Array(array) => inner += 16 * array.len() as u64,
        Value::Text(text) => inner += text.texts.iter().map(|text| text.len() as u64 + 32).sum::<u64>(),
        Value::Cell(cell) => {
            for value in &cell.values {
                inner += cost(value, depth + 1)?;
            }
        }
        Value::Struct(records) | Value::Object(crate::variables::Object { records, .. }) => {
            for value in records.fields.iter().flat_map(|(_, values)| values) {
                inner += 64 + cost(value, depth + 1)?;
            }
        }
        Value::Opaque { class, why } => inner += (class.len() + why.len()) as u64,
    }
    Ok(inner + 128)
}

#[cfg(test)]
mod tests {
    use super::super::arithmetic::scalar;
    use super::*;

    #[test]
    fn fields_are_set_within_fields() {
        let meter = MemoryBudget::new(1 << 20, &|_| false);
        let mut scope = Scope::default();
        scope.set(&["sys", "a", "b"], scalar(1.0, 0.0), &meter).unwrap();
        scope.set(&["sys", "c"], scalar(2.0, 0.0), &meter).unwrap();
        assert_eq!(scope.copy(&["sys", "a", "b"], &meter).unwrap(), scalar(1.0, 0.0));
        assert!(scope.copy(&["sys", "d"], &meter).is_err() && scope.copy(&["x"], &meter).is_err());
        scope.set(&["x"], scalar(2.0, 0.0), &meter).unwrap();
        scope.set(&["x", "y"], scalar(2.0, 0.0), &meter).unwrap();
        assert!(matches!(scope.into_variables()[1].value, Value::Opaque { .. }));
    }
}
