//! Numbers out of values.

use nalgebra::{Complex, DMatrix};

use crate::variables::{Array, Value};
use gdcm_core::units::number;

/// The numbers that a value stands for: itself, or the value of a parameter of an identified model.
pub(super) fn array_of(value: &Value) -> Option<&Array> {
    match value {
        Value::Array(array) => Some(array),
        Value::Object(object) => {
            let values = object.records.field("Value").or_else(|| object.records.field("Value_"))?;
            array_of(values.first()?)
        }
        Value::Struct(records) if records.shape.iter().product::<usize>() == 1 => {
            array_of(records.field("Value")?.first()?)
        }
        Value::Text(_) | Value::Cell(_) | Value::Struct(_) | Value::Opaque { .. } => None,
    }
}

/// A real matrix of finite numbers.
pub(super) fn matrix_of(name: &str, value: &Value) -> Result<DMatrix<f64>, String> {
    let array =
        array_of(value).ok_or_else(|| format!("{name}: expected a matrix of numbers, found {}", value.words()))?;
    let pages = slices(array);
    if pages > 1 {
        return Err(format!("{name}: expected a matrix, found {}", value.words()));
    }
    page_of(name, array, 0)
}

/// Number of matrices in an array: the product of what stands behind its rows and columns.
pub(super) fn slices(array: &Array) -> usize {
    array.shape.iter().skip(2).product()
}

/// One matrix of an array of matrices.
pub(super) fn page_of(name: &str, array: &Array, page: usize) -> Result<DMatrix<f64>, String> {
    let (rows, columns) = (array.shape.first().copied().unwrap_or(0), array.shape.get(1).copied().unwrap_or(0));
    if array.im.as_ref().is_some_and(|im| im.iter().any(|part| *part != 0.0)) {
        return Err(format!("{name}: expected real numbers, found complex ones"));
    }
    let start = page * rows * columns;
    let values = array.re.get(start..start + rows * columns).unwrap_or_default();
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let place = if rows == 0 { (0, 0) } else { (at % rows + 1, at / rows + 1) };
        return Err(format!(
            "{name}, row {}, column {}: expected a finite number, found {}",
            place.0, place.1, values[at]
        ));
    }
    Ok(DMatrix::from_column_slice(rows, columns, values))
}

/// One real finite number.
pub(super) fn scalar_of(value: &Value) -> Option<f64> {
    let array = array_of(value)?;
    match array.re.as_slice() {
        [value] if value.is_finite() => Some(*value),
        _ => None,
    }
}

/// Numbers in a row or a column.
pub(super) fn list_of(name: &str, value: &Value) -> Result<Vec<f64>, String> {
    let array = array_of(value).ok_or_else(|| format!("{name}: expected numbers, found {}", value.words()))?;
    match array.re.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(format!("{name}, entry {}: expected a finite number, found {}", at + 1, number(array.re[at]))),
        None => Ok(array.re.clone()),
    }
}

/// Complex numbers in a row or a column.
pub(super) fn complex_list_of(name: &str, value: &Value) -> Result<Vec<Complex<f64>>, String> {
    let re = list_of(name, value)?;
    let im = array_of(value).and_then(|array| array.im.clone()).unwrap_or_else(|| vec![0.0; re.len()]);
    if im.iter().any(|part| !part.is_finite()) {
        return Err(format!("{name}: expected finite numbers"));
    }
    Ok(re.into_iter().zip(im).map(|(re, im)| Complex::new(re, im)).collect())
}
