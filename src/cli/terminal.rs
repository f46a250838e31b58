//! Words on standard output and standard error, and progress where that is a terminal.

use std::io::{ErrorKind, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use gdcm_core::message_text::sanitized;
use gdcm_core::study::Progress;
use gdcm_files::system_words;

use super::Failure;

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

/// An analysis that is done sooner needs no progress.
const QUICK: Duration = Duration::from_millis(500);

/// A bar on standard error, where that is a terminal, once the analysis takes longer than half a second.
pub(super) struct TerminalProgress {
    bar: ProgressBar,
    started: Instant,
}

impl TerminalProgress {
    /// `doing` says what takes the time.
    pub(super) fn new(doing: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        // A template that is not understood leaves the bar its own looks.
        if let Ok(style) = ProgressStyle::with_template(&format!("{doing} {{bar:40}} {{percent}} %")) {
            bar.set_style(style);
        }
        Self { bar, started: Instant::now() }
    }
}

impl Drop for TerminalProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for TerminalProgress {
    fn cancelled(&self) -> bool {
        false
    }

    fn advanced(&self, done: usize, total: usize) {
        if self.bar.is_hidden() && self.started.elapsed() >= QUICK {
            // Draws nothing where standard error is no terminal.
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
    }
}
