//! Recently opened and saved files.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use gdcm_model::whole_number::whole;

use crate::file_error::FileError;
use crate::file_reading::Source;
use crate::json_reading::Format;
use crate::json_writing::write_pretty;
use crate::output_set::{make_directory, write_whole};
use crate::reading_budget::ReadingBudget;

/// Maximum number of files in the list of recent files.
const MOST: usize = 10;
/// File name in the program's directory for user state.
const NAME: &str = "recent-files.json";
const FORMAT: Format = Format {
    name: "gdcm-recent-files",
    version: 1,
};

#[derive(Deserialize, Serialize)]
struct RecentText {
    format: String,
    #[serde(deserialize_with = "whole")]
    version: u64,
    files: Vec<String>,
}

/// Returns the recently used files listed in `directory`, newest first; empty if there is no
/// readable list.
pub fn recent_files(directory: &Path) -> Vec<PathBuf> {
    let path = directory.join(NAME);
    let budget = ReadingBudget::default();
    let Ok(source) = Source::read(&path, &budget) else {
        return Vec::new();
    };
    match FORMAT.decode::<RecentText>(source.text(), &path, &budget) {
        Ok((text, _)) => text.files.into_iter().map(PathBuf::from).collect(),
        Err(_) => Vec::new(),
    }
}

/// Puts a file at the front of the list of recent files, which is read again because another window
/// may have changed it.
///
/// # Errors
/// [`FileError`] if the list cannot be written.
pub fn add_recent_file(directory: &Path, file: &Path) -> Result<(), FileError> {
    let absolute = std::path::absolute(file).ok();
    let Some(file) = absolute.as_deref().and_then(Path::to_str) else {
        // Omit a path that is not valid Unicode, which the list cannot hold.
        return Ok(());
    };
    let mut files = vec![file.to_owned()];
    for path in recent_files(directory) {
        if let Some(other) = path.to_str()
            && other != file
            && files.len() < MOST
        {
            files.push(other.to_owned());
        }
    }
    let text = RecentText {
        format: FORMAT.name.to_owned(),
        version: FORMAT.version,
        files,
    };
    make_directory(directory)?;
    write_whole(&directory.join(NAME), |writer| write_pretty(&text, writer))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_is_first_none_is_listed_twice_and_ten_are_kept() {
        let directory = tempfile::tempdir().unwrap();
        for number in (0..12).chain([5]) {
            add_recent_file(directory.path(), Path::new(&format!("/data/{number}.json"))).unwrap();
        }
        let names: Vec<String> = recent_files(directory.path())
            .iter()
            .map(|path| path.file_stem().unwrap().to_str().unwrap().into())
            .collect();
        assert_eq!(names, ["5", "11", "10", "9", "8", "7", "6", "4", "3", "2"]);
    }

    #[test]
    fn a_damaged_list_counts_as_empty_and_is_replaced_with_the_next_file() {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join(NAME), "{\"format\": ").unwrap();
        assert!(recent_files(directory.path()).is_empty());
        add_recent_file(directory.path(), Path::new("/data/a.json")).unwrap();
        assert_eq!(recent_files(directory.path()).len(), 1);
    }
}
