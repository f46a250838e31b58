//! The way from one place in the file system to another.

use std::path::{Component, Path, PathBuf};

/// The path that leads from a directory to a file, both absolute and free of `.` and `..`; the file's own path where there is no
/// common root (another drive).
pub(super) fn relative_path(file: &Path, directory: &Path) -> PathBuf {
    let (to, from): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (file.components().collect(), directory.components().collect());
    let common = to.iter().zip(&from).take_while(|(to, from)| to == from).count();
    if common == 0 {
        return file.to_owned();
    }
    let up = from[common..].iter().map(|_| Component::ParentDir);
    up.chain(to[common..].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_goes_up_to_the_common_directory_and_down_again() {
        for (file, directory, expected) in [
            ("/a/b/data.json", "/a/b", "data.json"),
            ("/a/b/c/data.json", "/a/b", "c/data.json"),
            ("/a/data.json", "/a/b/c", "../../data.json"),
            ("/x/data.json", "/a/b", "../../x/data.json"),
        ] {
            assert_eq!(relative_path(Path::new(file), Path::new(directory)), Path::new(expected), "{file} {directory}");
        }
    }
}
