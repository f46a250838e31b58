//! Entries of a dataset file that refer to flight records.

use std::path::{Path, PathBuf};

use gdcm_model::dataset::condition::ConditionRecord;

use crate::relative_folder::relative_folder;

/// Returns the entry for a record in a dataset file: makes the record file's path relative to the
/// path `dataset`, or leaves it unchanged if the file is not found. `requested` lists the files and
/// folders from which records were read.
pub fn relative_entry(
    mut entry: ConditionRecord,
    requested: &[PathBuf],
    dataset: &Path,
) -> ConditionRecord {
    if let Some(path) = path_of_record(&entry.file, requested) {
        let folder = relative_folder(path.parent().unwrap_or(Path::new(".")), dataset);
        let name = match path.file_name() {
            Some(name) => name.to_string_lossy().into_owned(),
            None => String::new(),
        };
        entry.file = if folder.is_empty() || folder == "." {
            name
        } else {
            format!("{folder}/{name}")
        };
    }
    entry
}

/// Finds the path of a record's file: the first of `requested` that has this file name, or that is
/// a folder with this file. A record joined from topics in several files has an empty file name;
/// its path is the first requested folder or, if only files are requested, the first file's folder.
fn path_of_record(file: &str, requested: &[PathBuf]) -> Option<PathBuf> {
    for path in requested {
        let is_file = path
            .file_name()
            .is_some_and(|name| name.to_string_lossy() == file);
        if is_file {
            return Some(path.clone());
        }
        // With an empty file name, this is the folder itself.
        let in_folder = path.join(file);
        if path.is_dir() && in_folder.exists() {
            return Some(in_folder);
        }
    }
    if file.is_empty() {
        return requested.first()?.parent().map(Path::to_owned);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_found_in_the_requested_folder_that_has_its_file() {
        let place = tempfile::tempdir().unwrap();
        let [empty, other] = ["empty", "other"].map(|name| place.path().join(name));
        std::fs::create_dir(&empty).unwrap();
        std::fs::create_dir(&other).unwrap();
        let file = other.join("sweep.csv");
        std::fs::write(&file, "").unwrap();
        let requested = [empty.clone(), file.clone()];
        assert_eq!(path_of_record("sweep.csv", &requested), Some(file.clone()));
        let requested = [empty.clone(), other];
        assert_eq!(path_of_record("sweep.csv", &requested), Some(file));
        assert_eq!(path_of_record("missing.csv", &requested), None);
        // A record joined from several files belongs to a folder.
        assert_eq!(path_of_record("", &requested), Some(empty.join("")));
    }
}
