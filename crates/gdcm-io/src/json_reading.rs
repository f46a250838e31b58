//! Reads this program's JSON files and locates errors and unknown keys in them.

use std::path::Path;

use serde::Deserialize;

use gdcm_model::dataset::location::Location;

use crate::content_fault::{ContentError, ContentFault};
use crate::file_caution::FileCaution;
use crate::file_error::FileError;
use crate::json_location::location_of;
use crate::json_outline::Outline;
use crate::json_path::Step;
use crate::reading_budget::{NO_VARIABLE, ReadingBudget};
use crate::unknown_keys::UnknownKeys;

pub(super) use crate::json_arrays::Nested;
pub(super) use crate::json_errors::json_error;
pub(super) use crate::json_lists::{Limited, Numbers, list, list_while};

/// Maximum memory per byte in a JSON file \[bytes\]: a number takes at least two bytes in the file
/// (a digit and a comma) and eight in memory, in a list with up to twice the necessary capacity.
const MEMORY_PER_BYTE: u64 = 8;

/// A file format: the expected values for "format" and "version".
#[derive(Clone, Copy, Debug)]
pub(super) struct Format {
    pub(super) name: &'static str,
    pub(super) version: u64,
}

impl Format {
    /// Reads the value in a text; returns a caution for each unknown key.
    ///
    /// 1. A list at the top level, another format or another version: error. A file without
    ///    "format" fails in step 3, with its missing key.
    /// 2. Take the memory for the value from the budget.
    /// 3. Deserialize, while the path of keys and indices is tracked and unknown keys are
    ///    collected.
    /// 4. An error is located by that path, in terms of conditions and models (`json_location.rs`).
    ///
    /// # Errors
    /// Another format or version, which is reported before any other error except a list at the top
    /// level; text that is not JSON; values with other types; an exceeded budget.
    pub(super) fn decode<'t, T: Deserialize<'t>>(
        self,
        text: &'t [u8],
        path: &Path,
        budget: &ReadingBudget<'_>,
    ) -> Result<(T, Vec<FileCaution>), FileError> {
        // Step 1.
        check_object(text, path)?;
        self.check(text, path, budget)?;
        // Step 2.
        budget
            .take(text.len() as u64, MEMORY_PER_BYTE, NO_VARIABLE)
            .map_err(|fault| FileError::variables(path, fault))?;
        // Step 3.
        let mut unknown = UnknownKeys::default();
        let mut json = serde_json::Deserializer::from_slice(text);
        let mut track = serde_path_to_error::Track::new();
        let tracked = serde_path_to_error::Deserializer::new(&mut json, &mut track);
        let value = serde_ignored::deserialize(tracked, |key| unknown.add(&key));
        match value.and_then(|value| json.end().map(|()| value)) {
            Ok(value) => Ok((value, unknown.cautions(text))),
            Err(error) => {
                // Step 4.
                let steps: Vec<Step> = track.path().iter().filter_map(step_from).collect();
                let place = location_of(&steps, &Outline::read(text));
                Err(json_error(text, path, place, &error))
            }
        }
    }

    /// Rejects a file with another "format" or "version"; accepts one without "format".
    fn check(self, text: &[u8], path: &Path, budget: &ReadingBudget<'_>) -> Result<(), FileError> {
        let (format, version) = Outline::format_and_version(text, budget);
        let Some(format) = format else {
            return Ok(());
        };
        if format != format!("\"{}\"", self.name) {
            return Err(FileError::Format {
                path: path.to_owned(),
                expected: self.name,
                found: format,
            });
        }
        match version {
            Some(found) if found.parse() != Ok(self.version as f64) => Err(FileError::Version {
                path: path.to_owned(),
                format: self.name,
                newest: self.version,
                found,
            }),
            _ => Ok(()),
        }
    }
}

/// Rejects a list at the top level, which serde would read as an object without its keys.
fn check_object(text: &[u8], path: &Path) -> Result<(), FileError> {
    if text.trim_ascii_start().first() != Some(&b'[') {
        return Ok(());
    }
    let fault = ContentFault::Type {
        expected: "an object".to_owned(),
        found: "a list".to_owned(),
        line: 1,
        column: 1,
    };
    let error = ContentError::new(Location::default(), fault);
    Err(FileError::content(path, error))
}

fn step_from(segment: &serde_path_to_error::Segment) -> Option<Step> {
    match segment {
        serde_path_to_error::Segment::Seq { index } => Some(Step::Entry(*index)),
        serde_path_to_error::Segment::Map { key } => Some(Step::Key(key.clone())),
        _ => None,
    }
}
