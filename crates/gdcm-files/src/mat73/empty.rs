//! Arrays without elements, of which MATLAB stores the shape.

use super::dataset::Elements;
use super::fault::damaged;
use super::marks::MatlabAttributes;
use super::text::rows;
use crate::places::count;
use crate::variables::{Array, CellArray, ElementKind, MemoryBudget, StructArray, Value, VariableFault};

/// The value without elements that marks and a stored shape stand for.
pub(super) fn empty(
    marks: &MatlabAttributes,
    elements: &Elements,
    path: &str,
    meter: &MemoryBudget<'_>,
) -> Result<Value, VariableFault> {
    let wrong = || damaged(path, "the shape of an array without elements is wrong");
    let sides = elements.words(path, meter)?.ok_or_else(wrong)?;
    let shape: Vec<usize> =
        sides.iter().map(|&side| usize::try_from(side).ok()).collect::<Option<_>>().ok_or_else(wrong)?;
    if shape.len() < 2 || count(&shape) != Some(0) {
        return Err(wrong());
    }
    let numbers = |kind| Array { shape: shape.clone(), kind, re: Vec::new(), im: None };
    Ok(match marks.class() {
        "cell" => Value::Cell(CellArray { shape, values: Vec::new() }),
        "struct" => {
            let fields = marks.fields.iter().map(|name| (name.clone(), Vec::new())).collect();
            Value::Struct(StructArray { shape, fields })
        }
        "char" => Value::Text(rows(&numbers(ElementKind::Integer), path, meter)?),
        "double" | "single" => Value::Array(numbers(ElementKind::Float)),
        "logical" => Value::Array(numbers(ElementKind::Logical)),
        "int8" | "int16" | "int32" | "int64" | "uint8" | "uint16" | "uint32" | "uint64" => {
            Value::Array(numbers(ElementKind::Integer))
        }
        class => Value::Opaque { class: class.to_owned(), why: "it is empty".to_owned() },
    })
}
