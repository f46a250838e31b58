//! Converts values in files to numbers, matrices and strings.

use nalgebra::{Complex, DMatrix};

use super::recognition_fault::RecognitionFault;
use crate::formats::variables::{Array, PageIndex, Value};

/// A named value: a variable in a file, or a field in a struct.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field<'v> {
    pub(crate) name: &'v str,
    pub(crate) value: &'v Value,
}

/// Returns the array in a value; `None` if there is none. Objects and structs may hold a single
/// array: `Value` in MATLAB's identified models, `poly` in GNU Octave's polynomials.
pub(super) fn array_of(value: &Value) -> Option<&Array> {
    match value {
        Value::Array(array) => Some(array),
        Value::Object(object) => {
            let values = ["Value", "Value_", "poly"]
                .iter()
                .find_map(|name| object.records.field(name))?;
            array_of(values.first()?)
        }
        Value::Struct(records) if records.shape.iter().product::<usize>() == 1 => {
            array_of(records.field("Value")?.first()?)
        }
        Value::Text(_) | Value::Cell(_) | Value::Struct(_) | Value::Opaque { .. } => None,
    }
}

/// Converts a value to a matrix; rejects complex and non-finite numbers.
pub(super) fn matrix_of(name: &str, value: &Value) -> Result<DMatrix<f64>, RecognitionFault> {
    let Some(array) = array_of(value) else {
        return Err(kind_fault(name, "a matrix of numbers", value.words()));
    };
    if array.shape.iter().skip(2).product::<usize>() > 1 {
        return Err(kind_fault(name, "a matrix", value.words()));
    }
    page_of(name, array, 0, PageIndex::Last)
}

fn kind_fault(name: &str, expected: &'static str, found: String) -> RecognitionFault {
    RecognitionFault::Kind {
        name: name.to_owned(),
        expected,
        found,
    }
}

/// Shape of an array that holds several matrices with equal dimensions, called pages.
#[derive(Clone, Copy, Debug)]
pub(super) struct PagedShape {
    pub(super) pages: usize,
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Distance between the first numbers in successive pages.
    page_step: usize,
    /// Distance between successive numbers in a page, which are in column order.
    number_step: usize,
}

impl PagedShape {
    /// Determines an array's shape. The first of three indices selects the matrix if `page_index`
    /// is [`PageIndex::First`]; otherwise all indices after the second do.
    pub(super) fn new(array: &Array, page_index: PageIndex) -> Self {
        let shape = &array.shape;
        if shape.len() == 3 && page_index == PageIndex::First {
            return Self {
                pages: shape[0],
                rows: shape[1],
                columns: shape[2],
                // The first index runs fastest: numbers from different pages alternate.
                page_step: 1,
                number_step: shape[0].max(1),
            };
        }
        let rows = shape.first().copied().unwrap_or(0);
        let columns = shape.get(1).copied().unwrap_or(0);
        Self {
            pages: shape.iter().skip(2).product(),
            rows,
            columns,
            // The pages follow one another.
            page_step: rows * columns,
            number_step: 1,
        }
    }
}

/// Returns the matrix with index `page`, counted from 0, of an array that holds several matrices.
pub(super) fn page_of(
    name: &str,
    array: &Array,
    page: usize,
    page_index: PageIndex,
) -> Result<DMatrix<f64>, RecognitionFault> {
    let PagedShape {
        rows,
        columns,
        page_step,
        number_step,
        ..
    } = PagedShape::new(array, page_index);
    if has_imaginary_part(array) {
        return Err(kind_fault(
            name,
            "real numbers",
            "complex numbers".to_owned(),
        ));
    }
    let numbers = array.re.iter().skip(page * page_step).step_by(number_step);
    let values: Vec<f64> = numbers.take(rows * columns).copied().collect();
    // If a later dimension is zero, the array has fewer numbers than the first two dimensions
    // imply.
    if values.len() != rows * columns {
        return Err(kind_fault(
            name,
            "a matrix",
            "an array without numbers".to_owned(),
        ));
    }
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Err(RecognitionFault::MatrixNotFinite {
            name: name.to_owned(),
            row: at % rows + 1,
            column: at / rows + 1,
            value: values[at],
        });
    }
    Ok(DMatrix::from_column_slice(rows, columns, &values))
}

/// Returns whether any number in an array has a nonzero imaginary part.
pub(in crate::import) fn has_imaginary_part(array: &Array) -> bool {
    match &array.im {
        Some(im) => im.iter().any(|part| *part != 0.0),
        None => false,
    }
}

/// Converts a value to a single number and ignores its imaginary part; `None` unless it is finite.
pub(super) fn scalar_of(value: &Value) -> Option<f64> {
    let array = array_of(value)?;
    match array.re.as_slice() {
        [value] if value.is_finite() => Some(*value),
        _ => None,
    }
}

/// Converts an array of any shape, in practice a row or a column, to a list of numbers in storage
/// order, without their imaginary parts; rejects non-finite numbers.
pub(super) fn list_of(name: &str, value: &Value) -> Result<Vec<f64>, RecognitionFault> {
    let Some(array) = array_of(value) else {
        return Err(kind_fault(name, "numbers", value.words()));
    };
    match array.re.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(RecognitionFault::ListNotFinite {
            name: name.to_owned(),
            entry: at + 1,
            value: array.re[at],
        }),
        None => Ok(array.re.clone()),
    }
}

/// Converts an array as [`list_of`], with its imaginary parts.
pub(super) fn complex_list_of(
    name: &str,
    value: &Value,
) -> Result<Vec<Complex<f64>>, RecognitionFault> {
    let re = list_of(name, value)?;
    let im = match array_of(value) {
        Some(Array { im: Some(im), .. }) => im.clone(),
        _ => vec![0.0; re.len()],
    };
    if let Some(at) = im.iter().position(|part| !part.is_finite()) {
        return Err(RecognitionFault::ImaginaryNotFinite {
            name: name.to_owned(),
            entry: at + 1,
            value: im[at],
        });
    }
    let parts = re.into_iter().zip(im);
    Ok(parts.map(|(re, im)| Complex::new(re, im)).collect())
}

/// Returns the strings in a value, without surrounding blanks: those in a string array, the first
/// string in each cell of a cell array (empty for an empty cell), or none for an empty array, which
/// MATLAB writes for an empty list. Returns `None` for any other value, and for a cell array that
/// contains one.
pub(in crate::import) fn texts_of(value: &Value) -> Option<Vec<String>> {
    match value {
        Value::Text(text) => Some(
            text.texts
                .iter()
                .map(|text| text.trim().to_owned())
                .collect(),
        ),
        Value::Cell(cell) => {
            let mut texts = Vec::with_capacity(cell.values.len());
            for value in &cell.values {
                texts.push(texts_of(value)?.into_iter().next().unwrap_or_default());
            }
            Some(texts)
        }
        Value::Array(array) if array.is_empty() => Some(Vec::new()),
        Value::Array(_) | Value::Struct(_) | Value::Object(_) | Value::Opaque { .. } => None,
    }
}

/// Returns the first string in a value; `None` if there is none.
pub(in crate::import) fn first_text_of(value: &Value) -> Option<String> {
    texts_of(value)?.into_iter().next()
}
