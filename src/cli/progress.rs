//! A command's progress: on a terminal, or passed on to a program that embeds the commands.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use gdcm_io::FolderProgress;
use gdcm_model::message_text::sanitized;
use gdcm_model::progress::Progress;

use super::interruption::Interruptible;
use super::terminal::shows_progress;

/// Destination to which a command reports the progress of its parts.
#[derive(Clone, Copy)]
pub(super) enum ProgressReceiver<'a> {
    /// A bar on the terminal.
    Terminal,
    /// The program that embeds the command.
    Program(&'a dyn Progress),
}

impl<'a> ProgressReceiver<'a> {
    /// Returns the receiver for a part of the work with the label `work`.
    pub(super) fn begin(self, work: &str) -> Box<dyn Progress + 'a> {
        match self {
            Self::Terminal => Box::new(TerminalProgress::new(work)),
            Self::Program(receiver) => Box::new(NamedProgress {
                receiver,
                work: work.to_owned(),
            }),
        }
    }
}

/// Progress in one part of the work, passed on with the part's label.
struct NamedProgress<'a> {
    receiver: &'a dyn Progress,
    work: String,
}

impl Progress for NamedProgress<'_> {
    fn cancelled(&self) -> bool {
        self.receiver.cancelled()
    }

    fn advanced(&self, done: usize, total: usize) {
        self.receiver.step(&self.work);
        self.receiver.advanced(done, total);
    }
}

/// Progress while files are read, shown only on a terminal.
pub(super) struct ReadingProgress {
    bar: ProgressBar,
}

impl ReadingProgress {
    pub(super) fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, progress_target());
        // If the template is invalid, the default style remains.
        if let Ok(style) = ProgressStyle::with_template("reading {pos} of {len}: {msg}") {
            bar.set_style(style);
        }
        Self { bar }
    }
}

impl FolderProgress for ReadingProgress {
    fn reading(&self, number: usize, of: usize, name: &str) {
        self.bar.set_length(of as u64);
        self.bar.set_position(number as u64);
        self.bar.set_message(sanitized(name));
    }
}

impl Drop for ReadingProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Delay before the progress bar appears; shorter work shows none.
const QUICK: Duration = Duration::from_millis(500);

/// Progress bar on standard error, if that is a terminal, once the work has taken [`QUICK`]. While
/// the bar exists, Ctrl+C stops the work at its next step, with a message and the exit status for
/// incomplete work.
pub(super) struct TerminalProgress {
    bar: ProgressBar,
    /// Whether the bar appears after [`QUICK`]; decided at the start, because the output format is
    /// a setting of the thread that begins the work.
    is_shown: bool,
    started: Instant,
    interruptible: Interruptible,
}

impl TerminalProgress {
    /// Creates the bar with the label `work`.
    pub(super) fn new(work: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        // If the template is invalid, the default style remains.
        if let Ok(style) =
            ProgressStyle::with_template(&format!("{work} {{bar:40}} {{percent}} % (Ctrl+C stops)"))
        {
            bar.set_style(style);
        }
        Self {
            bar,
            is_shown: shows_progress(),
            started: Instant::now(),
            interruptible: Interruptible::begin(),
        }
    }
}

impl Drop for TerminalProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for TerminalProgress {
    fn cancelled(&self) -> bool {
        self.interruptible.is_requested()
    }

    fn advanced(&self, done: usize, total: usize) {
        if self.is_shown && self.bar.is_hidden() && self.started.elapsed() >= QUICK {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
    }
}

/// Returns where progress bars are drawn: nowhere if standard error is not a terminal, or if JSON
/// or quiet output is requested.
fn progress_target() -> ProgressDrawTarget {
    if shows_progress() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    }
}
