//! The lines of a text, whatever they end in.

use crate::variables::VariableFault;

/// The lines of a text with their numbers, from 1; they end in a line feed, a carriage return, or both.
pub(super) struct Lines<'t> {
    rest: Option<&'t str>,
    number: usize,
}

/// The lines of `text`.
pub(super) fn lines(text: &str) -> Lines<'_> {
    Lines { rest: Some(text.strip_prefix('\u{feff}').unwrap_or(text)), number: 0 }
}

impl<'t> Iterator for Lines<'t> {
    type Item = (usize, &'t str);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.rest?;
        self.number += 1;
        let Some(end) = rest.find(['\n', '\r']) else {
            self.rest = None;
            return Some((self.number, rest));
        };
        let (line, behind) = rest.split_at(end);
        self.rest = behind.strip_prefix("\r\n").or_else(|| behind.get(1..));
        Some((self.number, line))
    }
}

/// Refuses what is no text: no text of numbers holds a zero byte.
pub(super) fn refuse_binary(text: &str, expected: &'static str) -> Result<(), VariableFault> {
    match text.find('\0') {
        Some(at) => {
            Err(VariableFault::Format { expected, found: format!("a file that is no text (byte {at} of it is zero)") })
        }
        None => Ok(()),
    }
}

/// The beginning of a text for a message: its first line, at most 40 characters, visible ones only.
pub(super) fn excerpt(text: &str) -> String {
    // No more of a line is looked at than is shown: it may be as long as the text.
    let mut line = text.trim_start().chars().take_while(|c| !matches!(c, '\n' | '\r'));
    let shown: String = line.by_ref().take(40).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    let mut short = shown.trim_end().to_owned();
    if line.next().is_some() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_as_on_any_system() {
        let found: Vec<_> = lines("\u{feff}a\r\nb\rc\n\nd").collect();
        assert_eq!(found, [(1, "a"), (2, "b"), (3, "c"), (4, ""), (5, "d")]);
    }

    #[test]
    fn a_zero_byte_is_no_text() {
        let fault = refuse_binary("ab\0c", "a table").unwrap_err();
        assert_eq!(fault.to_string(), "expected a table, found a file that is no text (byte 2 of it is zero)");
    }

    #[test]
    fn a_message_shows_a_short_beginning() {
        assert_eq!(excerpt("\n ab\u{7}c\nd"), "ab\u{fffd}c");
        assert_eq!(excerpt(&"x".repeat(50)).chars().count(), 41);
    }
}
