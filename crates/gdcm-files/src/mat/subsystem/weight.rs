//! How much memory a value takes.

use crate::variables::Value;

/// Bytes that a value takes without the values in it, rounded up.
pub(super) fn own_weight(value: &Value) -> u64 {
    let shape = |shape: &[usize]| size_of_val(shape);
    let text = |text: &String| size_of::<String>() + text.len();
    let bytes = match value {
        Value::Array(array) => shape(&array.shape) + array.len() * if array.im.is_some() { 16 } else { 8 },
        Value::Text(texts) => shape(&texts.shape) + texts.texts.iter().map(text).sum::<usize>(),
        Value::Cell(cell) => shape(&cell.shape),
        Value::Struct(records) => {
            shape(&records.shape) + records.fields.iter().map(|(name, _)| 48 + text(name)).sum::<usize>()
        }
        Value::Object(object) => shape(&object.records.shape) + text(&object.class),
        Value::Opaque { class, why } => text(class) + text(why),
    };
    (size_of::<Value>() + bytes) as u64
}
