//! Writes JSON files, with line breaks or on one line, and without invisible characters.

use std::io::{self, Write};

use serde::Serialize;

use gdcm_model::message_text::is_unprintable;

/// Writes a value as JSON with line breaks, for people to read.
pub fn write_pretty(value: &impl Serialize, file: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer_pretty(EscapingWriter(&mut *file), value)?;
    file.write_all(b"\n")
}

/// Writes a value as JSON on one line.
pub(super) fn write_compact(value: &impl Serialize, file: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer(EscapingWriter(&mut *file), value)?;
    file.write_all(b"\n")
}

/// Writes JSON with escaped control characters, except DEL, which has no effect on a terminal, and
/// with escaped invisible characters, including those that JSON permits. Showing a file on a
/// terminal thus cannot affect the terminal, and invisible characters cannot make two different
/// names look alike.
struct EscapingWriter<W>(W);

impl<W: Write> Write for EscapingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // serde_json writes string pieces that end at character boundaries; everything outside
        // strings is ASCII.
        match std::str::from_utf8(bytes) {
            Ok(text) if !text.is_ascii() && text.contains(is_unprintable) => {
                self.0.write_all(escaped(text).as_bytes())?;
            }
            _ => self.0.write_all(bytes)?,
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// Escapes unprintable characters beyond ASCII as UTF-16 units: `\u009b`.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(2 * text.len());
    for character in text.chars() {
        if character.is_ascii() || !is_unprintable(character) {
            escaped.push(character);
            continue;
        }
        for unit in character.encode_utf16(&mut [0; 2]) {
            escaped.push_str(&format!("\\u{unit:04x}"));
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped_and_read_back() {
        let name = "a\u{9b}31m b\u{202e}c \u{e0041} \u{7f} \u{e9}\u{3b1}\u{1f600}\n";
        let mut file = Vec::new();
        write_pretty(&[name], &mut file).unwrap();
        let text = String::from_utf8(file).unwrap();
        let left: Vec<char> = text
            .trim_end()
            .chars()
            .filter(|letter| is_unprintable(*letter))
            .collect();
        // The line breaks of the JSON layout, and DEL, which has no effect on a terminal.
        assert_eq!(left, ['\n', '\u{7f}', '\n'], "{text:?}");
        assert!(
            text.contains("\\u009b31m")
                && text.contains("\\udb40\\udc41")
                && text.contains("\u{e9}\u{3b1}\u{1f600}")
        );
        assert_eq!(serde_json::from_str::<Vec<String>>(&text).unwrap(), [name]);
    }
}
