//! Paths that the user typed or that the program remembers: home directory, existence, and changes
//! on the disk.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Returns whether there is a file at `path`; false for a directory.
pub fn file_exists(path: &Path) -> bool {
    path.is_file()
}

/// Replaces a leading `~` by the home directory, as a shell does. Other paths, and all paths if the
/// home directory is unknown, are unchanged.
pub fn at_home(path: &Path, home: Option<&Path>) -> PathBuf {
    let Some(home) = home else {
        return path.to_owned();
    };
    match path.strip_prefix("~") {
        Ok(rest) if rest.as_os_str().is_empty() => home.to_owned(),
        Ok(rest) => home.join(rest),
        Err(_) => path.to_owned(),
    }
}

/// Metadata that change when a file is written. Querying them is cheap, even on a network drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileStamp {
    modified: Option<SystemTime>,
    length: u64,
}

impl FileStamp {
    /// Reads the metadata; `None` if there is no file at `path`.
    pub fn read(path: &Path) -> Option<Self> {
        let metadata = fs::metadata(path).ok().filter(fs::Metadata::is_file)?;
        Some(Self {
            modified: metadata.modified().ok(),
            length: metadata.len(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilde_means_home_as_in_a_shell() {
        let home = Path::new("/home/ada");
        for (typed, meant) in [
            ("~", "/home/ada"),
            ("~/", "/home/ada"),
            ("~/x/data.json", "/home/ada/x/data.json"),
            ("~bob/x", "~bob/x"),
            ("x/~/y", "x/~/y"),
            ("/data/x", "/data/x"),
        ] {
            assert_eq!(
                at_home(Path::new(typed), Some(home)),
                Path::new(meant),
                "{typed}"
            );
            assert_eq!(at_home(Path::new(typed), None), Path::new(typed));
        }
    }
}
