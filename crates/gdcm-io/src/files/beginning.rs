//! Errors near the beginning of a dataset or a study, without reading the rest.
//!
//! ```text
//! n <- 64 KiB
//! 1  text <- the first n bytes, unpacked; if that is the whole file, stop (fully read later)
//! 2  read text up to its last comma as a dataset or a study
//! 3  an error other than the end of the text: report it
//! 4  n <- 16 n, and again up to 16 MiB
//! ```
//!
//! A sixteenth of a valid file is read twice.

use std::io::Read;
use std::path::Path;

use super::dataset_file::check_dataset_text;
use super::study_file::check_study_text;
use crate::file_error::FileError;
use crate::location::Outline;
use crate::reading_budget::ReadingBudget;
use crate::source::{text_reader, without_mark};

/// Number of bytes checked first.
const FIRST: usize = 1 << 16;
/// Growth factor from one checked length to the next.
const GROWTH: usize = 16;
/// Number of bytes checked last.
const LAST: usize = 16 << 20;

/// Looks for the first structural error of a dataset or a study: text that is not JSON, another
/// format or version, values with a type other than their keys require, lists that are too long.
///
/// # Errors
/// Returns this error if it is within the first 16 MiB, and an error if the file is missing.
pub fn check_beginning(path: &Path) -> Result<(), FileError> {
    let mut reader = text_reader(path)?;
    let mut text = Vec::new();
    let mut length = FIRST;
    while length <= LAST {
        let wanted = length - text.len();
        // The full reader reports a file that cannot be read or unpacked.
        let Ok(found) = reader.by_ref().take(wanted as u64).read_to_end(&mut text) else {
            return Ok(());
        };
        if found < wanted {
            return Ok(());
        }
        check_text(&text, path)?;
        length *= GROWTH;
    }
    Ok(())
}

/// Returns the first error in an incomplete text: one that continues in the file.
fn check_text(text: &[u8], path: &Path) -> Result<(), FileError> {
    // A number or a word cut off at the end would be read with another value.
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
        // The cut-off itself is expected, since the text continues.
        Err(FileError::CutOff { .. }) => Ok(()),
        checked => checked,
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::limits::LARGEST_TEXT;

    use super::*;
    use crate::file_error::ContentFault;

    const SMALL: &str = include_str!("../../../../tests/data/small-dataset.json");

    #[test]
    fn no_beginning_of_a_sound_dataset_is_wrong() {
        let commas = SMALL.bytes().enumerate().filter(|(_, byte)| *byte == b',');
        let mut tried = 0;
        for (at, _) in commas {
            // Within the number or the word behind the comma, too.
            for end in at + 1..(at + 8).min(SMALL.len()) {
                check_text(&SMALL.as_bytes()[..end], Path::new("small.json")).unwrap();
                tried += 1;
            }
        }
        assert!(tried > 1000, "{tried}");
    }

    /// A file that begins with `begin` and exceeds every reading limit.
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
