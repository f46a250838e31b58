//! MATLAB values built from numbers and strings: structs, cell columns, vectors and matrices.

use gdcm_model::dataset::Dataset;

use crate::files::export_contents::ExportContents;
use crate::formats::variables::{Array, CellArray, StructArray, Value};

/// Struct fields, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Fields {
    fields: Vec<(String, Value)>,
}

impl Fields {
    /// Adds a field. `name` may contain only letters, digits and _.
    pub(super) fn add(&mut self, name: &str, value: Value) {
        self.fields.push((name.to_owned(), value));
    }

    pub(super) fn record(self) -> Value {
        records(vec![self])
    }
}

/// Returns a row of structs, which must have the same fields.
pub(super) fn records(records: Vec<Fields>) -> Value {
    let shape = vec![1, records.len()];
    let mut fields: Vec<(String, Vec<Value>)> = Vec::new();
    for record in records {
        for (place, (name, value)) in record.fields.into_iter().enumerate() {
            match fields.get_mut(place) {
                Some((_, values)) => values.push(value),
                None => fields.push((name, vec![value])),
            }
        }
    }
    Value::Struct(StructArray { shape, fields })
}

/// Returns a cell column with one string per cell.
pub(super) fn cell_of_texts(texts: impl IntoIterator<Item = String>) -> Value {
    let values: Vec<Value> = texts.into_iter().map(Value::text).collect();
    Value::Cell(CellArray {
        shape: vec![values.len(), 1],
        values,
    })
}

pub(super) fn row(values: impl IntoIterator<Item = f64>) -> Value {
    let values: Vec<f64> = values.into_iter().collect();
    matrix(1, values.len(), values)
}

pub(super) fn column(values: impl IntoIterator<Item = f64>) -> Value {
    let values: Vec<f64> = values.into_iter().collect();
    matrix(values.len(), 1, values)
}

/// Returns a matrix from its values in column-major order.
pub(super) fn matrix(rows: usize, columns: usize, values: Vec<f64>) -> Value {
    Value::Array(Array::matrix(rows, columns, values))
}

/// Returns a struct with each correction part's source in a file, the physics parameter changes,
/// and the omitted parts.
pub(super) fn contained_parts(contents: &ExportContents, dataset: &Dataset) -> Value {
    let mut fields = Fields::default();
    for (name, source) in contents.parts() {
        fields.add(name, Value::text(source.word()));
    }
    fields.add("physics", cell_of_texts(contents.physics.clone()));
    fields.add("left_out", cell_of_texts(contents.left_out_words(dataset)));
    fields.record()
}
