//! Numbers and strings in exported programs and tables.

/// Formats a finite number with 17 significant digits, from which every language recovers the same
/// value.
pub(super) fn number(value: f64) -> String {
    // `+ 0.0` turns minus zero into zero.
    format!("{:.16e}", value + 0.0)
}

/// Formats numbers as a comma-separated list.
pub(super) fn number_list(values: &[f64]) -> String {
    let numbers: Vec<String> = values.iter().map(|&value| number(value)).collect();
    numbers.join(", ")
}

/// First characters of pairs that begin or end a comment or a string (`/*`, `*/` and `//` in C,
/// `%{` and `%}` in MATLAB, repeated quotation marks in Python), or a trigraph (`??` in C).
const FIRST_IN_PAIR: [char; 6] = ['*', '/', '?', '%', '"', '\''];
/// Second characters of these pairs, and the backslash, which may continue a line or begin an
/// escape.
const SECOND_IN_PAIR: [char; 9] = ['*', '/', '\\', '?', '%', '{', '}', '"', '\''];

/// Escapes a string for a comment in any language: visible ASCII characters remain, the symbols
/// that this program uses get ASCII equivalents, and all other characters are written as code
/// points. Blanks separate the pairs of characters that could begin or end a comment.
pub(super) fn comment(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            _ if SECOND_IN_PAIR.contains(&character) && plain.ends_with(FIRST_IN_PAIR) => {
                plain.push(' ');
                plain.push(character);
            }
            ' '..='~' => plain.push(character),
            '\u{2212}' | '\u{2013}' => plain.push('-'),
            '±' => plain.push_str("+-"),
            '≈' => plain.push('~'),
            '²' => plain.push_str("^2"),
            '°' => plain.push_str("deg"),
            'α' => plain.push_str("alpha"),
            'τ' => plain.push_str("tau"),
            _ => plain.push_str(&format!("<U+{:04X}>", u32::from(character))),
        }
    }
    // In C, a comment line that ends in a backslash continues on the next line.
    if plain.ends_with('\\') {
        plain.push('.');
    }
    plain
}

/// Writes a string as a C string literal; quotation marks, backslashes, question marks and bytes
/// that are not printable ASCII become octal escapes.
pub(super) fn c_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for byte in text.bytes() {
        match byte {
            // `?`: a question mark could begin a trigraph.
            b'"' | b'\\' | b'?' | 0..0x20 | 0x7f.. => quoted.push_str(&format!("\\{byte:03o}")),
            _ => quoted.push(char::from(byte)),
        }
    }
    quoted.push('"');
    quoted
}

/// Writes a string as a Python string literal, in which all characters but printable ASCII become
/// escapes.
pub(super) fn python_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        match character {
            '"' | '\\' => {
                quoted.push('\\');
                quoted.push(character);
            }
            ' '..='~' => quoted.push(character),
            _ => quoted.push_str(&format!("\\U{:08x}", u32::from(character))),
        }
    }
    quoted.push('"');
    quoted
}
