//! Translates serde_json errors into terms familiar to engineers.
//!
//! serde_json gives most details only in its message texts, such as "missing field `name`", so this
//! file depends on their wording; this crate's tests in `tests/suite/dataset_file/wrong_text.rs`
//! and `wrong_content.rs` fail if it changes. A text with another wording is reported as it is.

use std::path::Path;

use serde::de::IgnoredAny;
use serde_json::error::Category;

use gdcm_model::dataset::band::BandError;
use gdcm_model::dataset::location::Location;
use gdcm_model::message_text::{sanitized, shortened};
use gdcm_model::units::number;

use crate::content_fault::{ContentError, ContentFault};
use crate::file_error::FileError;
use crate::json_arrays::DIFFERENT_LENGTHS;

/// Line and column in a text, counted from 1; the column in bytes.
#[derive(Clone, Copy)]
struct Position {
    line: usize,
    column: usize,
}

/// Translates a serde_json error into a file error; `place` is the part of the file in which it
/// occurred.
pub(super) fn json_error(
    text: &[u8],
    path: &Path,
    place: Location,
    error: &serde_json::Error,
) -> FileError {
    let position = Position {
        line: error.line(),
        column: error.column(),
    };
    let full = error.to_string();
    let reason = match full.rsplit_once(" at line ") {
        Some((reason, _)) => reason,
        None => &full,
    };
    match error.classify() {
        Category::Eof => FileError::CutOff {
            path: path.to_owned(),
            place: Box::new(place),
            line: position.line,
            column: position.column,
        },
        Category::Data => {
            FileError::content(path, ContentError::new(place, data_fault(reason, position)))
        }
        _ => syntax_error(text, path, place, reason, position),
    }
}

/// Translates a syntax error. The first that applies: nesting that is too deep; a number that is
/// infinite or NaN; valid JSON, which has no string where a word is expected; any other error.
fn syntax_error(
    text: &[u8],
    path: &Path,
    place: Location,
    reason: &str,
    position: Position,
) -> FileError {
    let Position { line, column } = position;
    if reason.starts_with("recursion limit") {
        let fault = ContentFault::TooDeep { line, column };
        return FileError::content(path, ContentError::new(place, fault));
    }
    if let Some(found) = token_at(text, position)
        && is_number_like(&found)
    {
        let fault = ContentFault::NotFinite {
            found,
            line,
            column,
        };
        return FileError::content(path, ContentError::new(place, fault));
    }
    // serde_json also reports a syntax error in valid JSON if a value is not a string where an
    // enumeration is expected.
    if is_json_so_far(text) {
        let fault = ContentFault::Type {
            expected: "text in quotation marks".to_owned(),
            found: token_at(text, position).unwrap_or_else(|| "another kind of value".to_owned()),
            line,
            column,
        };
        return FileError::content(path, ContentError::new(place, fault));
    }
    FileError::NotJson {
        path: path.to_owned(),
        place: Box::new(place),
        line,
        column,
        reason: syntax_words(reason),
    }
}

/// Returns whether a text is JSON, or could become JSON with more text.
fn is_json_so_far(text: &[u8]) -> bool {
    match serde_json::from_slice::<IgnoredAny>(text) {
        Ok(_) => true,
        Err(error) => error.is_eof(),
    }
}

/// Rewords serde_json's syntax errors that mention its internals.
fn syntax_words(reason: &str) -> String {
    match reason {
        "expected ident" => "unknown word; JSON permits only true, false and null".to_owned(),
        "expected value" => {
            "expected a number, text in quotation marks, a list or an object".to_owned()
        }
        "invalid unicode code point" => "the text is not UTF-8".to_owned(),
        _ if reason.starts_with("control character") => {
            "text in quotation marks continues beyond the end of the line".to_owned()
        }
        _ => reason.replace('`', "\""),
    }
}

/// Translates an error in valid JSON: a missing or duplicate key, an unknown word, a wrong list
/// length, frequency band or type; any other error keeps serde's words.
fn data_fault(reason: &str, position: Position) -> ContentFault {
    let Position { line, column } = position;
    if let Some(key) = text_between(reason, "missing field `", "`") {
        return ContentFault::MissingKey { key };
    }
    if let Some(key) = text_between(reason, "duplicate field `", "`") {
        return ContentFault::DuplicateKey { key };
    }
    if let Some(rest) = reason.strip_prefix("unknown variant `")
        && let Some((found, expected)) = rest.split_once("`, expected ")
    {
        return ContentFault::Word {
            expected: expected.replace('`', "\""),
            found: found.to_owned(),
        };
    }
    if let Some(lengths) = list_lengths(reason) {
        return ContentFault::ListLength {
            expected: lengths.expected,
            found: lengths.found,
            line,
            column,
        };
    }
    if let Some(most) = text_between(reason, "expected at most ", " entries, found more")
        && let Ok(most) = most.parse()
    {
        return ContentFault::TooLong { most, line, column };
    }
    if let Some(error) = band_error(reason) {
        return ContentFault::Band(error);
    }
    if let Some((found, expected)) = mismatch(reason) {
        return ContentFault::Type {
            expected: expected_words(expected),
            found: shortened(&sanitized(&found)),
            line,
            column,
        };
    }
    ContentFault::Text {
        reason: shortened(&sanitized(reason)),
        line,
        column,
    }
}

/// Lengths of lists that must be the same.
struct ListLengths {
    expected: usize,
    found: usize,
}

/// Parses the message from `json_arrays.rs` about list lengths that differ.
fn list_lengths(reason: &str) -> Option<ListLengths> {
    let rest = reason.strip_prefix("expected ")?;
    let (expected, found) = rest.split_once(DIFFERENT_LENGTHS)?;
    Some(ListLengths {
        expected: expected.parse().ok()?,
        found: found.parse().ok()?,
    })
}

/// Parses a [`BandError`] message, which serde returns as text.
fn band_error(reason: &str) -> Option<BandError> {
    let rest = reason.strip_prefix("the frequency band must be ")?;
    let (_, ends) = rest.split_once(", found min ")?;
    let (min, max) = ends.split_once(", max ")?;
    Some(BandError {
        min: min.parse().ok()?,
        max: max.parse().ok()?,
    })
}

/// Splits a message about a wrong type, value or length: "invalid type: string "x", expected f64".
/// Returns the value found, in JSON terms, and serde's words for the expected value.
fn mismatch(reason: &str) -> Option<(String, &str)> {
    if let Some(rest) = reason.strip_prefix("invalid length ") {
        let (length, expected) = rest.rsplit_once(", expected ")?;
        return Some((format!("{length} entries"), expected));
    }
    let rest = reason
        .strip_prefix("invalid type: ")
        .or_else(|| reason.strip_prefix("invalid value: "))?;
    let (found, expected) = rest.rsplit_once(", expected ")?;
    Some((found_words(found), expected))
}

/// Returns the text between the prefix `start` and the suffix `end`; `None` if either is missing.
fn text_between(text: &str, start: &str, end: &str) -> Option<String> {
    let inner = text.strip_prefix(start)?.strip_suffix(end)?;
    Some(inner.to_owned())
}

/// Translates serde's words for the value found into JSON terms.
fn found_words(found: &str) -> String {
    let unquoted = found.replace('`', "");
    // Shorten the number: serde writes all its digits.
    if let Some(Ok(value)) = unquoted.strip_prefix("floating point ").map(str::parse) {
        return number(value);
    }
    for (start, word) in [("string ", "the text "), ("integer ", ""), ("boolean ", "")] {
        if let Some(rest) = unquoted.strip_prefix(start) {
            return format!("{word}{rest}");
        }
    }
    match unquoted.as_str() {
        "sequence" => "a list".to_owned(),
        "map" => "an object".to_owned(),
        _ => unquoted,
    }
}

/// Translates serde's words for the expected value into JSON terms.
fn expected_words(expected: &str) -> String {
    match expected {
        "f64" => "a number (without quotation marks)".to_owned(),
        "i64" => "a whole number".to_owned(),
        "u64" | "usize" => "a whole number not below 0".to_owned(),
        "a string" => "text in quotation marks".to_owned(),
        "a sequence" => "a list".to_owned(),
        "a map" => "an object".to_owned(),
        "a tuple of size 2" | "an array of length 2" => "a list of 2 entries".to_owned(),
        _ if expected.starts_with("struct ") => "an object".to_owned(),
        _ => expected.to_owned(),
    }
}

/// Returns the bare word around a position: `NaN`, `1e999`.
fn token_at(text: &[u8], position: Position) -> Option<String> {
    /// Maximum length of the returned word \[bytes\], longer than any number that a program writes.
    const LONGEST: usize = 60;
    let line = text
        .split(|byte| *byte == b'\n')
        .nth(position.line.checked_sub(1)?)?;
    let at = position.column.saturating_sub(1).min(line.len());
    let start = line[..at]
        .iter()
        .rposition(|byte| !is_word_byte(*byte))
        .map_or(0, |before| before + 1);
    let end = line[at..]
        .iter()
        .position(|byte| !is_word_byte(*byte))
        .map_or(line.len(), |after| at + after);
    let token: String = line[start..end]
        .iter()
        .take(LONGEST)
        .map(|&byte| char::from(byte))
        .collect();
    if token.is_empty() { None } else { Some(token) }
}

fn is_word_byte(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"+-.".contains(&byte)
}

/// Returns whether a word is an infinite number, or NaN, which other programs write although JSON
/// has no such numbers.
fn is_number_like(token: &str) -> bool {
    // Rust reads NaN, inf and infinity in any case and with any sign, as C and Python write them;
    // 1e999 is read as infinite.
    token.parse::<f64>().is_ok_and(|value| !value.is_finite())
}
