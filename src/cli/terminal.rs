//! A command's output: results on standard output; notes, cautions and errors on standard error.
//! With `--json`, a single JSON object on standard output contains all of these.

use std::cell::RefCell;
use std::io::{ErrorKind, Write};
use std::mem::take;

use serde::Serialize;

use gdcm_io::file_error::system_words;
use gdcm_io::json_writing::write_pretty;
use gdcm_model::dataset::ConditionId;
use gdcm_model::message_text::{sanitized, shortened_message};
use gdcm_verify::CheckResult;

use super::condition_messages::with_conditions;
use super::failure::Failure;

/// Format for a command's output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct OutputFormat {
    /// Whether notes are omitted.
    pub(super) quiet: bool,
    /// Whether a single JSON object is printed at the end.
    pub(super) json: bool,
}

/// Output collected for the JSON object.
#[derive(Debug, Default, Serialize)]
struct Messages {
    #[serde(skip)]
    output: OutputFormat,
    status: u8,
    /// Text that would otherwise be printed on standard output.
    text: String,
    notes: Vec<String>,
    /// Stable code for each note.
    note_codes: Vec<&'static str>,
    cautions: Vec<Caution>,
    errors: Vec<String>,
    /// Stable code for each error.
    error_codes: Vec<&'static str>,
    /// Comparisons made by `gdcm verify`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    checks: Vec<ComparedCheck>,
}

/// A comparison with independent figures.
#[derive(Debug, Serialize)]
struct ComparedCheck {
    /// Stable code for the comparison.
    code: &'static str,
    /// Sections in the description of the method: "M8".
    sections: &'static str,
    passed: bool,
    instances: Option<usize>,
    values: Option<usize>,
    /// Maximum deviation; null if it is not finite or nothing could be compared.
    worst: Option<f64>,
    tolerance: f64,
    measure: &'static str,
    /// Code for the reason why nothing could be compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    fault: Option<&'static str>,
}

impl ComparedCheck {
    fn new(result: &CheckResult) -> Self {
        let check = result.check;
        let compared = Self {
            code: check.code,
            sections: check.sections,
            passed: result.passed(),
            instances: None,
            values: None,
            worst: None,
            tolerance: check.tolerance,
            measure: check.measure,
            fault: None,
        };
        match &result.outcome {
            Ok(found) => Self {
                instances: Some(found.instances),
                values: Some(found.values),
                // JSON has no infinity: it becomes null.
                worst: Some(found.worst),
                ..compared
            },
            Err(fault) => Self {
                fault: Some(fault.code()),
                ..compared
            },
        }
    }
}

/// The JSON object, with its format's name and version.
#[derive(Serialize)]
struct MessagesText<'m> {
    format: &'static str,
    version: u32,
    #[serde(flatten)]
    messages: &'m Messages,
}

impl<'m> MessagesText<'m> {
    fn new(messages: &'m Messages) -> Self {
        Self {
            format: "gdcm-messages",
            version: 1,
            messages,
        }
    }
}

/// A caution with its conditions; without conditions, it concerns the whole result.
#[derive(Debug, Serialize)]
struct Caution {
    /// Stable code for the kind of caution.
    code: &'static str,
    /// Codes for the cautions that a table summarises.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    summarised_codes: Vec<&'static str>,
    text: String,
    conditions: Vec<i64>,
}

thread_local! {
    /// Output from the command that this thread carries out. Only the thread that begins a command
    /// writes output; a program that embeds the commands may carry out several at once.
    static MESSAGES: RefCell<Messages> = RefCell::default();
}

/// Carries out `work`, and returns its result together with its output as the JSON object; prints
/// nothing. Output that the thread collected before is put back afterwards.
pub(super) fn collected<T>(work: impl FnOnce() -> T) -> (T, serde_json::Value) {
    let before = MESSAGES.take();
    set_output(OutputFormat {
        quiet: false,
        json: true,
    });
    let result = work();
    let messages = MESSAGES.replace(before);
    let object = serde_json::to_value(MessagesText::new(&messages)).unwrap_or_default();
    (result, object)
}

/// Sets the output format for the commands that this thread carries out.
pub(super) fn set_output(output: OutputFormat) {
    MESSAGES.with_borrow_mut(|messages| messages.output = output);
}

fn is_json() -> bool {
    MESSAGES.with_borrow(|messages| messages.output.json)
}

/// Returns whether progress is shown: not if JSON or quiet output is requested.
pub(super) fn shows_progress() -> bool {
    MESSAGES.with_borrow(|messages| messages.output == OutputFormat::default())
}

/// Prints a text, which includes its line end, or adds it to the JSON output; control characters
/// are removed. If a reader closes the pipe early, as in `gdcm … | head`, this is not a failure.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut plain_text = String::new();
    for line in text.split_inclusive('\n') {
        plain_text += &plain(line.trim_end_matches('\n'));
        if line.ends_with('\n') {
            plain_text.push('\n');
        }
    }
    if is_json() {
        MESSAGES.with_borrow_mut(|messages| messages.text += &plain_text);
        return Ok(());
    }
    write_standard_output(&plain_text)
}

/// Removes control characters, which may come from files and must not reach the terminal, and
/// shortens very long messages.
fn plain(words: &str) -> String {
    shortened_message(&sanitized(words))
}

fn write_standard_output(text: &str) -> Result<(), Failure> {
    let mut output = std::io::stdout().lock();
    let written = output
        .write_all(text.as_bytes())
        .and_then(|()| output.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::StandardOutput {
            reason: system_words(&error),
        }),
        _ => Ok(()),
    }
}

/// Prints a line on standard error; a failure to print is ignored, since it cannot be reported.
fn write_standard_error(kind: &str, words: &str) {
    let _ = writeln!(std::io::stderr(), "{kind}: {}", plain(words));
}

/// Prints a note about an assumption that needs no action, or adds it to the JSON output.
pub(super) fn note(code: &'static str, words: &str) {
    MESSAGES.with_borrow_mut(|messages| {
        if messages.output.json {
            messages.notes.push(plain(words));
            messages.note_codes.push(code);
        } else if !messages.output.quiet {
            write_standard_error("note", words);
        }
    });
}

/// Prints a caution about a problem that may need action although the command continues, or adds it
/// to the JSON output.
pub(super) fn caution(code: &'static str, words: &str) {
    caution_for(code, &[], words);
}

/// Prints a caution about several conditions once, with a list of the conditions; or adds it to the
/// JSON output.
pub(super) fn caution_for(code: &'static str, conditions: &[ConditionId], words: &str) {
    if is_json() {
        keep_caution(code, conditions, words);
    } else {
        write_standard_error("caution", &with_conditions(conditions, words));
    }
}

/// Adds a caution to the JSON object only; the text output includes it elsewhere.
pub(super) fn keep_caution(code: &'static str, conditions: &[ConditionId], words: &str) {
    keep_summary(code, Vec::new(), conditions, words);
}

/// Adds a caution that summarises cautions with the given codes to the JSON object only.
pub(super) fn keep_summary(
    code: &'static str,
    summarised_codes: Vec<&'static str>,
    conditions: &[ConditionId],
    words: &str,
) {
    let caution = Caution {
        code,
        summarised_codes,
        text: plain(words),
        conditions: conditions.iter().map(|id| id.0).collect(),
    };
    MESSAGES.with_borrow_mut(|messages| messages.cautions.push(caution));
}

/// Adds the comparisons from `gdcm verify` to the JSON object.
pub(super) fn keep_checks(results: &[CheckResult]) {
    let checks = results.iter().map(ComparedCheck::new).collect();
    MESSAGES.with_borrow_mut(|messages| messages.checks = checks);
}

/// Prints an error, or adds it to the JSON output.
pub(super) fn error(code: &'static str, words: &str) {
    MESSAGES.with_borrow_mut(|messages| {
        if messages.output.json {
            messages.errors.push(plain(words));
            messages.error_codes.push(code);
        } else {
            write_standard_error("error", words);
        }
    });
}

/// Ends the command: prints the JSON object if requested. Returns the exit status, which is
/// `status` unless printing fails.
pub(super) fn end(status: u8) -> u8 {
    let mut messages = MESSAGES.with_borrow_mut(take);
    if !messages.output.json {
        return status;
    }
    messages.status = status;
    // Cannot fail: strings, numbers and lists can always be serialised, and writing to a vector
    // never fails.
    let mut object = Vec::new();
    let written = write_pretty(&MessagesText::new(&messages), &mut object);
    debug_assert!(written.is_ok(), "the messages serialise");
    match write_standard_output(&String::from_utf8_lossy(&object)) {
        Ok(()) => status,
        Err(failure) => {
            write_standard_error("error", &failure.to_string());
            failure.status()
        }
    }
}
