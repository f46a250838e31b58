//! Samples over time in vectors and matrices, which files store column by column.

use gdcm_sysid::records::RecordColumn;

use crate::formats::variables::{Array, Value};
use crate::import::recognise::values::has_imaginary_part;

/// Samples from one or more signals at common times.
pub(super) struct Samples {
    pub(super) rows: usize,
    /// Values over time, column by column.
    pub(super) columns: Vec<Vec<f64>>,
}

/// Returns the real numbers in a value as samples; a vector is a single column. Time runs along the
/// dimension with length `rows` if given, otherwise along the longer dimension. If neither
/// dimension has the length `rows`, time runs along the first, and the caller must compare
/// [`Samples::rows`]. `None` if the value has another form, is empty, or contains complex numbers.
pub(super) fn samples_of(value: &Value, rows: Option<usize>) -> Option<Samples> {
    let array = match value {
        Value::Array(array) => array,
        Value::Cell(cell) => return samples_of_cells(&cell.values),
        Value::Text(_) | Value::Struct(_) | Value::Object(_) | Value::Opaque { .. } => return None,
    };
    let [first, second] = array.shape[..] else {
        return None;
    };
    if has_imaginary_part(array) || array.is_empty() {
        return None;
    }
    // Whether the array's second index counts the time, that is, each column is an instant.
    let is_time_in_columns = match rows {
        Some(rows) => first != rows && second == rows,
        None => second > first,
    };
    if is_time_in_columns {
        return Some(Samples {
            rows: second,
            columns: (0..first)
                .map(|column| strided_values(array, column, first))
                .collect(),
        });
    }
    Some(Samples {
        rows: first,
        columns: (0..second)
            .map(|column| array.re[column * first..(column + 1) * first].to_vec())
            .collect(),
    })
}

/// Returns every `step`-th number in storage order, beginning with the number at `from`.
fn strided_values(array: &Array, from: usize, step: usize) -> Vec<f64> {
    array.re.iter().skip(from).step_by(step).copied().collect()
}

/// Reads cells that each hold a single number, or nothing (NaN): as in JSON lists with "null".
fn samples_of_cells(cells: &[Value]) -> Option<Samples> {
    if cells.is_empty() {
        return None;
    }
    let mut values = Vec::with_capacity(cells.len());
    for cell in cells {
        match cell {
            Value::Array(array) if array.len() <= 1 => {
                values.push(array.re.first().copied().unwrap_or(f64::NAN));
            }
            _ => return None,
        }
    }
    Some(Samples {
        rows: values.len(),
        columns: vec![values],
    })
}

/// Returns the first sample column in a value; time runs along the longer dimension.
pub(super) fn first_column_of(value: &Value) -> Option<Vec<f64>> {
    samples_of(value, None)?.columns.into_iter().next()
}

/// Returns the first number in a value; `None` if it contains none.
pub(super) fn first_number_of(value: &Value) -> Option<f64> {
    first_column_of(value)?.first().copied()
}

/// Returns record columns with a common name, numbered if there are several: "rates_1", "rates_2".
pub(super) fn named_columns(name: &str, columns: Vec<Vec<f64>>) -> Vec<RecordColumn> {
    let is_single = columns.len() == 1;
    let mut named = Vec::with_capacity(columns.len());
    for (index, values) in columns.into_iter().enumerate() {
        let name = if is_single {
            name.to_owned()
        } else {
            format!("{name}_{}", index + 1)
        };
        named.push(RecordColumn::new(name, values));
    }
    named
}
