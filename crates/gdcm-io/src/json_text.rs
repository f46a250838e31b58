//! Conversion of JSON text to values, with the places of errors and unknown keys.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, Write};
use std::marker::PhantomData;
use std::path::Path;

use nalgebra::DMatrix;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::ser::{SerializeSeq, Serializer};
use serde::{Deserialize, Serialize};
use serde_json::error::Category;

use gdcm_model::dataset::limits::{MOST_CHANNELS, MOST_FREQUENCIES, MOST_STATES};
use gdcm_model::dataset::location::Location;
use gdcm_model::message_text::{is_unprintable, sanitized, shortened};
use gdcm_model::units::number;

use crate::file_error::{ContentError, ContentFault, FileError};
use crate::location::{Outline, Step, UnknownKeys, location_of};
use crate::reading_budget::ReadingBudget;

/// Maximum memory per byte of a file of this program \[bytes\]: a number takes at least a digit and
/// a comma, in a list that grows into twice its memory.
const TYPED: u64 = 8;

/// Writes a value as JSON with line breaks, for people to read.
pub fn write_pretty(value: &impl Serialize, file: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer_pretty(SpelledOut(&mut *file), value)?;
    file.write_all(b"\n")
}

/// Writes a value as JSON on one line.
pub(super) fn write_compact(value: &impl Serialize, file: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer(SpelledOut(&mut *file), value)?;
    file.write_all(b"\n")
}

/// Writes JSON with control and invisible characters spelled out, including those that JSON
/// permits: a file shown on a terminal cannot affect it, and no name reads as another.
struct SpelledOut<W>(W);

impl<W: Write> Write for SpelledOut<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Outside strings JSON is ASCII, and a piece of a string ends with a whole character.
        match std::str::from_utf8(bytes) {
            Ok(text) if !text.is_ascii() && text.contains(is_unprintable) => {
                let mut spelled = String::with_capacity(2 * text.len());
                for character in text.chars() {
                    if character.is_ascii() || !is_unprintable(character) {
                        spelled.push(character);
                    } else {
                        let units = character.encode_utf16(&mut [0; 2]).to_vec();
                        units
                            .iter()
                            .for_each(|unit| spelled.push_str(&format!("\\u{unit:04x}")));
                    }
                }
                self.0.write_all(spelled.as_bytes())?;
            }
            _ => self.0.write_all(bytes)?,
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// A kind of file: the expected values of its "format" and "version".
#[derive(Clone, Copy, Debug)]
pub(super) struct Format {
    pub(super) name: &'static str,
    pub(super) version: u64,
}

impl Format {
    /// Reads the value of the text, with a caution for each unknown key. Its memory is first taken
    /// from the budget.
    ///
    /// Another format or version is reported before any other error.
    pub(super) fn decode<'t, T: Deserialize<'t>>(
        self,
        text: &'t [u8],
        path: &Path,
        budget: &ReadingBudget<'_>,
    ) -> Result<(T, Vec<String>), FileError> {
        check_object(text, path)?;
        self.check(text, path, budget)?;
        budget
            .take(text.len() as u64, TYPED, "")
            .map_err(|fault| FileError::variables(path, fault))?;
        let mut unknown = UnknownKeys::default();
        let mut json = serde_json::Deserializer::from_slice(text);
        let mut track = serde_path_to_error::Track::new();
        let tracked = serde_path_to_error::Deserializer::new(&mut json, &mut track);
        let value = serde_ignored::deserialize(tracked, |key| unknown.add(&key));
        let ended = value.and_then(|value| json.end().map(|()| value));
        ended
            .map(|value| (value, unknown.cautions(text)))
            .map_err(|error| {
                let steps = track.path().iter().filter_map(step_of).collect::<Vec<_>>();
                json_error(text, path, location_of(&steps, &Outline::of(text)), &error)
            })
    }

    /// Rejects a file with another format or version.
    fn check(self, text: &[u8], path: &Path, budget: &ReadingBudget<'_>) -> Result<(), FileError> {
        let (format, version) = Outline::format_and_version(text, budget);
        let path = path.to_owned();
        match (format, version) {
            (Some(found), _) if found != format!("\"{}\"", self.name) => Err(FileError::Format {
                path,
                expected: self.name,
                found,
            }),
            (Some(_), Some(found)) if found.parse() != Ok(self.version as f64) => {
                Err(FileError::Version {
                    path,
                    format: self.name,
                    newest: self.version,
                    found,
                })
            }
            _ => Ok(()),
        }
    }
}

/// Rejects a list at the top, which serde would read as an object without its keys.
fn check_object(text: &[u8], path: &Path) -> Result<(), FileError> {
    if text.trim_ascii_start().first() != Some(&b'[') {
        return Ok(());
    }
    let expected = "an object".to_owned();
    let found = "a list".to_owned();
    let fault = ContentFault::Type {
        expected,
        found,
        line: 1,
        column: 1,
    };
    Err(FileError::content(
        path,
        ContentError::new(Location::default(), fault),
    ))
}

fn step_of(segment: &serde_path_to_error::Segment) -> Option<Step> {
    match segment {
        serde_path_to_error::Segment::Seq { index } => Some(Step::Entry(*index)),
        serde_path_to_error::Segment::Map { key } => Some(Step::Key(key.clone())),
        _ => None,
    }
}

/// Translates serde_json's errors into the engineer's words.
pub(super) fn json_error(
    text: &[u8],
    path: &Path,
    place: Location,
    error: &serde_json::Error,
) -> FileError {
    let line = error.line();
    let column = error.column();
    let full = error.to_string();
    let reason = full
        .rsplit_once(" at line ")
        .map_or(full.as_str(), |(reason, _)| reason)
        .to_owned();
    let path_owned = path.to_owned();
    match error.classify() {
        Category::Eof => FileError::CutOff {
            path: path_owned,
            place: Box::new(place),
            line,
            column,
        },
        Category::Data => FileError::content(
            path,
            ContentError::new(place, data_fault(reason, line, column)),
        ),
        _ if reason.starts_with("recursion limit") => FileError::content(
            path,
            ContentError::new(place, ContentFault::TooDeep { line, column }),
        ),
        _ => match token_at(text, line, column).filter(|token| is_number_like(token)) {
            Some(found) => FileError::content(
                path,
                ContentError::new(
                    place,
                    ContentFault::NotFinite {
                        found,
                        line,
                        column,
                    },
                ),
            ),
            // A word that the reader can reject at once, because it matches none of the known
            // words.
            None if is_json_so_far(text) => {
                let expected = "a text in quotation marks".to_owned();
                let found = "something else".to_owned();
                FileError::content(
                    path,
                    ContentError::new(
                        place,
                        ContentFault::Type {
                            expected,
                            found,
                            line,
                            column,
                        },
                    ),
                )
            }
            None => {
                let reason = syntax_words(&reason);
                FileError::NotJson {
                    path: path_owned,
                    place: Box::new(place),
                    line,
                    column,
                    reason,
                }
            }
        },
    }
}

/// Returns whether a text is JSON, or the beginning of JSON.
fn is_json_so_far(text: &[u8]) -> bool {
    match serde_json::from_slice::<IgnoredAny>(text) {
        Ok(_) => true,
        Err(error) => error.is_eof(),
    }
}

/// Translates serde_json's syntax errors that mention its internals.
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
    let between = |start: &str| {
        reason
            .strip_prefix(start)?
            .strip_suffix('`')
            .map(str::to_owned)
    };
    if let Some(key) = between("missing field `") {
        return ContentFault::MissingKey { key };
    }
    if let Some(key) = between("duplicate field `") {
        return ContentFault::DuplicateKey { key };
    }
    if let Some((found, expected)) = reason
        .strip_prefix("unknown variant `")
        .and_then(|rest| rest.split_once("`, expected "))
    {
        return ContentFault::Word {
            expected: expected.replace('`', "\""),
            found: found.to_owned(),
        };
    }
    let mismatch = ["invalid type: ", "invalid value: ", "invalid length "]
        .iter()
        .find_map(|start| {
            let (found, expected) = reason.strip_prefix(start)?.rsplit_once(", expected ")?;
            let found = found_words(found, *start == "invalid length ");
            Some((shortened(&sanitized(&found)), expected_words(expected)))
        });
    match mismatch {
        Some((found, expected)) => ContentFault::Type {
            expected,
            found,
            line,
            column,
        },
        None => ContentFault::Text {
            reason: shortened(&sanitized(&reason)),
            line,
            column,
        },
    }
}

/// Translates serde's words for the value found into those of JSON authors.
fn found_words(found: &str, is_length: bool) -> String {
    if is_length {
        return format!("{found} entries");
    }
    let unquoted = found.replace('`', "");
    // serde writes all digits of a number.
    if let Some(Ok(value)) = unquoted.strip_prefix("floating point ").map(str::parse) {
        return number(value);
    }
    let renamed = [("string ", "the text "), ("integer ", ""), ("boolean ", "")]
        .iter()
        .find_map(|(start, word)| {
            unquoted
                .strip_prefix(start)
                .map(|rest| format!("{word}{rest}"))
        });
    renamed.unwrap_or_else(|| match unquoted.as_str() {
        "sequence" => "a list".to_owned(),
        "map" => "an object".to_owned(),
        _ => unquoted,
    })
}

/// Translates serde's words for the expected value into those of the file's author.
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

/// Returns the bare word around a column (counted from 1) of a line (counted from 1): `NaN`,
/// `1e999`.
fn token_at(text: &[u8], line: usize, column: usize) -> Option<String> {
    /// Longer than any number that a program writes.
    const LONGEST: usize = 60;
    let line = text
        .split(|byte| *byte == b'\n')
        .nth(line.checked_sub(1)?)?;
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-.".contains(byte);
    let at = column.saturating_sub(1).min(line.len());
    let start = line[..at]
        .iter()
        .rposition(|byte| !is_word(byte))
        .map_or(0, |before| before + 1);
    let end = line[at..]
        .iter()
        .position(|byte| !is_word(byte))
        .map_or(line.len(), |after| at + after);
    let token: String = line[start..end]
        .iter()
        .take(LONGEST)
        .map(|&byte| char::from(byte))
        .collect();
    (!token.is_empty()).then_some(token)
}

/// Returns whether a word is a number in other programs, but not in JSON, or not a finite one.
fn is_number_like(token: &str) -> bool {
    // Rust reads NaN, inf and infinity in any case and with any sign, as C and Python write them;
    // 1e999 is read as infinite.
    token.parse::<f64>().is_ok_and(|value| !value.is_finite())
}

// Numbers in nested lists, as JSON writes matrices and tables.

/// A rectangular array of `DEPTH` dimensions, the last one running fastest: `[[1, 2], [3, 4]]` has
/// the shape 2 x 2.
///
/// Read flat, so that a file of empty lists cannot take more memory than its own length; a matrix
/// is limited by the number of states of a model, a table of responses by the numbers of channels
/// and frequencies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Nested<const DEPTH: usize> {
    /// Entries along each dimension; 0 if a previous dimension is empty.
    pub(super) shape: [usize; DEPTH],
    pub(super) values: Vec<f64>,
}

impl<const DEPTH: usize> Nested<DEPTH> {
    /// Returns the maximum number of entries of a list at a depth, 0 being the outermost.
    const fn most(depth: usize) -> usize {
        match (DEPTH, depth) {
            (2, _) => MOST_STATES,
            (_, 0 | 1) => MOST_CHANNELS,
            _ => MOST_FREQUENCIES,
        }
    }
}

impl Nested<2> {
    /// Creates a matrix, row by row.
    pub(super) fn of_matrix(matrix: &DMatrix<f64>) -> Self {
        // nalgebra stores columns, a file has rows.
        Self {
            shape: [matrix.nrows(), matrix.ncols()],
            values: matrix.transpose().as_slice().to_vec(),
        }
    }
}

impl<'de, const DEPTH: usize> Deserialize<'de> for Nested<DEPTH> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut filling = Filling {
            lengths: [None; DEPTH],
            values: Vec::new(),
        };
        List {
            filling: &mut filling,
            depth: 0,
        }
        .deserialize(deserializer)?;
        Ok(Self {
            shape: filling.lengths.map(Option::unwrap_or_default),
            values: filling.values,
        })
    }
}

/// An array being read.
struct Filling<const DEPTH: usize> {
    /// Length of the lists at each depth, known once the first of them has ended.
    lengths: [Option<usize>; DEPTH],
    values: Vec<f64>,
}

/// A list at a depth, 0 being the outermost.
struct List<'f, const DEPTH: usize> {
    filling: &'f mut Filling<DEPTH>,
    depth: usize,
}

impl<'de, const DEPTH: usize> DeserializeSeed<'de> for List<'_, DEPTH> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de, const DEPTH: usize> Visitor<'de> for List<'_, DEPTH> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(if self.depth + 1 == DEPTH {
            "a list of numbers"
        } else {
            "a list of lists of numbers"
        })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        let mut length = 0;
        let depth = self.depth + 1;
        loop {
            if depth == DEPTH {
                let Some(value) = entries.next_element::<f64>()? else {
                    break;
                };
                self.filling.values.push(value);
            } else if entries
                .next_element_seed(List {
                    filling: &mut *self.filling,
                    depth,
                })?
                .is_none()
            {
                break;
            }
            length += 1;
            if length > Nested::<DEPTH>::most(self.depth) {
                return Err(too_long(length - 1));
            }
        }
        match *self.filling.lengths[self.depth].get_or_insert(length) {
            expected if expected == length => Ok(()),
            expected => Err(A::Error::custom(format!(
                "expected {expected} entries, as in the first of these lists, found {length}"
            ))),
        }
    }
}

impl<const DEPTH: usize> Serialize for Nested<DEPTH> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Part {
            shape: &self.shape,
            values: &self.values,
        }
        .serialize(serializer)
    }
}

/// A list of an array being written.
struct Part<'v> {
    shape: &'v [usize],
    values: &'v [f64],
}

impl Serialize for Part<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.shape {
            [] | [_] => self.values.serialize(serializer),
            [length, shape @ ..] => {
                let size: usize = shape.iter().product();
                let mut list = serializer.serialize_seq(Some(*length))?;
                for part in 0..*length {
                    list.serialize_element(&Part {
                        shape,
                        values: &self.values[part * size..(part + 1) * size],
                    })?;
                }
                list.end()
            }
        }
    }
}

// Lists and objects with a limit on their length, so that those rejected for it never occupy
// memory.

/// Reads a list of at most `MOST` entries.
pub(super) fn list<'de, const MOST: usize, T, D>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    list_while(deserializer, MOST, |_| Ok(()))
}

/// A list of at most `MOST` entries.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(transparent)]
pub(super) struct Limited<T, const MOST: usize>(pub(super) Vec<T>);

impl<'de, T: Deserialize<'de>, const MOST: usize> Deserialize<'de> for Limited<T, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        list::<MOST, T, D>(deserializer).map(Self)
    }
}

impl<T, const MOST: usize> Limited<T, MOST> {
    /// Wraps a list; `None` if it is empty.
    pub(super) fn some(list: Vec<T>) -> Option<Self> {
        (!list.is_empty()).then_some(Self(list))
    }

    /// Returns the entries of an optional list.
    pub(super) fn entries(list: Option<Self>) -> Vec<T> {
        list.map(|list| list.0).unwrap_or_default()
    }
}

/// Reads a list of at most `most` entries, as long as `check` accepts the next.
pub(super) fn list_while<'de, T, D>(
    deserializer: D,
    most: usize,
    check: impl FnMut(&T) -> Result<(), String>,
) -> Result<Vec<T>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    deserializer.deserialize_seq(LimitedList {
        most,
        check,
        entry: PhantomData,
    })
}

/// Creates the error that a list or an object exceeds its limit.
pub(super) fn too_long<E: Error>(most: usize) -> E {
    E::custom(format_args!("expected at most {most} entries, found more"))
}

struct LimitedList<T, C> {
    most: usize,
    check: C,
    entry: PhantomData<T>,
}

impl<'de, T, C> Visitor<'de> for LimitedList<T, C>
where
    T: Deserialize<'de>,
    C: FnMut(&T) -> Result<(), String>,
{
    type Value = Vec<T>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut entries: A) -> Result<Vec<T>, A::Error> {
        let mut list = Vec::new();
        while list.len() < self.most {
            let Some(entry) = entries.next_element()? else {
                return Ok(list);
            };
            (self.check)(&entry).map_err(A::Error::custom)?;
            list.push(entry);
        }
        match entries.next_element::<IgnoredAny>()? {
            None => Ok(list),
            Some(_) => Err(too_long(self.most)),
        }
    }
}

/// Numbers by name, at most `MOST`, each name once.
pub(super) struct Numbers<const MOST: usize>(pub(super) BTreeMap<String, f64>);

impl<'de, const MOST: usize> Deserialize<'de> for Numbers<MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Object::<MOST>)
    }
}

struct Object<const MOST: usize>;

impl<'de, const MOST: usize> Visitor<'de> for Object<MOST> {
    type Value = Numbers<MOST>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Numbers<MOST>, A::Error> {
        let mut numbers = BTreeMap::new();
        while let Some((name, number)) = entries.next_entry()? {
            if numbers.len() == MOST {
                return Err(too_long(MOST));
            }
            numbers.insert(name, number);
        }
        Ok(Numbers(numbers))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<const DEPTH: usize>(text: &str) -> Result<Nested<DEPTH>, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn what_would_act_on_a_terminal_is_spelt_out_and_read_back() {
        let name = "a\u{9b}31m b\u{202e}c \u{e0041} \u{7f} \u{e9}\u{3b1}\u{1f600}\n";
        let mut file = Vec::new();
        write_pretty(&[name], &mut file).unwrap();
        let text = String::from_utf8(file).unwrap();
        let left: Vec<char> = text
            .trim_end()
            .chars()
            .filter(|letter| is_unprintable(*letter))
            .collect();
        // Line ends of its own, and a code without effect on a terminal.
        assert_eq!(left, ['\n', '\u{7f}', '\n'], "{text:?}");
        assert!(
            text.contains("\\u009b31m")
                && text.contains("\\udb40\\udc41")
                && text.contains("\u{e9}\u{3b1}\u{1f600}")
        );
        assert_eq!(serde_json::from_str::<Vec<String>>(&text).unwrap(), [name]);
    }

    #[test]
    fn what_is_written_is_what_was_read() {
        for text in ["[[1.0,2.0,3.0],[4.0,5.0,6.0]]", "[]", "[[],[]]"] {
            assert_eq!(
                serde_json::to_string(&read::<2>(text).unwrap()).unwrap(),
                text
            );
        }
        let text = "[[[1.0],[2.0]],[[3.0],[4.0]]]";
        let table = read::<3>(text).unwrap();
        assert_eq!(
            (table.shape, table.values.as_slice()),
            ([2, 2, 1], [1.0, 2.0, 3.0, 4.0].as_slice())
        );
        assert_eq!(serde_json::to_string(&table).unwrap(), text);
    }

    #[test]
    fn a_ragged_list_is_refused_at_any_depth() {
        for text in ["[[1, 2], [3]]", "[[], [3]]", "[[1], []]"] {
            assert!(
                read::<2>(text).unwrap_err().contains("as in the first"),
                "{text}"
            );
        }
        assert!(
            read::<3>("[[[1], [2]], [[3]]]")
                .unwrap_err()
                .contains("expected 2 entries")
        );
    }
}
