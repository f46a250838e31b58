//! What a command says: results on standard output, notes, cautions and errors on standard error, or all of it as one JSON object.

use std::io::{ErrorKind, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use gdcm_core::dataset::ConditionId;
use gdcm_core::message_text::{sanitized, shortened_message};
use gdcm_core::study::Progress;
use gdcm_files::{system_words, write_pretty};

use super::{Failure, listed_conditions};

/// How a command says what it says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Manner {
    /// Without notes.
    pub(super) quiet: bool,
    /// As one JSON object, once it has ended.
    pub(super) json: bool,
}

/// What a command has said, for its JSON object.
#[derive(Debug, Serialize)]
struct Said {
    #[serde(skip)]
    manner: Manner,
    format: &'static str,
    version: u32,
    status: u8,
    /// What stands on standard output otherwise.
    text: String,
    notes: Vec<String>,
    cautions: Vec<SaidCaution>,
    errors: Vec<String>,
}

/// A caution, and the conditions that it is of; none where it is of the whole.
#[derive(Debug, Serialize)]
struct SaidCaution {
    text: String,
    conditions: Vec<i64>,
}

/// A process carries out one command.
static SAID: Mutex<Said> = Mutex::new(Said {
    manner: Manner { quiet: false, json: false },
    format: "gdcm-messages",
    version: 1,
    status: 0,
    text: String::new(),
    notes: Vec::new(),
    cautions: Vec::new(),
    errors: Vec::new(),
});

fn said() -> MutexGuard<'static, Said> {
    SAID.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on the command speaks so.
pub(super) fn speak(manner: Manner) {
    said().manner = manner;
}

/// Prints a text that ends with its own line end. A reader that has seen enough (`gdcm … | head`) is no failure.
pub(super) fn say(text: &str) -> Result<(), Failure> {
    // Whatever a file holds, control codes never reach a terminal.
    let text: String = text.split_inclusive('\n').map(|line| plain(line.trim_end_matches('\n'), line)).collect();
    let mut said = said();
    if said.manner.json {
        said.text += &text;
        return Ok(());
    }
    print(&text)
}

fn plain(words: &str, line: &str) -> String {
    let end = if line.ends_with('\n') { "\n" } else { "" };
    format!("{}{end}", shortened_message(&sanitized(words)))
}

fn print(text: &str) -> Result<(), Failure> {
    let mut output = std::io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::StandardOutput { reason: system_words(&error) })
        }
        _ => Ok(()),
    }
}

/// Says what was taken or chosen, and need not be acted upon.
pub(super) fn note(words: &str) {
    let mut said = said();
    if said.manner.json {
        said.notes.push(plain(words, ""));
    } else if !said.manner.quiet {
        complain("note", words);
    }
}

/// Says what has to be known, or acted upon, though the command goes on.
pub(super) fn caution(words: &str) {
    caution_of(&[], words);
}

/// The same caution of some conditions, said once with the conditions named.
pub(super) fn caution_of(conditions: &[ConditionId], words: &str) {
    if said().manner.json {
        return keep_caution(conditions, words);
    }
    let of = if conditions.is_empty() { String::new() } else { format!("{}: ", listed_conditions(conditions)) };
    complain("caution", &format!("{of}{words}"));
}

/// Keeps a caution for the JSON object, where it stands apart; the text says it at its own place.
pub(super) fn keep_caution(conditions: &[ConditionId], words: &str) {
    let conditions = conditions.iter().map(|id| id.0).collect();
    said().cautions.push(SaidCaution { text: plain(words, ""), conditions });
}

/// Says what is wrong.
pub(super) fn error(words: &str) {
    let mut said = said();
    if said.manner.json { said.errors.push(plain(words, "")) } else { complain("error", words) }
}

/// Prints one line on standard error; there is nowhere to complain of a failure to do so.
fn complain(kind: &str, words: &str) {
    let _ = writeln!(std::io::stderr(), "{kind}: {}", plain(words, ""));
}

/// Ends the command with this status: the JSON object is printed where one is asked for.
pub(super) fn end(status: u8) -> u8 {
    let mut said = said();
    said.status = status;
    if !said.manner.json {
        return status;
    }
    // Texts, numbers and lists are JSON whatever they hold.
    let mut object = Vec::new();
    let written = write_pretty(&*said, &mut object);
    debug_assert!(written.is_ok(), "there is memory to write to");
    match print(&String::from_utf8_lossy(&object)) {
        Ok(()) => status,
        Err(failure) => {
            complain("error", &failure.to_string());
            failure.status()
        }
    }
}

/// Where progress is drawn: nowhere where standard error is no terminal, or nothing but results is asked for.
pub(super) fn progress_target() -> ProgressDrawTarget {
    if said().manner == Manner::default() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() }
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
            self.bar.set_draw_target(progress_target());
        }
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
    }
}
