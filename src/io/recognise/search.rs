//! Where in a file models are.

use crate::assembly::FoundModel;
use crate::io::variables::{StructArray, Value, Variable};

use super::matrix::{array_of, matrix_of};
use super::record::Record;
use super::response::{is_response, response};
use super::state_space::{is_state_space, state_spaces};
use super::transfer_function::{is_transfer_function, transfer_function};
use super::{DEEPEST, Recognised};

/// Every model among variables: first what they are together, then each by itself, inside out.
pub(super) fn search(variables: &[Variable]) -> Recognised {
    let mut found = Recognised::default();
    let together = Record::of_variables(variables);
    found.take(&together, "");
    found.take_suffixed(variables);
    let is_alone = found.models.is_empty() && found.faults.is_empty();
    for variable in variables {
        found.descend(&variable.name, &variable.value, DEEPEST);
        if is_alone && array_of(&variable.value).is_some() {
            found.passed_over.push(format!("{}: {}", variable.name, variable.value.words()));
        }
    }
    found
}

impl Recognised {
    /// Takes the model that fields are, if they are one; gives whether they are.
    fn take(&mut self, record: &Record<'_>, variable: &str) -> bool {
        let models = if is_state_space(record) {
            state_spaces(record, variable)
        } else if is_response(record) {
            vec![response(record, variable)]
        } else if is_transfer_function(record) {
            vec![transfer_function(record, variable)]
        } else {
            return false;
        };
        for model in models {
            self.add(variable, model);
        }
        true
    }

    fn add(&mut self, variable: &str, model: Result<FoundModel, String>) {
        let at = if variable.is_empty() { String::new() } else { format!("{variable}: ") };
        match model {
            Ok(model) => self.models.push(model),
            Err(reason) => self.faults.push(format!("{at}{reason}")),
        }
    }

    /// Matrices of several models beside one another: `A_nom, B_nom, ...`, `A1, B1, ...`.
    fn take_suffixed(&mut self, variables: &[Variable]) {
        let suffixes =
            variables.iter().filter_map(|variable| variable.name.strip_prefix('A')).filter(|suffix| !suffix.is_empty());
        for suffix in suffixes {
            let letters = ["A", "B", "C", "D", "E"];
            let renamed: Vec<Variable> = letters
                .iter()
                .filter_map(|letter| {
                    let found = variables.iter().find(|variable| variable.name == format!("{letter}{suffix}"))?;
                    let is_matrix = matrix_of(letter, &found.value).is_ok();
                    is_matrix.then(|| Variable { name: (*letter).to_owned(), value: found.value.clone() })
                })
                .collect();
            if renamed.len() >= 3 && is_state_space(&Record::of_variables(&renamed)) {
                // Labels beside them are of all.
                let labels = variables.iter().filter(|variable| !letters.contains(&variable.name.as_str())).cloned();
                let together: Vec<Variable> = renamed.into_iter().chain(labels).collect();
                self.take(&Record::of_variables(&together), suffix.trim_start_matches('_'));
            }
        }
    }

    /// Looks for models in a value, and in what it holds.
    fn descend(&mut self, name: &str, value: &Value, deeper: usize) {
        if deeper == 0 {
            self.faults.push(format!("{name}: values are nested too deeply to look for models in them"));
            return;
        }
        match value {
            Value::Struct(records) => self.descend_records(name, records, None, deeper),
            Value::Object(object) => self.descend_records(name, &object.records, Some(&object.class), deeper),
            Value::Cell(cell) => {
                for (index, value) in cell.values.iter().enumerate() {
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
            let pages = Record::pages(records, index);
            let mut is_model = false;
            for page in 0..pages {
                let name = if pages == 1 { name.clone() } else { format!("{name}(:,:,{})", page + 1) };
                is_model |= self.take(&Record::of_struct(records, index, class, page), &name);
            }
            if is_model {
                continue;
            }
            let record = Record::of_struct(records, index, None, 0);
            for (field, value) in record.fields() {
                self.descend(&format!("{name}.{field}"), value, deeper - 1);
            }
        }
    }
}
