//! List of recently opened and saved files.

use std::path::{Path, PathBuf};

use gdcm_io::FileError;
use gdcm_io::files::recent_files::{add_recent_file, recent_files};
use gdcm_io::user_paths::file_exists;
use gdcm_model::message_text::{sanitized, sanitized_path};

use super::GdcmApp;
use crate::gui::state::window_state::RecentFile;

impl GdcmApp {
    /// Puts the open study, or else the open dataset, first in the recent-files list.
    pub(super) fn list_open_file_as_recent(&self) {
        let study = self.files.saved.path.as_deref();
        let newest = study.or(self.files.loaded.path());
        self.refresh_recent_files(newest.map(Path::to_owned));
    }

    /// Reads the recent-files list and checks which files exist; puts `newest` first. Runs in a
    /// separate thread, because a network drive may be slow.
    pub(super) fn refresh_recent_files(&self, newest: Option<PathBuf>) {
        let Some(directory) = self.files.directory.clone() else {
            return;
        };
        let read = move || read_recent_files(&directory, newest.as_deref());
        self.in_thread("the reading of recent files", read, |app, read| {
            if let Some(files) = read.and_then(|read| app.value_or_notify(read)) {
                app.state.recent = files;
            }
        });
    }
}

/// Reads the recent-files list and puts `newest` first.
fn read_recent_files(
    directory: &Path,
    newest: Option<&Path>,
) -> Result<Vec<RecentFile>, FileError> {
    if let Some(newest) = newest {
        add_recent_file(directory, newest)?;
    }
    Ok(recent_files(directory)
        .into_iter()
        .map(recent_file)
        .collect())
}

fn recent_file(path: PathBuf) -> RecentFile {
    let name = path
        .file_name()
        .map(|name| sanitized(&name.to_string_lossy()))
        .unwrap_or_default();
    let folder = path.parent().map(sanitized_path).unwrap_or_default();
    RecentFile {
        missing: !file_exists(&path),
        path,
        name,
        folder,
    }
}
