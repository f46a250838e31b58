//! Names that people gave, as they can stand in programs.

/// A text for a comment of any language: visible characters of ASCII, all others by their numbers in Unicode, and nothing that
/// ends or begins a comment.
pub(super) fn comment(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            // Two characters that begin or end comments, continue lines or are written otherwise never stand together.
            '*' | '/' | '\\' | '?' | '%' | '{' | '}' | '"' | '\''
                if plain.ends_with(['*', '/', '?', '%', '"', '\'']) =>
            {
                plain.push(' ');
                plain.push(character);
            }
            ' '..='~' => plain.push(character),
            _ => plain.push_str(&format!("<U+{:04X}>", u32::from(character))),
        }
    }
    // A line of a comment that ends in a backslash goes on in the next.
    if plain.ends_with('\\') {
        plain.push('.');
    }
    plain
}

/// A text between double quotes for C: bytes that are no plain characters as three octal digits.
pub(super) fn c_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for byte in text.bytes() {
        match byte {
            // A question mark could begin a trigraph.
            b'"' | b'\\' | b'?' | 0..0x20 | 0x7f.. => quoted.push_str(&format!("\\{byte:03o}")),
            _ => quoted.push(char::from(byte)),
        }
    }
    quoted.push('"');
    quoted
}

/// A text between double quotes for Python.
pub(super) fn python_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        match character {
            '"' | '\\' => quoted.extend(['\\', character]),
            ' '..='~' => quoted.push(character),
            _ => quoted.push_str(&format!("\\U{:08x}", u32::from(character))),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_comment_stays_one_line_and_is_not_ended() {
        assert_eq!(comment("a\n*/b"), "a<U+000A>* /b");
        assert_eq!(comment("δ\\"), "<U+03B4>\\.");
    }

    #[test]
    fn texts_are_escaped_for_their_language() {
        assert_eq!(c_text("a\"?\u{e9}1"), "\"a\\042\\077\\303\\2511\"");
        assert_eq!(python_text("a\"\\\u{e9}"), "\"a\\\"\\\\\\U000000e9\"");
    }

    proptest! {
        #[test]
        fn no_comment_is_ended(text in "[*/\\\\?%{}\"'a\\n]{0,20}") {
            let plain = comment(&text);
            for mark in ["*/", "/*", "//", "??", "%{", "%}", "\n", "\"\"", "'''"] {
                prop_assert!(!plain.contains(mark), "{}", plain);
            }
        }
    }
}
