//! Tables that the engineer supplies as separate files, for use in any study (M17): level
//! boundaries for bandwidth and phase delay, and tolerances for time histories.
//!
//! A level boundary is a polyline over bandwidth and phase delay, with the level of handling
//! qualities that is met on it and to its right. A tolerance is the permitted difference between
//! simulated and flown output.

use std::path::Path;

use serde::{Deserialize, Serialize};

use gdcm_method::requirements::{LevelBoundaries, Tolerance, ToleranceTable};
use gdcm_model::dataset::location::Location;

use crate::content_fault::{ContentError, ContentFault};
use crate::file_caution::FileCaution;
use crate::file_error::FileError;
use crate::file_reading::Source;
use crate::json_reading::{Format, json_error};
use crate::json_writing::write_pretty;
use crate::output_set::OutputSet;
use crate::reading_budget::ReadingBudget;

const TOLERANCES: Format = Format {
    name: "gdcm-tolerances",
    version: 1,
};

#[derive(Serialize, Deserialize)]
struct TolerancesText {
    format: String,
    version: u64,
    #[serde(default)]
    source: String,
    tolerances: Vec<Tolerance>,
}

/// Reads level boundaries from a file, `[{"name": "Level 1", "level": 1, "axis": "P", "points":
/// [[rad/s, s], ...], "source": "..."}]` (M17.1); level and source are optional.
///
/// # Errors
/// [`FileError`] if the file cannot be read, or if a boundary is invalid, with its line.
pub fn read_levels(path: &Path) -> Result<LevelBoundaries, FileError> {
    let source = Source::read(path, &ReadingBudget::default())?;
    levels_from_text(source.text(), path)
}

/// Reads level boundaries from file content; errors name `path`.
pub(super) fn levels_from_text(text: &[u8], path: &Path) -> Result<LevelBoundaries, FileError> {
    serde_json::from_slice(text)
        .map_err(|error| json_error(text, path, Location::default(), &error))
}

/// Adds a file with level boundaries to `outputs`.
pub fn add_levels(
    levels: &LevelBoundaries,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    outputs.add(path, |file| write_pretty(levels, file))
}

/// Reads a tolerance table, with cautions about unknown keys.
///
/// # Errors
/// [`FileError`] if the file cannot be read, or anything in it is invalid.
pub fn load_tolerances(path: &Path) -> Result<(ToleranceTable, Vec<FileCaution>), FileError> {
    let budget = ReadingBudget::default();
    let source = Source::read(path, &budget)?;
    let (text, cautions) = TOLERANCES.decode::<TolerancesText>(source.text(), path, &budget)?;
    match ToleranceTable::new(text.source, text.tolerances) {
        Ok(table) => Ok((table, cautions)),
        Err(error) => {
            let error = ContentError::new(Location::default(), ContentFault::from(error));
            Err(FileError::content(path, error))
        }
    }
}

/// Adds a file with a tolerance table to `outputs`.
pub fn add_tolerances(
    table: &ToleranceTable,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    let text = TolerancesText {
        format: TOLERANCES.name.to_owned(),
        version: TOLERANCES.version,
        source: table.source().to_owned(),
        tolerances: table.rows().to_vec(),
    };
    outputs.add(path, |file| write_pretty(&text, file))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::standard_levels::STANDARD_LEVELS;
    use crate::output_set::Existing;

    #[test]
    fn levels_are_read_and_faults_in_them_reported_with_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("levels.json");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read_levels(&path)
        };
        let levels =
            read(r#"[{"name": "Level 1", "axis": "P", "points": [[2, 0], [2.5, 0.2]]}]"#).unwrap();
        assert_eq!(
            levels.for_output("P").next().unwrap().points,
            [[2.0, 0.0], [2.5, 0.2]]
        );
        let cases = [
            (
                r#"[{"name": "L", "axis": "P", "points": [[2, 0]]}]"#,
                "invalid-entry",
                "found 1",
            ),
            (
                r#"[{"name": "L", "points": [[2, 0], [1, 1]]}]"#,
                "missing-key",
                "\"axis\"",
            ),
            (r#"{"levels": []}"#, "wrong-type", ""),
            ("[{", "json-cut-off", ""),
        ];
        for (text, code, value) in cases {
            let error = read(text).unwrap_err();
            assert_eq!(error.code(), code, "{error}");
            let message = error.to_string();
            assert!(message.contains("levels.json"), "{message}");
            assert!(message.contains(value), "{message}");
        }
    }

    #[test]
    fn levels_are_read_as_they_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("levels.json");
        let levels = STANDARD_LEVELS[0].boundaries(&[]).unwrap();
        let mut outputs = OutputSet::new(Existing::Keep, Vec::new());
        add_levels(&levels, &path, &mut outputs).unwrap();
        outputs.persist().unwrap();
        assert_eq!(read_levels(&path).unwrap(), levels);
    }

    fn written(table: &ToleranceTable) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tolerances.json");
        let mut outputs = OutputSet::new(Existing::Keep, Vec::new());
        add_tolerances(table, &path, &mut outputs).unwrap();
        outputs.persist().unwrap();
        (folder, path)
    }

    #[test]
    fn a_table_is_read_as_it_is_written() {
        let table = ToleranceTable::default();
        let (_folder, path) = written(&table);
        assert_eq!(load_tolerances(&path).unwrap(), (table, Vec::new()));
    }

    #[test]
    fn faults_in_a_table_are_reported_with_their_row() {
        let (_folder, path) = written(&ToleranceTable::default());
        let right = std::fs::read_to_string(&path).unwrap();
        for (from, to, code, value) in [
            (
                "\"absolute\": 3.0",
                "\"absolute\": 0.0",
                "tolerance-not-positive",
                "tolerance 1, \"roll rate\"",
            ),
            (
                "\"channel\": \"P\"",
                "\"channel\": \"\"",
                "tolerance-without-channel",
                "tolerance 1, \"roll rate\"",
            ),
            ("\"absolute\": 3.0,", "", "missing-key", "\"absolute\""),
            (
                "gdcm-tolerances",
                "gdcm-rules",
                "other-format",
                "gdcm-tolerances",
            ),
        ] {
            std::fs::write(&path, right.replacen(from, to, 1)).unwrap();
            let error = load_tolerances(&path).unwrap_err();
            assert_eq!(error.code(), code, "{error}");
            assert!(error.to_string().contains(value), "{error}");
        }
        std::fs::write(&path, right.replacen("\"source\"", "\"sauce\"", 1)).unwrap();
        let (table, cautions) = load_tolerances(&path).unwrap();
        assert!(
            table.source().is_empty()
                && matches!(&cautions[..], [FileCaution::UnknownKey { key, .. }] if key == "sauce"),
            "{cautions:?}"
        );
    }
}
