//! What the program remembers of its user between two starts: the files opened and saved of late, and that it was started before.

use std::fs::{OpenOptions, create_dir_all};
use std::path::{Path, PathBuf};

use gdcm_core::whole_number::whole;
use serde::{Deserialize, Serialize};

use super::file_error::FileError;
use super::json_text::{Format, write_pretty};
use super::output_set::{make_directory, write_whole};
use super::source::Source;
use super::variables::ReadingBudget;

/// Most files that are listed.
const MOST: usize = 10;
/// Name of the list in the program's directory.
const NAME: &str = "recent-files.json";
/// What the list calls itself.
const FORMAT: Format = Format { name: "gdcm-recent-files", version: 1 };

#[derive(Deserialize, Serialize)]
struct RecentText {
    format: String,
    #[serde(deserialize_with = "whole")]
    version: u64,
    files: Vec<String>,
}

/// The files listed in `directory`, the newest first; none where there is no list, or none that can be read.
pub fn recent_files(directory: &Path) -> Vec<PathBuf> {
    let path = directory.join(NAME);
    let budget = ReadingBudget::default();
    let Ok(source) = Source::read(&path, &budget) else { return Vec::new() };
    let decoded = FORMAT.decode::<RecentText>(source.text(), &path, &budget);
    decoded.map_or_else(|_| Vec::new(), |(text, _)| text.files.into_iter().map(PathBuf::from).collect())
}

/// Puts a file in front of the list, of which another window may have written in between.
///
/// # Errors
/// Where the list cannot be written.
pub fn add_recent_file(directory: &Path, file: &Path) -> Result<(), FileError> {
    let Some(file) = std::path::absolute(file).ok().and_then(|path| path.to_str().map(str::to_owned)) else {
        // A name that is not valid Unicode cannot be listed.
        return Ok(());
    };
    let others = recent_files(directory).into_iter().filter_map(|path| path.to_str().map(str::to_owned));
    let others = others.filter(|other| *other != file);
    let files = std::iter::once(file.clone()).chain(others).take(MOST).collect();
    let text = RecentText { format: FORMAT.name.to_owned(), version: FORMAT.version, files };
    make_directory(directory)?;
    write_whole(&directory.join(NAME), |writer| write_pretty(&text, writer))
}

/// The file that says so.
const STARTED: &str = "started";

/// Whether nothing in the program's directory says that it was started before; from now on something does. Where that cannot be
/// kept, it is taken as started before: what the first start shows would come at every one.
pub fn is_first_start(directory: &Path) -> bool {
    let kept = create_dir_all(directory)
        .and_then(|()| OpenOptions::new().write(true).create_new(true).open(directory.join(STARTED)));
    kept.is_ok()
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
    fn a_damaged_list_is_an_empty_one_and_is_mended_by_the_next_file() {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join(NAME), "{\"format\": ").unwrap();
        assert!(recent_files(directory.path()).is_empty());
        add_recent_file(directory.path(), Path::new("/data/a.json")).unwrap();
        assert_eq!(recent_files(directory.path()).len(), 1);
    }

    #[test]
    fn only_one_start_is_the_first_and_none_where_nothing_can_be_kept() {
        let folder = tempfile::tempdir().unwrap();
        let directory = folder.path().join("gdcm");
        assert!(is_first_start(&directory));
        assert!(!is_first_start(&directory));
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        assert!(!is_first_start(&file.join("gdcm")));
    }
}
