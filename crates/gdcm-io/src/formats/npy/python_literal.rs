//! Parses the Python literals in array headers, by conversion to JSON: `{'shape': (3, 2), }`
//! becomes `{"shape":[3,2]}`.

use serde_json::Value as Json;

use crate::variable_fault::damage::Damage;

/// Converts a header, which is a Python literal, to JSON: replaces quotation marks, tuples and the
/// words True and False, and removes trailing commas.
///
/// # Errors
///
/// The reason, for anything that NumPy does not write into a header.
pub(super) fn parse_literal(text: &str) -> Result<Json, Damage> {
    let mut json = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(sign) = rest.chars().next() {
        // Number of bytes converted in this step.
        let length = match sign {
            '\'' | '"' => convert_text(rest, sign, &mut json)?,
            // The small letters begin the words of JSON (true, false, null), which are rejected.
            'T' | 'F' | 't' | 'f' | 'n' => convert_word(rest, &mut json)?,
            '(' | '[' => {
                json.push('[');
                1
            }
            ')' | ']' | '}' => {
                // Remove a trailing comma, which JSON does not allow.
                if json.ends_with(',') {
                    json.pop();
                }
                json.push(if sign == '}' { '}' } else { ']' });
                1
            }
            // Python 2 appends an L to long integers.
            ' ' | '\t' | '\r' | '\n' | 'L' => 1,
            _ => {
                json.push(sign);
                sign.len_utf8()
            }
        };
        rest = &rest[length..];
    }
    serde_json::from_str(&json).map_err(|_| Damage::HeaderLiteral)
}

/// Converts the string with which `rest` begins; returns its length including both quotation marks
/// \[bytes\].
fn convert_text(rest: &str, quote: char, json: &mut String) -> Result<usize, Damage> {
    let Some(end) = rest[1..].find(quote) else {
        return Err(Damage::HeaderStringOpen);
    };
    let text = &rest[1..=end];
    // Escapes are not supported: they occur only in unusual field names, with quotation marks,
    // backslashes or control characters.
    if text.contains('\\') {
        return Err(Damage::HeaderEscape);
    }
    json.push_str(&Json::from(text).to_string());
    Ok(end + 2)
}

/// Converts the word with which `rest` begins; returns its length \[bytes\].
fn convert_word(rest: &str, json: &mut String) -> Result<usize, Damage> {
    let end = rest
        .find(|sign: char| !sign.is_alphanumeric())
        .unwrap_or(rest.len());
    match &rest[..end] {
        "True" => json.push_str("true"),
        "False" => json.push_str("false"),
        _ => return Err(Damage::HeaderWord),
    }
    Ok(end)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_header_of_numpy_is_read() {
        let read = parse_literal(
            "{'descr': [('a', '<f8', (2,))], 'fortran_order': False, 'shape': (3, 4L), }   \n",
        )
        .unwrap();
        assert_eq!(
            read,
            json!({"descr": [["a", "<f8", [2]]], "fortran_order": false, "shape": [3, 4]})
        );
    }

    #[test]
    fn other_python_values_are_refused() {
        for text in [
            "",
            "{",
            "{'a' 1}",
            "{1: 2}",
            "'a",
            "__import__('os')",
            "True1",
            "() ()",
            "'\\x00'",
        ] {
            assert!(parse_literal(text).is_err(), "{text}");
        }
        assert!(parse_literal(&"(".repeat(100_000)).is_err());
    }
}
