//! Output of the commands: results on standard output; notes, cautions and errors on standard
//! error, or everything as one JSON object. Also failures with their exit status, tables, and
//! labelled text.

use std::io::{ErrorKind, Write};
use std::path::PathBuf;
#[cfg(unix)]
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(unix)]
use std::sync::{Arc, LazyLock};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use gdcm_io::FileError;
use gdcm_io::file_error::system_words;
use gdcm_io::json_text::write_pretty;
use gdcm_model::dataset::ConditionId;
use gdcm_model::message_text::{sanitized, sanitized_path, shortened, shortened_message};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_words::Table;

/// Output format of a command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Manner {
    /// Omits notes.
    pub(super) quiet: bool,
    /// Prints one JSON object at the end.
    pub(super) json: bool,
}

/// Output collected for the JSON object.
#[derive(Debug, Serialize)]
struct Said {
    #[serde(skip)]
    manner: Manner,
    format: &'static str,
    version: u32,
    status: u8,
    /// Text otherwise printed on standard output.
    text: String,
    notes: Vec<String>,
    cautions: Vec<SaidCaution>,
    errors: Vec<String>,
    /// Stable code of each error; null if it has none.
    error_codes: Vec<Option<&'static str>>,
}

/// A caution with its conditions; no conditions if it concerns the whole.
#[derive(Debug, Serialize)]
struct SaidCaution {
    /// Stable code of its subject, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    code: Option<&'static str>,
    text: String,
    conditions: Vec<i64>,
}

/// Global, because a process carries out one command.
static SAID: Mutex<Said> = Mutex::new(Said {
    manner: Manner {
        quiet: false,
        json: false,
    },
    format: "gdcm-messages",
    version: 1,
    status: 0,
    text: String::new(),
    notes: Vec::new(),
    cautions: Vec::new(),
    errors: Vec::new(),
    error_codes: Vec::new(),
});

fn said() -> MutexGuard<'static, Said> {
    SAID.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sets the output format of the command.
pub(super) fn speak(manner: Manner) {
    said().manner = manner;
}

/// Prints a text, which includes its line end. A reader that closes the pipe early (`gdcm …
/// head`) is no failure.
pub(super) fn say(text: &str) -> Result<(), Failure> {
    // Control codes from a file never reach the terminal.
    let text: String = text
        .split_inclusive('\n')
        .map(|line| plain(line.trim_end_matches('\n'), line))
        .collect();
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
    match output
        .write_all(text.as_bytes())
        .and_then(|()| output.flush())
    {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::StandardOutput {
            reason: system_words(&error),
        }),
        _ => Ok(()),
    }
}

/// Reports a choice or an assumption that needs no action.
pub(super) fn note(words: &str) {
    let mut said = said();
    if said.manner.json {
        said.notes.push(plain(words, ""));
    } else if !said.manner.quiet {
        complain("note", words);
    }
}

/// Reports a problem that may need action although the command continues.
pub(super) fn caution(words: &str) {
    caution_of(&[], words);
}

/// Reports the same caution for several conditions once, with the conditions listed.
pub(super) fn caution_of(conditions: &[ConditionId], words: &str) {
    coded_caution(None, conditions, words);
}

/// Reports a caution with a stable code.
pub(super) fn coded_caution(code: Option<&'static str>, conditions: &[ConditionId], words: &str) {
    if said().manner.json {
        return keep_coded_caution(code, conditions, words);
    }
    complain("caution", &of_conditions(conditions, words));
}

/// Adds a caution to the JSON object only; the text output includes it elsewhere.
pub(super) fn keep_caution(conditions: &[ConditionId], words: &str) {
    keep_coded_caution(None, conditions, words);
}

pub(super) fn keep_coded_caution(
    code: Option<&'static str>,
    conditions: &[ConditionId],
    words: &str,
) {
    let conditions = conditions.iter().map(|id| id.0).collect();
    said().cautions.push(SaidCaution {
        code,
        text: plain(words, ""),
        conditions,
    });
}

/// Reports an error.
pub(super) fn error(words: &str) {
    coded_error(None, words);
}

/// Reports an error with a stable code for programs that read the JSON object.
pub(super) fn coded_error(code: Option<&'static str>, words: &str) {
    let mut said = said();
    if said.manner.json {
        said.errors.push(plain(words, ""));
        said.error_codes.push(code);
    } else {
        complain("error", words);
    }
}

/// Prints one line on standard error; a failure to do so cannot be reported.
fn complain(kind: &str, words: &str) {
    let _ = writeln!(std::io::stderr(), "{kind}: {}", plain(words, ""));
}

/// Ends the command with this status; prints the JSON object if requested.
pub(super) fn end(status: u8) -> u8 {
    let mut said = said();
    said.status = status;
    if !said.manner.json {
        return status;
    }
    // Texts, numbers and lists always serialise.
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

/// Returns the target of progress bars: hidden if standard error is no terminal or only results are
/// requested.
pub(super) fn progress_target() -> ProgressDrawTarget {
    if said().manner == Manner::default() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    }
}

/// Shorter analyses show no progress.
const QUICK: Duration = Duration::from_millis(500);

/// Progress bar on standard error, if that is a terminal, once the analysis takes longer than half
/// a second. While it exists, Ctrl+C ends the work at its next step, with a message and the exit
/// status of incomplete work.
pub(super) struct TerminalProgress {
    bar: ProgressBar,
    started: Instant,
    #[cfg(unix)]
    _interruptible: Interruptible,
}

impl TerminalProgress {
    /// Creates the bar; `doing` names the work.
    pub(super) fn new(doing: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        // An invalid template leaves the default style.
        if let Ok(style) = ProgressStyle::with_template(&format!(
            "{doing} {{bar:40}} {{percent}} % (Ctrl+C stops)"
        )) {
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
        Interruptible::is_asked()
    }

    /// On other systems Ctrl+C ends the process at once, which leaves no partial file either.
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

/// Work that checks for interruptions (SIGINT, Ctrl+C). Without such work, and from the second
/// interruption on, the process ends at once.
#[cfg(unix)]
struct Interruptible;

/// State of interruptions for the lifetime of the process.
#[cfg(unix)]
struct Interruption {
    /// Whether an interruption occurred.
    is_asked: Arc<AtomicBool>,
    /// Whether the next interruption ends the process.
    ends_process: Arc<AtomicBool>,
}

#[cfg(unix)]
static INTERRUPTION: LazyLock<Interruption> = LazyLock::new(|| {
    use signal_hook::consts::SIGINT;
    use signal_hook::flag;
    let interruption = Interruption {
        is_asked: Arc::default(),
        ends_process: Arc::new(AtomicBool::new(true)),
    };
    // The order matters: the first interruption of work only arms the second. If the system
    // refuses, Ctrl+C ends the process.
    let _ = flag::register_conditional_default(SIGINT, Arc::clone(&interruption.ends_process));
    let _ = flag::register(SIGINT, Arc::clone(&interruption.ends_process));
    let _ = flag::register(SIGINT, Arc::clone(&interruption.is_asked));
    interruption
});

#[cfg(unix)]
impl Interruptible {
    fn new() -> Self {
        INTERRUPTION.ends_process.store(false, Ordering::SeqCst);
        Self
    }

    fn is_asked() -> bool {
        INTERRUPTION.is_asked.load(Ordering::SeqCst)
    }
}

#[cfg(unix)]
impl Drop for Interruptible {
    fn drop(&mut self) {
        INTERRUPTION.ends_process.store(true, Ordering::SeqCst);
    }
}

/// Exit status if the analysis could not be done.
pub(super) const NOT_DONE: u8 = 1;
/// Exit status if the command line or a file is wrong.
pub(super) const WRONG_INPUT: u8 = 2;

/// Reason why a command was not carried out.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    #[error("{0}{remedy}", remedy = if matches!(.0, FileError::Exists { .. }) { "; --force overwrites" } else { "" })]
    File(#[from] FileError),
    #[error("{option}: {reason}")]
    Option {
        option: &'static str,
        reason: String,
    },
    /// The first word is neither a command nor a file, but resembles a command.
    #[error("{found}: there is no such command and no such file; did you mean gdcm {suggestion}?")]
    UnknownCommand { found: String, suggestion: String },
    /// The study's dataset differs from the dataset that the study was made with.
    #[error(
        "{path}: {count} differences from what the study was made with, and --strict asks for none"
    )]
    Different { path: String, count: usize },
    /// Several faults in a dataset, each already reported.
    #[error("{path}: {count} faults; once they are mended, check the file again")]
    Faulty { path: String, count: usize },
    /// A model file instead of a dataset or a study.
    #[error(
        "{path}: this is neither a dataset nor a study; a dataset is made of model files by gdcm assemble {path} --out \
         dataset.json.gz, or in the window by Import models"
    )]
    Models { path: String },
    /// The rules are incomplete, so the files do not form a dataset yet.
    #[error("no dataset was made: {count} {} to complete; do so in {rules} and give it with --rules", if *count == 1 { "item" } else { "items" })]
    Incomplete { count: usize, rules: String },
    /// Records with unclear or impossible columns, each already reported.
    #[error("{wrong} of {of} {} cannot be taken as they are: say which column is which (--inputs P=COLUMN, --time) and in which unit (--unit P=deg/s), or leave them out", if *of == 1 { "record" } else { "records" })]
    Records { wrong: usize, of: usize },
    /// No usable content in the files.
    #[error("{paths}: no {what} that could be taken")]
    Nothing { paths: String, what: &'static str },
    /// Named records that could not be read, or not completely; the rest was used.
    #[error("{paths}: not read, or not all of it; what was made is without that")]
    Unread { paths: String },
    /// Identification ran but identified no input.
    #[error("no input is identified in these records: the models say nothing of {inputs}")]
    NotIdentified { inputs: String },
    #[error("no thread is to be had to compute with: {reason}")]
    NoThreads { reason: String },
    #[error("no model was identified: {reason}")]
    NoModels { reason: String },
    #[error("the analysis has no result: {reason}")]
    NoResult { reason: String },
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    #[error("standard output cannot be written: {reason}")]
    StandardOutput { reason: String },
}

impl Failure {
    /// Returns the failure for files without usable content.
    pub(super) fn nothing_in(paths: &[PathBuf], what: &'static str) -> Self {
        Failure::Nothing {
            paths: listed_paths(paths),
            what,
        }
    }

    /// Returns the failure for a wrong option value.
    pub(super) fn option(option: &'static str, reason: impl ToString) -> Self {
        Failure::Option {
            option,
            reason: reason.to_string(),
        }
    }

    /// Returns the stable code for scripts; `None` if there is none yet.
    pub(super) fn code(&self) -> Option<&'static str> {
        match self {
            Failure::File(error) => error.code(),
            Failure::UnknownCommand { .. } => Some("unknown-command"),
            Failure::Cancelled(_) => Some("stopped"),
            _ => None,
        }
    }

    /// Returns the exit status.
    pub(super) fn status(&self) -> u8 {
        match self {
            Failure::File(FileError::Unwritable { .. })
            | Failure::NoResult { .. }
            | Failure::NoModels { .. }
            | Failure::Unread { .. }
            | Failure::NotIdentified { .. }
            | Failure::NoThreads { .. }
            | Failure::Cancelled(_)
            | Failure::StandardOutput { .. } => NOT_DONE,
            Failure::File(FileError::Export { fault, .. }) if fault.is_of_analysis() => NOT_DONE,
            Failure::File(_)
            | Failure::Option { .. }
            | Failure::UnknownCommand { .. }
            | Failure::Different { .. }
            | Failure::Incomplete { .. }
            | Failure::Records { .. }
            | Failure::Nothing { .. }
            | Failure::Models { .. }
            | Failure::Faulty { .. } => WRONG_INPUT,
        }
    }
}

/// Joins paths with commas.
pub(super) fn listed_paths(paths: &[PathBuf]) -> String {
    paths
        .iter()
        .map(|path| sanitized_path(path))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Formats a table as lines indented by `indent` spaces; shortens long names.
pub(super) fn indented(table: &Table, indent: usize) -> String {
    let mut table = table.clone();
    table
        .rows
        .iter_mut()
        .flatten()
        .for_each(|cell| *cell = shortened(cell));
    table
        .text()
        .lines()
        .map(|line| format!("{:indent$}{line}\n", ""))
        .collect()
}

/// Maximum width of a page in columns.
const PAGE: usize = 110;

/// Width of the labels at the left of a section, in columns.
const LABEL: usize = 14;

/// Returns a line of text behind a label.
pub(super) fn line(label: &str, words: &str) -> String {
    labelled(0, label, LABEL, words)
}

/// Returns an indented line of a section.
pub(super) fn detail(label: &str, words: &str) -> String {
    labelled(2, label, LABEL - 2, words)
}

/// Returns words behind a label, wrapped at [`PAGE`] columns with the lines aligned.
fn labelled(indent: usize, label: &str, width: usize, words: &str) -> String {
    hanging(indent, label, width, shortened_message(words).split(' '))
}

/// Returns a comma-separated list in a section, wrapped between entries; reports an empty list.
pub(super) fn detail_list(label: &str, entries: &[String]) -> String {
    if entries.is_empty() {
        return detail(label, "none");
    }
    let last = entries.len().saturating_sub(1);
    let with_comma = |(index, entry): (usize, &String)| {
        let entry = shortened_message(entry);
        if index < last {
            format!("{entry},")
        } else {
            entry
        }
    };
    let entries: Vec<String> = entries.iter().enumerate().map(with_comma).collect();
    hanging(2, label, LABEL - 2, entries.iter().map(String::as_str))
}

fn hanging<'w>(
    indent: usize,
    label: &str,
    width: usize,
    pieces: impl Iterator<Item = &'w str>,
) -> String {
    let mut text = format!("{:indent$}{label:<width$}", "");
    let start = text.chars().count();
    let mut column = start;
    for piece in pieces {
        let length = piece.chars().count();
        if column > start && column + 1 + length > PAGE {
            text.push_str(&format!("\n{:start$}", ""));
            column = start;
        }
        if column > start {
            text.push(' ');
            column += 1;
        }
        text.push_str(piece);
        column += length;
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// Returns "condition 3", "conditions 3, 4, 7", "conditions 1 to 3, 7": three or more in a row by
/// their ends.
pub(super) fn listed_conditions(conditions: &[ConditionId]) -> String {
    let runs = conditions.chunk_by(|one, next| one.0.checked_add(1) == Some(next.0));
    let words = runs.flat_map(|run| match run {
        [first, _, .., last] => vec![format!("{first} to {last}")],
        few => few.iter().map(ToString::to_string).collect(),
    });
    let several = if conditions.len() == 1 { "" } else { "s" };
    format!(
        "condition{several} {}",
        words.collect::<Vec<_>>().join(", ")
    )
}

/// Prefixes words with their conditions; no prefix if they concern the whole.
pub(super) fn of_conditions(conditions: &[ConditionId], words: &str) -> String {
    if conditions.is_empty() {
        words.to_owned()
    } else {
        format!("{}: {words}", listed_conditions(conditions))
    }
}

/// Groups equal messages: each with all its conditions, in the order of first occurrence.
pub(super) fn by_words<C: Into<Option<ConditionId>>>(
    said: impl IntoIterator<Item = (C, String)>,
) -> Vec<(Vec<ConditionId>, String)> {
    let mut grouped: Vec<(Vec<ConditionId>, String)> = Vec::new();
    for (condition, words) in said {
        let place = grouped
            .iter()
            .position(|(_, known)| *known == words)
            .unwrap_or(grouped.len());
        if place == grouped.len() {
            grouped.push((Vec::new(), words));
        }
        let conditions = &mut grouped[place].0;
        conditions.extend(
            condition
                .into()
                .filter(|condition| !conditions.contains(condition)),
        );
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn an_interruption_stops_work_that_reports_its_progress_and_does_not_end_the_process() {
        let progress = TerminalProgress::new("waiting");
        assert!(!progress.cancelled());
        signal_hook::low_level::raise(signal_hook::consts::SIGINT).unwrap();
        assert!(progress.cancelled());
        assert!(
            INTERRUPTION.ends_process.load(Ordering::SeqCst),
            "the next one ends the process"
        );
        assert_eq!(Failure::Cancelled(Cancelled).code(), Some("stopped"));
    }

    #[test]
    fn the_same_words_of_many_conditions_are_said_once_with_the_conditions_named() {
        let said = [(3, "late"), (4, "noisy"), (7, "late"), (7, "late")];
        let said = by_words(said.map(|(id, words)| (ConditionId(id), words.to_owned())));
        let lines: Vec<String> = said
            .iter()
            .map(|(of, words)| format!("{}: {words}", listed_conditions(of)))
            .collect();
        assert_eq!(lines, ["conditions 3, 7: late", "condition 4: noisy"]);
        let listed = |ids: &[i64]| {
            listed_conditions(&ids.iter().copied().map(ConditionId).collect::<Vec<_>>())
        };
        assert_eq!(listed(&[1, 2, 4, 5, 6, 9]), "conditions 1, 2, 4 to 6, 9");
        assert_eq!(
            listed(&[i64::MAX, i64::MIN, 3]),
            format!("conditions {}, {}, 3", i64::MAX, i64::MIN)
        );
    }

    #[test]
    fn long_words_hang_under_their_start() {
        let text = labelled(2, "rejected", 10, &"model ".repeat(40));
        assert!(text.lines().all(|line| line.chars().count() <= PAGE));
        assert!(
            text.lines()
                .skip(1)
                .all(|line| line.starts_with(&" ".repeat(12)) && line.chars().nth(12) == Some('m'))
        );
        assert_eq!(text.matches("model").count(), 40);
    }
}
