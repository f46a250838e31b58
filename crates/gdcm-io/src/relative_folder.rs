//! Relative path from a file to a folder, as written in files that may be moved together with the
//! folder.

use std::path::{Path, PathBuf};

/// Returns the relative path from `file`'s directory to `folder`, with `/` as the separator. An
/// empty `folder` is the current directory; without a relative path, `folder` itself is returned.
pub fn relative_folder(folder: &Path, file: &Path) -> String {
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let relative = relative_path(folder, file);
    let path = relative.as_deref().unwrap_or(folder);
    path.to_string_lossy()
        .replace(std::path::MAIN_SEPARATOR, "/")
}

/// Returns the relative path from `file`'s directory to `folder`; `None` if there is none.
fn relative_path(folder: &Path, file: &Path) -> Option<PathBuf> {
    let folder = std::path::absolute(folder).ok()?;
    let file = std::path::absolute(file).ok()?;
    pathdiff::diff_paths(folder, file.parent()?)
}
