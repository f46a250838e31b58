//! Lists files in folders and their subfolders, sorted by name; numbers in names are compared by
//! value, so that "c2" comes before "c10".

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use gdcm_model::message_text::sanitized;

use crate::file_error::FileError;
use crate::file_reading::special_file_kind;
use crate::formats::text::TEXT;
use crate::formats::{ending_of, importer_of, is_known};

/// Maximum number of files, over all given paths.
pub(crate) const MOST_FILES: usize = 20_000;
/// Maximum number of folder levels below a given folder.
pub(crate) const DEEPEST: usize = 16;

pub(super) struct ListedFile {
    pub(super) path: PathBuf,
    /// Path relative to the listed folder; for a file given by itself, its name.
    pub(super) name: String,
}

/// Returns the folder to which file names in models are relative: the first source if it is a
/// folder, otherwise the folder that contains the first source.
pub fn sources_folder(sources: &[PathBuf]) -> &Path {
    let here = Path::new(".");
    let first = sources.first().map_or(here, PathBuf::as_path);
    let folder = if first.is_dir() {
        first
    } else {
        first.parent().unwrap_or(here)
    };
    if folder.as_os_str().is_empty() {
        here
    } else {
        folder
    }
}

/// Lists the given files, and the files with known extensions ([`is_known`]) in the given folders,
/// sorted by name within each folder. Each pipe, socket or device in a folder is skipped with a
/// message in `skipped`; [`Listing::add_folder`] says what is skipped silently.
///
/// # Errors
/// [`FileError`] if a folder cannot be read or is nested too deeply, or if there are too many
/// files.
pub(super) fn list_files(
    paths: &[PathBuf],
    skipped: &mut Vec<String>,
) -> Result<Vec<ListedFile>, FileError> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            let mut listing = Listing {
                root: path,
                files,
                skipped,
            };
            listing.add_folder(path, DEEPEST)?;
            files = listing.files;
        } else {
            let name = match path.file_name() {
                Some(name) => name.to_string_lossy().into_owned(),
                None => String::new(),
            };
            files.push(ListedFile {
                path: path.clone(),
                name,
            });
        }
    }
    Ok(files)
}

/// State while the files below a folder are listed.
struct Listing<'p> {
    root: &'p Path,
    /// Files found so far, including those from other given paths.
    files: Vec<ListedFile>,
    skipped: &'p mut Vec<String>,
}

impl Listing<'_> {
    /// Adds the files in a folder and in its subfolders, down to `deeper` subfolder levels; each
    /// recursion lowers `deeper` by 1. Skips silently: hidden entries, linked folders, files with
    /// unknown extensions, and `.log` and `.bin` files in no recognisable format
    /// ([`is_other_log`]).
    ///
    /// # Errors
    /// [`FileError`] if a folder cannot be read or is nested too deeply, or if there are too many
    /// files.
    fn add_folder(&mut self, folder: &Path, deeper: usize) -> Result<(), FileError> {
        let failed = |error: std::io::Error| FileError::reading(folder, &error);
        let mut entries = fs::read_dir(folder)
            .map_err(failed)?
            .collect::<Result<Vec<_>, _>>()
            .map_err(failed)?;
        entries.sort_by_key(|entry| natural_key(&entry.file_name().to_string_lossy()));
        for entry in entries {
            let path = entry.path();
            let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
            let kind = entry.file_type().map_err(failed)?;
            // Skip linked folders, which could form cycles.
            let is_linked_folder = kind.is_symlink() && path.is_dir();
            if is_hidden || is_linked_folder {
                continue;
            }
            if kind.is_dir() {
                if deeper == 0 {
                    return Err(FileError::FolderTooDeep { path });
                }
                self.add_folder(&path, deeper - 1)?;
            } else if is_known(&path) && !is_other_log(&path) {
                self.add_file(path, kind);
            }
            if self.files.len() > MOST_FILES {
                return Err(FileError::TooManyFiles {
                    path: self.root.to_owned(),
                    most: MOST_FILES,
                });
            }
        }
        Ok(())
    }

    /// Adds a file; if the path leads to a pipe, a socket or a device, adds a message instead.
    fn add_file(&mut self, path: PathBuf, kind: fs::FileType) {
        let name = path
            .strip_prefix(self.root)
            .unwrap_or(&path)
            .to_string_lossy()
            .replace('\\', "/");
        // The type of the file to which a link leads.
        let target = fs::metadata(&path).map_or(kind, |metadata| metadata.file_type());
        match special_file_kind(target) {
            Some(kind) => self.skipped.push(format!(
                "{}: skipped, because this is {kind}, not a file",
                sanitized(&name)
            )),
            None => self.files.push(ListedFile { path, name }),
        }
    }
}

/// Returns whether this is a `.log` or `.bin` file whose first bytes are recognised only by the
/// text importer, which accepts any file: many programs use these extensions.
fn is_other_log(path: &Path) -> bool {
    /// Number of leading bytes by which the formats are recognised.
    const FIRST: usize = 64;
    if !["bin", "log"].contains(&ending_of(path).as_str()) || !path.is_file() {
        return false;
    }
    let mut first = Vec::with_capacity(FIRST);
    let read =
        fs::File::open(path).and_then(|file| file.take(FIRST as u64).read_to_end(&mut first));
    read.is_ok() && importer_of(&first, path).name == TEXT.name
}

/// Part of a name, in lower case, and the number after it.
type TextAndNumber = (String, u64);

/// Returns a sort key that ignores case and compares numbers by value: "c2" comes before "C10".
fn natural_key(name: &str) -> Vec<TextAndNumber> {
    /// Maximum number of digits read as one number, so that it fits in 64 bits.
    const LONGEST: usize = 18;
    let mut parts = Vec::new();
    let mut text = String::new();
    let mut digits = String::new();
    // A part ends before the first other character after its digits, or after `LONGEST` digits.
    for letter in name.chars() {
        if letter.is_ascii_digit() && digits.len() < LONGEST {
            digits.push(letter);
            continue;
        }
        if !digits.is_empty() {
            parts.push(text_and_number(&mut text, &mut digits));
        }
        text.extend(letter.to_lowercase());
    }
    if !digits.is_empty() {
        parts.push(text_and_number(&mut text, &mut digits));
    }
    // With a NUL character, a shorter name sorts before its continuations.
    text.push('\0');
    parts.push((text, 0));
    parts
}

/// Returns a name part and the number after it, and clears both.
fn text_and_number(text: &mut String, digits: &mut String) -> TextAndNumber {
    let number = digits.parse().unwrap_or(u64::MAX);
    digits.clear();
    (std::mem::take(text), number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_sorted_as_people_count() {
        let mut names = ["c10", "c2", "C1b", "c1", "roll+5", "roll-5"];
        names.sort_by_key(|name| natural_key(name));
        assert_eq!(names, ["c1", "C1b", "c2", "c10", "roll+5", "roll-5"]);
    }
}
