//! Error in a call, with the same code as in the command.

use std::fmt;

use serde_json::{Map, Value, json};

use gdcm_io::FileError;

use crate::cli::failure::Failure;

/// Reason why a call has no result.
#[derive(Clone, Debug)]
pub struct CallError {
    /// Stable code, the same as in the command.
    pub code: &'static str,
    pub text: String,
    /// The command's exit status.
    pub status: u8,
    /// Details that the text mentions, by name: `option`, `path`, `line`.
    pub fields: Box<Map<String, Value>>,
    /// Messages that the command would print before the error, as the object that `--json` prints.
    pub messages: Box<Value>,
}

impl CallError {
    pub(super) fn new(failure: &Failure, messages: Value) -> Self {
        Self {
            code: failure.code(),
            text: failure.to_string(),
            status: failure.status(),
            fields: Box::new(failure_fields(failure)),
            messages: Box::new(messages),
        }
    }
}

impl fmt::Display for CallError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.text)
    }
}

impl std::error::Error for CallError {}

/// Returns the values in a failure's text, by name.
fn failure_fields(failure: &Failure) -> Map<String, Value> {
    let fields = match failure {
        Failure::File(error) => return file_fields(error),
        Failure::Export(_) | Failure::Cancelled(_) => json!({}),
        Failure::CommandLine { words } => json!({"reason": words}),
        Failure::Option { option, reason, .. } => json!({"option": option, "reason": reason}),
        Failure::UnknownCommand { found, suggestion } => {
            json!({"found": found, "suggestion": suggestion})
        }
        Failure::Deviating { failed, count } => json!({"failed": failed, "count": count}),
        Failure::Different { path, count } | Failure::Faulty { path, count } => {
            json!({"path": path, "count": count})
        }
        Failure::Models { path } => json!({"path": path}),
        Failure::Incomplete { count, rules } => json!({"count": count, "rules": rules}),
        Failure::Records { wrong, count } => json!({"wrong": wrong, "count": count}),
        Failure::Nothing { paths, noun } => json!({"paths": paths, "noun": noun}),
        Failure::Unread { paths } => json!({"paths": paths}),
        Failure::NotIdentified { inputs } => json!({"inputs": inputs}),
        Failure::NoThreads { reason }
        | Failure::NoModels { reason }
        | Failure::NoPlan { reason }
        | Failure::NoResult { reason }
        | Failure::StandardOutput { reason } => json!({"reason": reason}),
    };
    match fields {
        Value::Object(fields) => fields,
        _ => Map::new(),
    }
}

/// Returns the path in a file error and, where it has them, the paths of existing files, the place
/// in the content and the line.
fn file_fields(error: &FileError) -> Map<String, Value> {
    let mut fields = Map::new();
    if let Some(path) = error.path() {
        fields.insert("path".to_owned(), path.to_string_lossy().into());
    }
    if let FileError::Exists { paths } = error {
        let paths: Vec<Value> = paths
            .iter()
            .map(|path| path.to_string_lossy().into())
            .collect();
        fields.insert("paths".to_owned(), Value::Array(paths));
    }
    if let Some(place) = error.place() {
        fields.insert("place".to_owned(), place.to_string().into());
    }
    if let Some(line) = error.line() {
        fields.insert("line".to_owned(), line.into());
    }
    fields
}
