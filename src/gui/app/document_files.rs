//! Files of the open study and dataset.

use std::path::{Path, PathBuf};

use gdcm_io::LoadedDataset;
use gdcm_io::files::study_file::STUDY_EXTENSION;
use gdcm_io::user_paths::at_home;
use gdcm_model::message_text::sanitized;
use gdcm_study::Study;
use gdcm_sysid::records::RecordChannels;

use super::disk_watch::DiskWatch;

/// The study as last saved.
#[derive(Clone, Debug)]
pub(super) struct SavedStudy {
    /// File path; `None` for a new study.
    pub(super) path: Option<PathBuf>,
    /// The study as saved, or as created if it is new, to detect unsaved changes. `None` if the
    /// study counts as unsaved from the start: decisions were restored, or some did not apply to
    /// the dataset.
    pub(super) study: Option<Study>,
}

/// Purpose for which a file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReadFor {
    /// The file is to be shown instead of the open study.
    Opening,
    /// The file replaces the open dataset, which was read from it earlier.
    Reloading,
    /// The file holds unsaved decisions to be continued; the value is the number of the offer to
    /// restore them (`recovery.rs`).
    Restoring(usize),
}

/// Files of the open study and dataset, and directories.
pub(super) struct DocumentFiles {
    pub(super) loaded: LoadedDataset,
    pub(super) saved: SavedStudy,
    /// Datasets that were open before a reload, or after a reload that was undone: undo and redo
    /// switch between them.
    pub(super) replaced_datasets: Vec<LoadedDataset>,
    /// Dataset most recently made from records.
    pub(super) made_of_records: Option<DatasetOfRecords>,
    /// Folder with the last written files.
    pub(super) last_folder: Option<PathBuf>,
    pub(super) disk: DiskWatch,
    /// Directory for the recent-files list; without it the list is not kept.
    pub(super) directory: Option<PathBuf>,
    /// Directory that replaces `~` in typed paths.
    pub(super) home: Option<PathBuf>,
}

impl DocumentFiles {
    /// Expands `~` in a typed path to the home directory.
    pub(super) fn at_home(&self, typed: PathBuf) -> PathBuf {
        at_home(&typed, self.home.as_deref())
    }

    /// Returns the folder that save dialogs propose: the one with the last written files, the
    /// study's, or the dataset's; otherwise the home directory.
    pub(super) fn proposed_folder(&self) -> Option<PathBuf> {
        let study = self.saved.path.as_deref().and_then(Path::parent);
        let dataset = self.loaded.path().and_then(Path::parent);
        let folders = [
            self.last_folder.as_deref(),
            study,
            dataset,
            self.home.as_deref(),
        ];
        let folder = folders
            .into_iter()
            .flatten()
            .find(|folder| !folder.as_os_str().is_empty())?;
        Some(folder.to_owned())
    }

    /// Returns the path that a form proposes for a file called `name`: in the folder typed before,
    /// otherwise in the proposed folder.
    pub(super) fn proposed_path(&self, typed: &str, name: &str) -> String {
        let typed = Path::new(typed.trim());
        let path = match typed.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.join(name),
            _ => match self.proposed_folder() {
                Some(folder) => folder.join(name),
                None => PathBuf::from(name),
            },
        };
        path.display().to_string()
    }

    /// Returns the path that is proposed for saving the study: its own path, or else a path in the
    /// proposed folder.
    pub(super) fn proposed_name(&self) -> String {
        if let Some(path) = &self.saved.path {
            return path.display().to_string();
        }
        self.proposed_path("", &format!("{}.{STUDY_EXTENSION}", self.stem()))
    }

    /// Returns the stem from which the names of result files are formed.
    pub(super) fn stem(&self) -> String {
        if let Some(example) = self.loaded.origin.example() {
            return example.file_stem().to_owned();
        }
        match self.loaded.path().and_then(Path::file_stem) {
            Some(stem) => stem.to_string_lossy().trim_end_matches(".json").to_owned(),
            None => "dataset".to_owned(),
        }
    }

    /// Returns the input files, which are never overwritten by results.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.saved
            .path
            .iter()
            .cloned()
            .chain(self.loaded.origin.file())
            .collect()
    }
}

/// Returns a study's file name, or a substitute without a path.
pub(super) fn study_name(path: Option<&Path>) -> String {
    match path.and_then(Path::file_name) {
        Some(name) => sanitized(&name.to_string_lossy()),
        None => "untitled study".to_owned(),
    }
}

/// Adds the study extension, unless the name ends in ".json".
pub(super) fn with_study_extension(path: PathBuf) -> PathBuf {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    if name.ends_with(".json") {
        path
    } else {
        path.with_file_name(format!("{name}.{STUDY_EXTENSION}"))
    }
}

pub(super) struct DatasetOfRecords {
    pub(super) path: PathBuf,
    /// Channels read from the records, with their aliases, units and conversions.
    pub(super) channels: RecordChannels,
    /// Records left out, with reasons.
    pub(super) left_out: Vec<String>,
}
