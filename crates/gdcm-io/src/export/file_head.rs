//! The beginning of an exported file, as shown in the file list.

use crate::formats::variables::{Value, Variable};

/// Maximum number of lines in a head.
const MOST_LINES: usize = 60;
/// Maximum number of characters per head line.
const LONGEST_LINE: usize = 240;

/// Returns the first lines of a text file.
pub(super) fn text_head(bytes: &[u8]) -> Vec<String> {
    let text = bytes.strip_suffix(b"\n").unwrap_or(bytes);
    let mut lines = Vec::new();
    for line in text.split(|byte| *byte == b'\n').take(MOST_LINES) {
        // A character has at most four bytes.
        let most = (4 * LONGEST_LINE).min(line.len());
        let shown = String::from_utf8_lossy(&line[..most]);
        let shown = shown.trim_end_matches('\r');
        lines.push(shown.chars().take(LONGEST_LINE).collect());
    }
    lines
}

/// Describes a binary file's variables: a line for each, and a line for each struct field with the
/// value in the first struct.
pub(super) fn variables_head(variables: &[Variable]) -> Vec<String> {
    let mut lines = Vec::new();
    for variable in variables {
        lines.push(format!(
            "{}  {}",
            variable.name,
            value_words(&variable.value)
        ));
        if let Value::Struct(records) = &variable.value {
            for (name, values) in &records.fields {
                if let Some(first) = values.first() {
                    lines.push(format!("  .{name}  {}", value_words(first)));
                }
            }
        }
    }
    lines.truncate(MOST_LINES);
    lines
}

/// Describes a value: "16×4 numbers", or a single number or text itself.
fn value_words(value: &Value) -> String {
    match value {
        Value::Array(array) if array.len() == 1 => array.re[0].to_string(),
        Value::Array(array) => format!("{} numbers", size_words(&array.shape)),
        Value::Text(text) if text.texts.len() == 1 => {
            let shown: String = text.texts[0].chars().take(LONGEST_LINE).collect();
            format!("'{shown}'")
        }
        Value::Text(text) => format!("{} texts", size_words(&text.shape)),
        Value::Cell(cell) => format!("{} cells", size_words(&cell.shape)),
        Value::Struct(records) => format!(
            "{} struct with {} fields",
            size_words(&records.shape),
            records.fields.len()
        ),
        Value::Object(object) => format!("object of class {}", object.class),
        Value::Opaque { class, .. } => class.clone(),
    }
}

/// Formats a size: "16×4".
fn size_words(shape: &[usize]) -> String {
    let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    lengths.join("×")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::variables::Array;

    #[test]
    fn a_binary_file_is_described_by_its_variables() {
        let variables = [
            Variable {
                name: "A_0".to_owned(),
                value: Value::Array(Array::matrix(2, 3, vec![0.0; 6])),
            },
            Variable {
                name: "Ts".to_owned(),
                value: Value::number(0.02),
            },
        ];
        assert_eq!(variables_head(&variables), ["A_0  2×3 numbers", "Ts  0.02"]);
    }

    #[test]
    fn the_head_of_a_text_is_bounded() {
        let text = format!("{}\n", "x".repeat(1000)).repeat(1000);
        let head = text_head(text.as_bytes());
        assert_eq!(head.len(), MOST_LINES);
        assert_eq!(head[0].len(), LONGEST_LINE);
    }
}
