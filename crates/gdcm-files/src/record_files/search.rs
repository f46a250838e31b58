//! Where among variables records are.

use crate::recognise::record::Record;
use crate::variables::{StructArray, Value, Variable};

use super::iddata::{experiments, is_iddata};
use super::record_columns::{columns_of, simulink_columns};
use super::timetable::timetable_columns;
use super::{Columns, MOST_RECORDS};

/// Deepest nesting that is searched for records.
const DEEPEST: usize = 8;

/// What was found among variables.
#[derive(Default)]
pub(super) struct Search {
    pub(super) records: Vec<Columns>,
    /// What looks like a record but cannot be taken, with its place and why.
    pub(super) faults: Vec<String>,
    /// What is no record, in words.
    pub(super) passed_over: Vec<String>,
}

impl Search {
    /// Every record among the variables of a file: what they are together, then each by itself, inside out.
    pub(super) fn of(variables: &[Variable]) -> Self {
        let mut search = Self::default();
        let together = Record::of_variables(variables);
        search.records.extend(columns_of(&together, ""));
        for variable in variables {
            search.descend(&variable.name, &variable.value, DEEPEST);
        }
        if search.records.is_empty() && search.faults.is_empty() {
            let words = variables.iter().map(|variable| format!("{}: {}", variable.name, variable.value.words()));
            search.passed_over.extend(words.take(20));
        }
        search
    }

    fn descend(&mut self, name: &str, value: &Value, deeper: usize) {
        if deeper == 0 || self.records.len() >= MOST_RECORDS {
            self.faults
                .push(format!("{name}: too many values, or values nested too deeply, to look for records in them"));
            return;
        }
        match value {
            Value::Struct(records) => self.descend_records(name, records, None, deeper),
            Value::Object(object) => self.descend_records(name, &object.records, Some(&object.class), deeper),
            Value::Cell(cell) => {
                let holds_records =
                    |value: &Value| matches!(value, Value::Struct(_) | Value::Object(_) | Value::Cell(_));
                for (index, value) in cell.values.iter().enumerate().filter(|(_, value)| holds_records(value)) {
                    self.descend(&format!("{name}{{{}}}", index + 1), value, deeper - 1);
                }
            }
            Value::Opaque { class, why } => self.faults.push(format!("{name} ({class}): {why}")),
            Value::Array(_) | Value::Text(_) => {}
        }
    }

    fn descend_records(&mut self, name: &str, records: &StructArray, class: Option<&str>, deeper: usize) {
        let count = records.shape.iter().product::<usize>();
        for index in 0..count {
            let name = if count == 1 { name.to_owned() } else { format!("{name}({})", index + 1) };
            let record = Record::of_struct(records, index, class, 0);
            if is_iddata(&record) {
                match experiments(&record, &name) {
                    Ok(found) => self.records.extend(found),
                    Err(why) => self.faults.push(format!("{name}: {why}")),
                }
                continue;
            }
            let found = timetable_columns(&record, &name)
                .or_else(|| simulink_columns(&record, &name))
                .or_else(|| columns_of(&record, &name));
            if let Some(columns) = found {
                self.records.push(columns);
                continue;
            }
            for (field, value) in Record::of_struct(records, index, None, 0).fields() {
                self.descend(&format!("{name}.{field}"), value, deeper - 1);
            }
        }
    }
}
