//! Progress on a terminal, and cancellation by Ctrl+C.

#[cfg(unix)]
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(unix)]
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use gdcm_io::FolderProgress;
use gdcm_model::message_text::sanitized;
use gdcm_model::progress::Progress;

use super::terminal::shows_progress;

/// Returns where progress bars are drawn: nowhere if standard error is not a terminal or only
/// results are requested.
fn progress_target() -> ProgressDrawTarget {
    if shows_progress() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    }
}

/// Progress of reading files, shown only on a terminal.
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

/// Delay before the progress bar appears; shorter analyses show none.
const QUICK: Duration = Duration::from_millis(500);

/// Progress bar on standard error, if that is a terminal, once the analysis has taken half a
/// second. While the bar exists, Ctrl+C stops the work at its next step, with a message and the
/// exit status of incomplete work.
pub(super) struct TerminalProgress {
    bar: ProgressBar,
    started: Instant,
    #[cfg(unix)]
    _interruptible: Interruptible,
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
            started: Instant::now(),
            #[cfg(unix)]
            _interruptible: Interruptible::new(),
        }
    }
}

impl Drop for TerminalProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for TerminalProgress {
    #[cfg(unix)]
    fn cancelled(&self) -> bool {
        Interruptible::is_requested()
    }

    /// Returns false: without SIGINT, Ctrl+C ends the process at once, which leaves no partial file
    /// either.
    #[cfg(not(unix))]
    fn cancelled(&self) -> bool {
        false
    }

    fn advanced(&self, done: usize, total: usize) {
        if self.bar.is_hidden() && self.started.elapsed() >= QUICK {
            self.bar.set_draw_target(progress_target());
        }
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
    }
}

/// Marks work that checks for interruptions (SIGINT, Ctrl+C). Without such work, and from the
/// second interruption on, the process ends at once.
#[cfg(unix)]
struct Interruptible;

/// State of interruptions of the process.
#[cfg(unix)]
struct Interruption {
    /// Whether an interruption occurred.
    is_requested: Arc<AtomicBool>,
    /// Whether the next interruption ends the process.
    ends_process: Arc<AtomicBool>,
}

#[cfg(unix)]
static INTERRUPTION: LazyLock<Interruption> = LazyLock::new(|| {
    use signal_hook::consts::SIGINT;
    use signal_hook::flag;
    let interruption = Interruption {
        is_requested: Arc::default(),
        ends_process: Arc::new(AtomicBool::new(true)),
    };
    // The order matters: at the first interruption during work, the first handler still finds
    // `ends_process` unset, so that only the second interruption ends the process. If a
    // registration fails, Ctrl+C ends the process.
    let _ = flag::register_conditional_default(SIGINT, Arc::clone(&interruption.ends_process));
    let _ = flag::register(SIGINT, Arc::clone(&interruption.ends_process));
    let _ = flag::register(SIGINT, Arc::clone(&interruption.is_requested));
    interruption
});

#[cfg(unix)]
impl Interruptible {
    fn new() -> Self {
        INTERRUPTION.ends_process.store(false, Ordering::SeqCst);
        Self
    }

    fn is_requested() -> bool {
        INTERRUPTION.is_requested.load(Ordering::SeqCst)
    }
}

#[cfg(unix)]
impl Drop for Interruptible {
    fn drop(&mut self) {
        INTERRUPTION.ends_process.store(true, Ordering::SeqCst);
    }
}

#[cfg(test)]
mod tests {
    #[cfg(unix)]
    #[test]
    fn an_interruption_stops_work_that_reports_its_progress_and_does_not_end_the_process() {
        use super::{INTERRUPTION, Ordering, Progress, TerminalProgress};
        let progress = TerminalProgress::new("waiting");
        assert!(!progress.cancelled());
        signal_hook::low_level::raise(signal_hook::consts::SIGINT).unwrap();
        assert!(progress.cancelled());
        assert!(
            INTERRUPTION.ends_process.load(Ordering::SeqCst),
            "the next one ends the process"
        );
    }
}
