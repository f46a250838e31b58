//! Words on standard output and standard error.

use std::io::{ErrorKind, Write};

use super::failure::Failure;

/// Prints a text that ends with its own line end. A reader that has seen enough (`gdcm … | head`) is no failure.
pub(super) fn say(text: &str) -> Result<(), Failure> {
    let mut output = std::io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::StandardOutput { reason: error.to_string() })
        }
        _ => Ok(()),
    }
}

/// Prints one line on standard error; there is nowhere to complain of a failure to do so.
pub(super) fn say_error(line: &str) {
    let _ = writeln!(std::io::stderr(), "gdcm: {}", plain(line));
}

/// A text from a file, fit for a terminal: a name with a line end or an escape sequence would break the page.
pub(super) fn plain(text: &str) -> String {
    let mut words = String::with_capacity(text.len());
    for character in text.chars() {
        if character.is_control() {
            words.extend(character.escape_default());
        } else {
            words.push(character);
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_spelt_out_and_letters_are_not() {
        assert_eq!(plain("a\u{1b}[31m\nΔ → °"), "a\\u{1b}[31m\\nΔ → °");
    }
}
