//! JSON text to values, with the place of what is wrong and of what is not known.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::error::Category;
use serde_json::value::RawValue;

use super::content_fault::ContentFault;
use super::file_error::FileError;
use super::flaw::ContentError;
use super::outline::Outline;
use super::place::{Step, location_of};
use super::unknown_keys::UnknownKeys;
use gdcm_core::dataset::{BundleKind, Location};
use gdcm_core::message_text::{sanitized, shortened};
use gdcm_core::units::number;

/// A kind of file: what its "format" and "version" have to say.
#[derive(Clone, Copy, Debug)]
pub(super) struct Format {
    pub(super) name: &'static str,
    pub(super) version: u64,
}

impl Format {
    /// The value that the text holds, and a caution for each key that is not known.
    ///
    /// Another format or version is told before anything else is complained of.
    pub(super) fn decode<'t, T: Deserialize<'t>>(
        self,
        text: &'t [u8],
        path: &Path,
    ) -> Result<(T, Vec<String>), FileError> {
        check_object(text, path)?;
        let mut unknown = UnknownKeys::default();
        let mut json = serde_json::Deserializer::from_slice(text);
        let mut track = serde_path_to_error::Track::new();
        let tracked = serde_path_to_error::Deserializer::new(&mut json, &mut track);
        let value = serde_ignored::deserialize(tracked, |key| unknown.add(&key));
        let ended = value.and_then(|value| json.end().map(|()| value));
        match ended {
            Ok(value) => Ok((value, unknown.cautions(text))),
            Err(error) => {
                let steps = track.path().iter().filter_map(step_of).collect::<Vec<_>>();
                let outline = Outline::of(text);
                self.check(&outline, path)?;
                Err(json_error(text, path, location_of(&steps, &outline), &error))
            }
        }
    }

    /// Refuses a file that says it is of another format or version.
    fn check(self, outline: &Outline, path: &Path) -> Result<(), FileError> {
        let path = path.to_owned();
        match (&outline.format, &outline.version) {
            (Some(found), _) if *found != format!("\"{}\"", self.name) => {
                Err(FileError::Format { path, expected: self.name, found: found.clone() })
            }
            (Some(_), Some(found)) if *found != self.version.to_string() => {
                Err(FileError::Version { path, format: self.name, newest: self.version, found: found.clone() })
            }
            _ => Ok(()),
        }
    }

    /// Refuses a format or a version that was read, but is another.
    pub(super) fn check_read(self, format: &str, version: u64, path: &Path) -> Result<(), FileError> {
        self.check(&Outline::named(format, version), path)
    }
}

/// Refuses a list at the top, which serde would take for an object without its keys.
fn check_object(text: &[u8], path: &Path) -> Result<(), FileError> {
    if text.trim_ascii_start().first() != Some(&b'[') {
        return Ok(());
    }
    let (expected, found) = ("an object".to_owned(), "a list".to_owned());
    let fault = ContentFault::Type { expected, found, line: 1, column: 1 };
    Err(FileError::content(path, ContentError::new(Location::default(), fault)))
}

fn step_of(segment: &serde_path_to_error::Segment) -> Option<Step> {
    match segment {
        serde_path_to_error::Segment::Seq { index } => Some(Step::Entry(*index)),
        serde_path_to_error::Segment::Map { key } => Some(Step::Key(key.clone())),
        _ => None,
    }
}

/// Puts serde_json's complaint into the engineer's words.
fn json_error(text: &[u8], path: &Path, place: Location, error: &serde_json::Error) -> FileError {
    let (line, column) = (error.line(), error.column());
    let full = error.to_string();
    let reason = full.rsplit_once(" at line ").map_or(full.as_str(), |(reason, _)| reason).to_owned();
    let path_owned = path.to_owned();
    match error.classify() {
        Category::Eof => FileError::CutOff { path: path_owned, place: Box::new(place), line, column },
        Category::Data => FileError::content(path, ContentError::new(place, data_fault(reason, line, column))),
        _ if reason.starts_with("recursion limit") => {
            FileError::content(path, ContentError::new(place, ContentFault::TooDeep { line, column }))
        }
        _ => match token_at(text, line, column).filter(|token| is_number_like(token)) {
            Some(found) => {
                FileError::content(path, ContentError::new(place, ContentFault::NotFinite { found, line, column }))
            }
            // A word where the reader can tell at once that none of those it knows will stand there.
            None if serde_json::from_slice::<IgnoredAny>(text).is_ok() => {
                let (expected, found) = ("a text in quotation marks".to_owned(), "something else".to_owned());
                FileError::content(path, ContentError::new(place, ContentFault::Type { expected, found, line, column }))
            }
            None => {
                let reason = syntax_words(&reason);
                FileError::NotJson { path: path_owned, place: Box::new(place), line, column, reason }
            }
        },
    }
}

/// serde_json's words for what is wrong with a text, where they speak of its own workings.
fn syntax_words(reason: &str) -> String {
    match reason {
        "expected ident" => "a word that JSON does not know".to_owned(),
        "expected value" => "expected a number, a text, a list or an object".to_owned(),
        "invalid unicode code point" => "the text is not UTF-8".to_owned(),
        _ if reason.starts_with("control character") => {
            "a text in quotation marks goes over the end of a line".to_owned()
        }
        _ => reason.replace('`', "\""),
    }
}

fn data_fault(reason: String, line: usize, column: usize) -> ContentFault {
    let between = |start: &str| reason.strip_prefix(start)?.strip_suffix('`').map(str::to_owned);
    if let Some(key) = between("missing field `") {
        return ContentFault::MissingKey { key };
    }
    if let Some(key) = between("duplicate field `") {
        return ContentFault::DuplicateKey { key };
    }
    if let Some((found, expected)) =
        reason.strip_prefix("unknown variant `").and_then(|rest| rest.split_once("`, expected "))
    {
        return ContentFault::Word { expected: expected.replace('`', "\""), found: found.to_owned() };
    }
    let mismatch = ["invalid type: ", "invalid value: ", "invalid length "].iter().find_map(|start| {
        let (found, expected) = reason.strip_prefix(start)?.rsplit_once(", expected ")?;
        let found = found_words(found, *start == "invalid length ");
        Some((shortened(&sanitized(&found)), expected_words(expected)))
    });
    match mismatch {
        Some((found, expected)) => ContentFault::Type { expected, found, line, column },
        None => ContentFault::Text { reason: shortened(&sanitized(&reason)), line, column },
    }
}

/// serde's words for what it found, in words that JSON's own authors would use.
fn found_words(found: &str, is_length: bool) -> String {
    if is_length {
        return format!("{found} entries");
    }
    let unquoted = found.replace('`', "");
    // serde writes every digit of a number out.
    if let Some(Ok(value)) = unquoted.strip_prefix("floating point ").map(str::parse) {
        return number(value);
    }
    let renamed = [("string ", "the text "), ("integer ", ""), ("boolean ", "")]
        .iter()
        .find_map(|(start, word)| unquoted.strip_prefix(start).map(|rest| format!("{word}{rest}")));
    renamed.unwrap_or_else(|| match unquoted.as_str() {
        "sequence" => "a list".to_owned(),
        "map" => "an object".to_owned(),
        _ => unquoted,
    })
}

/// serde's words for what it expected, in words for the file's author.
fn expected_words(expected: &str) -> String {
    match expected {
        "f64" => "a number (without quotation marks)".to_owned(),
        "i64" => "a whole number".to_owned(),
        "u64" | "usize" => "a whole number not below 0".to_owned(),
        "a string" => "a text in quotation marks".to_owned(),
        "a sequence" => "a list".to_owned(),
        "a map" => "an object".to_owned(),
        "a tuple of size 2" | "an array of length 2" => "a list of 2 entries".to_owned(),
        _ if expected.starts_with("struct ") => "an object".to_owned(),
        _ => expected.to_owned(),
    }
}

/// The line at which the condition or the model of a place begins, counted from 1.
pub(super) fn line_of(text: &[u8], place: &Location) -> Option<usize> {
    let mut value = entry(serde_json::from_slice(text).ok()?, "conditions", place.condition.as_ref()?.position)?;
    if let Some(model) = &place.model {
        let key = match model.bundle {
            BundleKind::Physics => "physics_models",
            BundleKind::Identified => "identified_models",
        };
        value = entry(value, key, model.position)?;
    }
    let offset = value.get().as_ptr() as usize - text.as_ptr() as usize;
    Some(1 + text[..offset].iter().filter(|byte| **byte == b'\n').count())
}

/// An entry of a list in an object, counted from 1: the part of the text that it is, not a copy.
fn entry<'t>(object: &'t RawValue, key: &str, position: usize) -> Option<&'t RawValue> {
    let object: BTreeMap<String, &RawValue> = serde_json::from_str(object.get()).ok()?;
    let list: Vec<&RawValue> = serde_json::from_str(object.get(key)?.get()).ok()?;
    list.get(position.checked_sub(1)?).copied()
}

/// The bare word around a column (counted from 1) of a line (counted from 1): `NaN`, `1e999`.
fn token_at(text: &[u8], line: usize, column: usize) -> Option<String> {
    /// Longer than any number that a program writes.
    const LONGEST: usize = 60;
    let line = text.split(|byte| *byte == b'\n').nth(line.checked_sub(1)?)?;
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-.".contains(byte);
    let at = column.saturating_sub(1).min(line.len());
    let start = line[..at].iter().rposition(|byte| !is_word(byte)).map_or(0, |before| before + 1);
    let end = line[at..].iter().position(|byte| !is_word(byte)).map_or(line.len(), |after| at + after);
    let token: String = line[start..end].iter().take(LONGEST).map(|&byte| char::from(byte)).collect();
    (!token.is_empty()).then_some(token)
}

/// Whether a word is a number to other programs, but not to JSON or not a finite one.
fn is_number_like(token: &str) -> bool {
    // Rust reads NaN, inf and infinity in any case and with any sign, as C and Python write them; 1e999 reads as infinite.
    token.parse::<f64>().is_ok_and(|value| !value.is_finite())
}
