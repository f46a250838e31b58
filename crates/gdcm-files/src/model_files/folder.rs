//! The files of a folder that may hold models.

use std::fs;
use std::path::{Path, PathBuf};

use crate::file_error::FileError;
use gdcm_core::assembly::Headings;
use gdcm_core::message_text::sanitized_path;

use super::{FoundModels, read_file};
use crate::model_files::found::{LooseMatrix, models_of_matrices};

/// Most files that are looked at, and deepest folders inside one another.
const MOST_FILES: usize = 20_000;
const DEEPEST: usize = 16;
/// Endings of files that may hold models.
const ENDINGS: [&str; 11] = ["mat", "npz", "npy", "json", "gz", "csv", "txt", "dat", "m", "h5", "hdf5"];

/// What is told while files are read, and whether to go on.
pub trait FolderProgress {
    /// A file is about to be read: its number from 1, how many there are, its name.
    fn reading(&self, number: usize, of: usize, name: &str);
    /// Whether the engineer wants no more, now that this many bytes of the file's values are read.
    fn stopped(&self, taken: u64) -> bool;
}

/// The folder from which the models of these files and folders name their files: that which was given first; a file alone lies in its
/// folder.
pub fn sources_folder(sources: &[PathBuf]) -> &Path {
    let here = Path::new(".");
    let first = sources.first().map_or(here, PathBuf::as_path);
    let folder = if first.is_dir() { first } else { first.parent().unwrap_or(here) };
    if folder.as_os_str().is_empty() { here } else { folder }
}

/// The models of files and folders, folders with all that is in them; tables of columns by the headings that are said of them. A
/// file that cannot be read is a fault, and the rest is read.
pub fn read_models(
    paths: &[PathBuf],
    headings: &Headings,
    progress: &dyn FolderProgress,
) -> Result<FoundModels, FileError> {
    let files = files_of(paths, &ENDINGS)?;
    let mut found = FoundModels { files: files.len(), ..FoundModels::default() };
    let mut loose: Vec<LooseMatrix> = Vec::new();
    for (index, (path, name)) in files.iter().enumerate() {
        if progress.stopped(0) {
            break;
        }
        progress.reading(index + 1, files.len(), name);
        match read_file(path, (name, headings.get(name)), &|taken| progress.stopped(taken)) {
            Ok(mut of_file) => {
                loose.extend(of_file.loose);
                found.tables.extend(of_file.headings.map(|headings| (name.clone(), headings)));
                found.models.append(&mut of_file.recognised.models);
                let at =
                    |words: String| if words.starts_with(name.as_str()) { words } else { format!("{name}: {words}") };
                found.faults.extend(of_file.recognised.faults.into_iter().map(at));
                found.passed_over.extend(of_file.recognised.passed_over.into_iter().map(at));
            }
            Err(error) if paths.len() == 1 && files.len() == 1 => return Err(error),
            Err(error) => found.faults.push(error.to_string()),
        }
    }
    let of_matrices = models_of_matrices(loose);
    found.models.extend(of_matrices.models);
    found.faults.extend(of_matrices.faults);
    Ok(found)
}

/// Files, and those of folders whose names end so, in the order of their names: their paths, and their names relative to what was asked
/// for.
pub(crate) fn files_of(paths: &[PathBuf], endings: &[&str]) -> Result<Vec<(PathBuf, String)>, FileError> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            list(path, (path, endings), DEEPEST, &mut files)?;
        } else {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            files.push((path.clone(), name));
        }
    }
    Ok(files)
}

/// The files below a folder, in the order of their names, with their paths relative to it.
fn list(
    folder: &Path,
    (root, endings): (&Path, &[&str]),
    deeper: usize,
    files: &mut Vec<(PathBuf, String)>,
) -> Result<(), FileError> {
    let failed = |error: std::io::Error| FileError::reading(folder, &error);
    let mut entries = fs::read_dir(folder).map_err(failed)?.collect::<Result<Vec<_>, _>>().map_err(failed)?;
    entries.sort_by_key(|entry| natural(&entry.file_name().to_string_lossy()));
    for entry in entries {
        let path = entry.path();
        let hidden = entry.file_name().to_string_lossy().starts_with('.');
        // Links could lead in circles.
        let kind = entry.file_type().map_err(failed)?;
        if hidden || kind.is_symlink() && path.is_dir() {
            continue;
        }
        if kind.is_dir() {
            if deeper == 0 {
                return Err(FileError::FolderTooDeep { path });
            }
            list(&path, (root, endings), deeper - 1, files)?;
        } else if has_ending(&path, endings) {
            let name = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            files.push((path, name));
        }
        if files.len() > MOST_FILES {
            return Err(FileError::TooManyFiles { path: root.to_owned(), most: MOST_FILES });
        }
    }
    Ok(())
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
    endings.contains(&ending.as_str()) && !sanitized_path(path).ends_with(".gdcm-study.json")
}

/// A key that sorts "c2" before "c10".
fn natural(name: &str) -> Vec<(String, u64)> {
    let mut parts = Vec::new();
    let (mut text, mut digits) = (String::new(), String::new());
    for letter in name.chars().chain(['\0']) {
        if letter.is_ascii_digit() && digits.len() < 18 {
            digits.push(letter);
            continue;
        }
        if !digits.is_empty() {
            parts.push((std::mem::take(&mut text), digits.parse().unwrap_or(u64::MAX)));
            digits.clear();
        }
        text.extend(letter.to_lowercase());
    }
    parts.push((text, 0));
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_sorted_as_people_count() {
        let mut names = ["c10", "c2", "C1b", "c1", "roll+5", "roll-5"];
        names.sort_by_key(|name| natural(name));
        assert_eq!(names, ["c1", "C1b", "c2", "c10", "roll+5", "roll-5"]);
    }
}
