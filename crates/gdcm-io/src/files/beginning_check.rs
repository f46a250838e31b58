//! Finds errors near the beginning of a dataset or a study without reading the rest.
//!
//! ```text
//! n <- 64 KiB
//! 1  text <- the first n bytes, uncompressed; stop if the file is shorter (quick to read)
//! 2  read text up to its last comma as a dataset or a study
//! 3  if there is an error other than the end of the text, return it
//! 4  n <- 16 n; repeat up to 16 MiB
//! ```
//!
//! The checked beginning of a valid file is read again by the full reader. The limit is a
//! compromise: a longer beginning would show more errors early, but more would be read twice.

use std::io::Read;
use std::path::Path;

use super::dataset_file::check_dataset_text;
use super::study_file::check_study_text;
use crate::file_error::FileError;
use crate::file_reading::{text_reader, without_mark};
use crate::json_outline::Outline;
use crate::reading_budget::ReadingBudget;

/// Length of the first check \[bytes\].
const FIRST: usize = 1 << 16;
/// Ratio of the length of a check to the length of the previous check.
const GROWTH: usize = 16;
/// Length of the last check \[bytes\].
const LAST: usize = 16 << 20;

/// Checks the beginning of a dataset or a study for structural errors: text that is not JSON,
/// another format or version, values whose type their keys do not permit, lists that are too long.
///
/// # Errors
/// Returns the first such error in the longest beginning (64 KiB, 1 MiB or 16 MiB) that the file
/// fills, or an error if the file cannot be opened.
pub fn check_beginning(path: &Path) -> Result<(), FileError> {
    let mut reader = text_reader(path)?;
    let mut text = Vec::new();
    let mut length = FIRST;
    while length <= LAST {
        // Step 1.
        let wanted = length - text.len();
        // A file that cannot be read or uncompressed is left to the full reader, which reports the
        // error.
        let Ok(found) = reader.by_ref().take(wanted as u64).read_to_end(&mut text) else {
            return Ok(());
        };
        if found < wanted {
            return Ok(());
        }
        check_text(&text, path)?;
        // Step 4.
        length *= GROWTH;
    }
    Ok(())
}

/// Returns the first error in the beginning of a file; the end of the text is no error.
fn check_text(text: &[u8], path: &Path) -> Result<(), FileError> {
    // Step 2. Stop at the last comma: a number or a word that is cut off would be read with another
    // value.
    let Some(comma) = text.iter().rposition(|&byte| byte == b',') else {
        return Ok(());
    };
    let text = without_mark(&text[..=comma]);
    let budget = ReadingBudget::default();
    let is_study = Outline::format_of(text, &budget).as_deref() == Some("\"gdcm-study\"");
    let checked = if is_study {
        check_study_text(text, path, &budget)
    } else {
        check_dataset_text(text, path, &budget)
    };
    match checked {
        // Step 3. The end of the text is expected: the text is only the beginning of the file.
        Err(FileError::CutOff { .. }) => Ok(()),
        checked => checked,
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::limits::LARGEST_TEXT;

    use super::*;
    use crate::content_fault::ContentFault;

    const SMALL: &str = include_str!("../../../../tests/data/small-dataset.json");

    #[test]
    fn no_beginning_of_a_sound_dataset_is_wrong() {
        let commas = SMALL.bytes().enumerate().filter(|(_, byte)| *byte == b',');
        let mut tried = 0;
        for (at, _) in commas {
            // Also cuts the text within the number or the word after the comma.
            for end in at + 1..(at + 8).min(SMALL.len()) {
                check_text(&SMALL.as_bytes()[..end], Path::new("small.json")).unwrap();
                tried += 1;
            }
        }
        assert!(tried > 1000, "{tried}");
    }

    /// Creates a file that begins with `begin` and exceeds every size limit for reading.
    fn endless(begin: &str) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(&file, begin).unwrap();
        std::fs::File::options()
            .write(true)
            .open(&file)
            .unwrap()
            .set_len(LARGEST_TEXT + 1)
            .unwrap();
        file
    }

    #[test]
    fn an_error_in_the_beginning_is_found_without_the_rest() {
        let wrong = SMALL.replacen(
            "\"frequency_band\": {",
            "\"frequency_band\": 5, \"more\": {",
            1,
        );
        let found = check_beginning(endless(&wrong).path()).unwrap_err();
        let FileError::Content { fault, place, .. } = &found else {
            panic!("{found}")
        };
        assert!(
            matches!(**fault, ContentFault::Type { .. }) && place.to_string() == "frequency_band",
            "{found}"
        );
        for (text, is_expected) in [
            (
                "{\"format\": \"gdcm-else\", \"a\": 1,",
                (|of| matches!(of, FileError::Format { .. })) as fn(&FileError) -> bool,
            ),
            (
                "{\"format\": \"gdcm-dataset\", \"version\": 99, \"a\": 1,",
                |of| matches!(of, FileError::Version { .. }),
            ),
            (
                "{\"format\": \"gdcm-study\", \"version\": 1, \"settings\": 3, \"a\": 1,",
                |of| matches!(of, FileError::Content { .. }),
            ),
            ("{\"format\" 1,", |of| {
                matches!(of, FileError::NotJson { .. })
            }),
        ] {
            let found = check_beginning(endless(text).path()).unwrap_err();
            assert!(is_expected(&found), "{text}: {found}");
        }
    }
}
