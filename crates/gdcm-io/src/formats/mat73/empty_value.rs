//! Empty values, for which MATLAB stores the dimensions instead of elements.

use crate::formats::element_order::element_count;
use crate::formats::mat73::attributes::MatlabAttributes;
use crate::formats::mat73::dataset::Elements;
use crate::formats::mat73::library_fault::damaged;
use crate::formats::mat73::strings::character_rows;
use crate::formats::variables::{Array, CellArray, ElementKind, StructArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unread::Unread;

/// Returns an empty value with the shape that `elements` hold, or an opaque value for an unknown
/// class.
pub(super) fn empty_value(
    attributes: &MatlabAttributes,
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Value, VariableFault> {
    let Some(shape) = stored_shape(elements, path, budget)? else {
        return Err(damaged(path, Damage::EmptyArrayShape));
    };
    if shape.len() < 2 || element_count(&shape) != Some(0) {
        return Err(damaged(path, Damage::EmptyArrayShape));
    }
    Ok(match attributes.class_name() {
        "cell" => Value::Cell(CellArray {
            shape,
            values: Vec::new(),
        }),
        "struct" => {
            let fields = attributes
                .fields
                .iter()
                .map(|name| (name.clone(), Vec::new()))
                .collect();
            Value::Struct(StructArray { shape, fields })
        }
        "char" => {
            let codes = empty_array(shape, ElementKind::Integer);
            Value::Text(character_rows(&codes, path, budget)?)
        }
        // GNU Octave writes no class for numeric arrays.
        "double" | "single" | "" => Value::Array(empty_array(shape, ElementKind::Float)),
        "logical" => Value::Array(empty_array(shape, ElementKind::Logical)),
        "int8" | "int16" | "int32" | "int64" | "uint8" | "uint16" | "uint32" | "uint64" => {
            Value::Array(empty_array(shape, ElementKind::Integer))
        }
        class => Value::opaque(class, Unread::Empty),
    })
}

/// Returns the elements as array dimensions; `None` if they are not 64-bit integers or exceed
/// `usize`.
fn stored_shape(
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<Vec<usize>>, VariableFault> {
    let Some(sides) = elements.words(path, budget)? else {
        return Ok(None);
    };
    Ok(sides
        .iter()
        .map(|&side| usize::try_from(side).ok())
        .collect())
}

fn empty_array(shape: Vec<usize>, kind: ElementKind) -> Array {
    Array {
        shape,
        kind,
        re: Vec::new(),
        im: None,
    }
}
