//! Values of a file of MATLAB, as exports make them.

use crate::variables::{Array, CellArray, ElementKind, StructArray, TextArray, Value};

/// The fields of a record, in their order.
#[derive(Clone, Debug, Default)]
pub(super) struct Fields {
    fields: Vec<(String, Value)>,
}

impl Fields {
    /// Adds a field. Names are ours: letters, digits and _.
    pub(super) fn add(&mut self, name: &str, value: Value) {
        self.fields.push((name.to_owned(), value));
    }

    /// One record.
    pub(super) fn record(self) -> Value {
        records(vec![self])
    }
}

/// A row of records that all have the same fields.
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

/// A text.
pub(super) fn text(text: impl Into<String>) -> Value {
    Value::Text(TextArray { shape: vec![1, 1], texts: vec![text.into()] })
}

/// Texts below one another, each in a cell.
pub(super) fn cell_of_texts(texts: impl IntoIterator<Item = String>) -> Value {
    let values: Vec<Value> = texts.into_iter().map(text).collect();
    Value::Cell(CellArray { shape: vec![values.len(), 1], values })
}

/// A number; what is undefined is NaN.
pub(super) fn scalar(value: impl Into<Option<f64>>) -> Value {
    matrix(1, 1, vec![value.into().unwrap_or(f64::NAN)])
}

/// True or false.
pub(super) fn truth(value: bool) -> Value {
    Value::Array(Array { kind: ElementKind::Logical, ..Array::matrix(1, 1, vec![f64::from(u8::from(value))]) })
}

/// Numbers below one another.
pub(super) fn column(values: impl IntoIterator<Item = f64>) -> Value {
    let values: Vec<f64> = values.into_iter().collect();
    matrix(values.len(), 1, values)
}

/// A matrix, given column by column.
pub(super) fn matrix(rows: usize, columns: usize, values: Vec<f64>) -> Value {
    Value::Array(Array::matrix(rows, columns, values))
}
