//! Words on standard output and standard error.

use gdcm_core::message_text::sanitized;
use std::io::{ErrorKind, Write};

use gdcm_files::system_words;

use super::failure::Failure;

/// Prints a text that ends with its own line end. A reader that has seen enough (`gdcm … | head`) is no failure.
pub(super) fn say(text: &str) -> Result<(), Failure> {
    let mut output = std::io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::StandardOutput { reason: system_words(&error) })
        }
        _ => Ok(()),
    }
}

/// Prints one line on standard error; there is nowhere to complain of a failure to do so.
pub(super) fn say_error(line: &str) {
    let _ = writeln!(std::io::stderr(), "gdcm: {}", sanitized(line));
}
