//! The engineer's own tables that requirements are asked with, each a file of its own (M17): levels of bandwidth and phase delay.

use std::path::Path;

use serde::de::DeserializeOwned;

use gdcm_core::dataset::Location;
use gdcm_core::requirements::LevelBoundaries;

use super::file_error::FileError;
use super::json_text::json_error;
use super::source::Source;

/// The boundaries of levels in a file, `[{"name": "Level 1", "axis": "P", "points": [[rad/s, s], ...]}]` (M17.1).
///
/// # Errors
/// [`FileError`] with the line where the file cannot be read, or a boundary is none.
pub fn read_levels(path: &Path) -> Result<LevelBoundaries, FileError> {
    read(path)
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T, FileError> {
    let source = Source::read(path)?;
    let text = source.text();
    serde_json::from_slice(text).map_err(|error| json_error(text, path, Location::default(), &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_read_and_what_is_wrong_with_them_is_said_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("levels.json");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read_levels(&path).map_err(|error| error.to_string())
        };
        let levels = read(r#"[{"name": "Level 1", "axis": "P", "points": [[2, 0], [2.5, 0.2]]}]"#).unwrap();
        assert_eq!(levels.of_axis("P").next().unwrap().points, [[2.0, 0.0], [2.5, 0.2]]);
        let cases = [
            (r#"[{"name": "L", "axis": "P", "points": [[2, 0]]}]"#, "expected at least 2 points, found 1"),
            (r#"[{"name": "L", "points": [[2, 0], [1, 1]]}]"#, "axis"),
            (r#"{"levels": []}"#, "a list"),
            ("[{", "end"),
        ];
        for (text, words) in cases {
            let error = read(text).unwrap_err();
            assert!(error.contains("levels.json") && error.contains(words), "{error}");
        }
    }
}
