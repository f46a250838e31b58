//! Omits empty members from JSON objects before they are written.

use serde_json::Value;

/// Returns whether a value is empty: null, false, or an empty list.
pub(crate) fn is_empty_value(value: &Value) -> bool {
    match value {
        Value::Null | Value::Bool(false) => true,
        Value::Array(list) => list.is_empty(),
        _ => false,
    }
}

/// Removes from an object the named members that are empty.
pub(crate) fn without_empty(mut object: Value, members: &[&str]) -> Value {
    if let Value::Object(all) = &mut object {
        all.retain(|name, value| !(members.contains(&name.as_str()) && is_empty_value(value)));
    }
    object
}
