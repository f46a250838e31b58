//! What a command says: results on standard output, notes, cautions and errors on standard error, or all of it as one JSON object; why
//! it was not carried out, with the exit status that says so; tables and words behind labels.

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
use gdcm_study::study::Table;

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
    /// The stable code of each error; null of one that has none.
    error_codes: Vec<Option<&'static str>>,
}

/// A caution, and the conditions that it is of; none where it is of the whole.
#[derive(Debug, Serialize)]
struct SaidCaution {
    /// Stable name of what it is about, where it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    code: Option<&'static str>,
    text: String,
    conditions: Vec<i64>,
}

/// A process carries out one command.
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

/// From now on the command speaks so.
pub(super) fn speak(manner: Manner) {
    said().manner = manner;
}

/// Prints a text that ends with its own line end. A reader that has seen enough (`gdcm … | head`) is no failure.
pub(super) fn say(text: &str) -> Result<(), Failure> {
    // Whatever a file holds, control codes never reach a terminal.
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
    coded_caution(None, conditions, words);
}

/// A caution with the stable name of what it is about.
pub(super) fn coded_caution(code: Option<&'static str>, conditions: &[ConditionId], words: &str) {
    if said().manner.json {
        return keep_coded_caution(code, conditions, words);
    }
    complain("caution", &of_conditions(conditions, words));
}

/// Keeps a caution for the JSON object, where it stands apart; the text says it at its own place.
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

/// Says what is wrong.
pub(super) fn error(words: &str) {
    coded_error(None, words);
}

/// Says what is wrong; programs that read the JSON object tell it by its code.
pub(super) fn coded_error(code: Option<&'static str>, words: &str) {
    let mut said = said();
    if said.manner.json {
        said.errors.push(plain(words, ""));
        said.error_codes.push(code);
    } else {
        complain("error", words);
    }
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
    if said().manner == Manner::default() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    }
}

/// An analysis that is done sooner needs no progress.
const QUICK: Duration = Duration::from_millis(500);

/// A bar on standard error, where that is a terminal, once the analysis takes longer than half a second. While there is one, Ctrl+C
/// ends the work at its next step, with a message and the status of work that was not done.
pub(super) struct TerminalProgress {
    bar: ProgressBar,
    started: Instant,
    #[cfg(unix)]
    _interruptible: Interruptible,
}

impl TerminalProgress {
    /// `doing` says what takes the time.
    pub(super) fn new(doing: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        // A template that is not understood leaves the bar its own looks.
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

    /// Elsewhere Ctrl+C ends the process at once, which leaves no half of a file either.
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

/// Work that asks whether it was interrupted (SIGINT, Ctrl+C). Without one, and from the second interruption on, a process ends at once.
#[cfg(unix)]
struct Interruptible;

/// What an interruption does, for as long as the process lives.
#[cfg(unix)]
struct Interruption {
    /// Whether there was one.
    is_asked: Arc<AtomicBool>,
    /// Whether the next one ends the process.
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
    // In this order: the first interruption of work only arms what the second does. Where the system refuses, Ctrl+C ends the process.
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

/// Exit status where the analysis could not be done.
pub(super) const NOT_DONE: u8 = 1;
/// Exit status where the command line or a file is wrong.
pub(super) const WRONG_INPUT: u8 = 2;

/// Why a command was not carried out.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    /// A file cannot be read or written.
    #[error("{0}{remedy}", remedy = if matches!(.0, FileError::Exists { .. }) { "; --force overwrites" } else { "" })]
    File(#[from] FileError),
    /// An option's value is wrong for this dataset.
    #[error("{option}: {reason}")]
    Option {
        option: &'static str,
        reason: String,
    },
    /// A word stands in place of a command or a file, and is neither.
    #[error("{found}: there is no such command and no such file; did you mean gdcm {suggestion}?")]
    UnknownCommand { found: String, suggestion: String },
    /// The dataset of a study is not the one that it was made with.
    #[error(
        "{path}: {count} differences from what the study was made with, and --strict asks for none"
    )]
    Different { path: String, count: usize },
    /// A dataset has several faults, which were told.
    #[error("{path}: {count} faults; once they are mended, check the file again")]
    Faulty { path: String, count: usize },
    /// A file of models, where a dataset or a study is asked for.
    #[error(
        "{path}: this is neither a dataset nor a study; a dataset is made of model files by gdcm assemble {path} --out \
         dataset.json.gz, or in the window by Import models"
    )]
    Models { path: String },
    /// Something is still to be said before files are a dataset.
    #[error("no dataset was made: {count} {} to complete; do so in {rules} and give it with --rules", if *count == 1 { "item" } else { "items" })]
    Incomplete { count: usize, rules: String },
    /// Records whose columns are not clear, or cannot be what they are taken for; each was told.
    #[error("{wrong} of {of} {} cannot be taken as they are: say which column is which (--inputs P=COLUMN, --time) and in which unit (--unit P=deg/s), or leave them out", if *of == 1 { "record" } else { "records" })]
    Records { wrong: usize, of: usize },
    /// Files of which nothing could be taken.
    #[error("{paths}: no {what} that could be taken")]
    Nothing { paths: String, what: &'static str },
    /// Records that were asked for by name could not be read, or not all that is in them; what could was used.
    #[error("{paths}: not read, or not all of it; what was made is without that")]
    Unread { paths: String },
    /// What was asked for was identified, and nothing of it is of use.
    #[error("no input is identified in these records: the models say nothing of {inputs}")]
    NotIdentified { inputs: String },
    /// No thread is to be had.
    #[error("no thread is to be had to compute with: {reason}")]
    NoThreads { reason: String },
    /// No model was identified.
    #[error("no model was identified: {reason}")]
    NoModels { reason: String },
    /// No condition has a result.
    #[error("the analysis has no result: {reason}")]
    NoResult { reason: String },
    /// The analysis was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Standard output cannot be written.
    #[error("standard output cannot be written: {reason}")]
    StandardOutput { reason: String },
}

impl Failure {
    /// Nothing could be taken of files.
    pub(super) fn nothing_in(paths: &[PathBuf], what: &'static str) -> Self {
        Failure::Nothing {
            paths: listed_paths(paths),
            what,
        }
    }

    /// What an option says is refused.
    pub(super) fn option(option: &'static str, reason: impl ToString) -> Self {
        Failure::Option {
            option,
            reason: reason.to_string(),
        }
    }

    /// The stable code by which scripts tell it from others; none where there is none yet.
    pub(super) fn code(&self) -> Option<&'static str> {
        match self {
            Failure::File(error) => error.code(),
            Failure::UnknownCommand { .. } => Some("unknown-command"),
            Failure::Cancelled(_) => Some("stopped"),
            _ => None,
        }
    }

    /// The exit status.
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

/// Paths with commas.
pub(super) fn listed_paths(paths: &[PathBuf]) -> String {
    paths
        .iter()
        .map(|path| sanitized_path(path))
        .collect::<Vec<_>>()
        .join(", ")
}

/// A table as lines, each behind so many spaces; long names are cut.
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

/// Most columns of a page.
const PAGE: usize = 110;

/// Width of the labels at the left of a section.
const LABEL: usize = 14;

/// A line of a text: words behind a label at its left.
pub(super) fn line(label: &str, words: &str) -> String {
    labelled(0, label, LABEL, words)
}

/// A line of a section, which is set in.
pub(super) fn detail(label: &str, words: &str) -> String {
    labelled(2, label, LABEL - 2, words)
}

/// Words behind a label, broken between words into lines of at most [`PAGE`] columns that stand under one another.
fn labelled(indent: usize, label: &str, width: usize, words: &str) -> String {
    hanging(indent, label, width, shortened_message(words).split(' '))
}

/// A list in a section, with commas, broken between its entries; says so where it is empty.
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

/// "condition 3", "conditions 3, 4, 7", "conditions 1 to 3, 7": three in a row or more by their ends.
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

/// Words with the conditions that they are about before them; none where they are about the whole.
pub(super) fn of_conditions(conditions: &[ConditionId], words: &str) -> String {
    if conditions.is_empty() {
        words.to_owned()
    } else {
        format!("{}: {words}", listed_conditions(conditions))
    }
}

/// Words about conditions, each once with all conditions that it is said of, in the order in which they were said first.
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
