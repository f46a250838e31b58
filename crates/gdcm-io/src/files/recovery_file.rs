//! Recovery files: unsaved decisions saved to survive a crash.
//!
//! ```text
//! window opens       claim a name; create its lock file, and lock it          (claim)
//! decisions change   write the study, and in the lock file its last path      (write)
//! study is saved     remove the recovery file                                 (clear)
//! window closes      remove the lock file, unless the recovery file is left   (drop)
//! next start         recovery files whose lock is free are lost studies       (lost_studies)
//! ```

use std::fs::{self, File, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, SystemTime};

use gdcm_study::Study;

use super::dataset_file::LoadedDataset;
use super::study_file::{STUDY_EXTENSION, dataset_of_study, save_recovery};
use crate::file_error::FileError;
use crate::output_set::make_directory;

/// Extension for lock files, each of which is locked while its process runs.
const LOCK_EXTENSION: &str = "lock";
/// Age below which a lock file may belong to a process that has not locked it yet.
const YOUNG: Duration = Duration::from_secs(60);

/// An open window's recovery file: a study file named `PROCESS-NUMBER.gdcm-study.json`. A lock file
/// with the same name is locked while the process runs, and contains the path under which the user
/// last saved the study.
#[derive(Debug)]
pub struct RecoveryFile {
    path: PathBuf,
    lock_path: PathBuf,
    lock: File,
}

impl RecoveryFile {
    /// Claims a unique name in `directory`, which is created if missing.
    ///
    /// # Errors
    /// [`FileError`] if the directory or the lock file cannot be created.
    pub fn claim(directory: &Path) -> Result<Self, FileError> {
        /// Number of the next recovery file, which distinguishes the windows of one process.
        static NUMBER: AtomicUsize = AtomicUsize::new(1);
        make_directory(directory)?;
        loop {
            let name = format!(
                "{}-{}",
                std::process::id(),
                NUMBER.fetch_add(1, Ordering::Relaxed)
            );
            let path = directory.join(format!("{name}.{STUDY_EXTENSION}"));
            let lock_path = directory.join(format!("{name}.{LOCK_EXTENSION}"));
            // A file left by an earlier process with this id may still be waiting to be restored.
            if path.exists() || lock_path.exists() {
                continue;
            }
            let lock = File::create_new(&lock_path)
                .map_err(|error| FileError::writing(&lock_path, &error))?;
            lock.lock()
                .map_err(|error| FileError::writing(&lock_path, &error))?;
            return Ok(Self {
                path,
                lock_path,
                lock,
            });
        }
    }

    /// Returns the path at which [`Self::write`] creates the recovery file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the study completely or not at all; `saved_as` is the path under which the user last
    /// saved it.
    ///
    /// # Errors
    /// [`FileError`] if the recovery file or the lock file cannot be written.
    pub fn write(
        &mut self,
        study: &Study,
        loaded: &LoadedDataset,
        saved_as: Option<&Path>,
    ) -> Result<(), FileError> {
        let failed = |error| FileError::writing(&self.lock_path, &error);
        let name = saved_as
            .and_then(|path| std::path::absolute(path).ok())
            .unwrap_or_default();
        self.lock
            .set_len(0)
            .and_then(|()| self.lock.rewind())
            .map_err(failed)?;
        // Omit a path that is not valid Unicode: with replacement characters it would lead to
        // another file.
        self.lock
            .write_all(name.to_str().unwrap_or_default().as_bytes())
            .map_err(failed)?;
        save_recovery(study, loaded, &self.path)
    }

    /// Removes the recovery file, because its decisions are saved or not wanted.
    ///
    /// # Errors
    /// [`FileError`] if the file exists and cannot be removed.
    pub fn clear(&mut self) -> Result<(), FileError> {
        remove(&self.path)
    }
}

impl Drop for RecoveryFile {
    /// Removes the lock file, unless the recovery file exists: both are then kept for the next
    /// start.
    fn drop(&mut self) {
        if !self.path.exists() {
            // If the lock file cannot be removed now, the next start removes it.
            let _ = remove(&self.lock_path);
        }
    }
}

/// Recovery file from a window that ended without saving. Its lock prevents other windows from
/// finding it.
#[derive(Debug)]
pub struct LostStudy {
    path: PathBuf,
    lock_path: PathBuf,
    _lock: File,
    /// Time at which the recovery file was written.
    pub kept_at: SystemTime,
    /// Dataset file name, for display.
    pub dataset: String,
    /// Path under which the user last saved the study, if any.
    pub saved_as: Option<PathBuf>,
}

impl LostStudy {
    /// Returns the path of the recovery file, which opens as a study.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes the recovery file and its lock file.
    ///
    /// # Errors
    /// [`FileError`] if a file cannot be removed.
    pub fn remove(self) -> Result<(), FileError> {
        remove(&self.path)?;
        remove(&self.lock_path)
    }
}

/// Returns the recovery files in `directory` whose processes have ended, newest first. Removes old
/// lock files without a recovery file.
pub fn lost_studies(directory: &Path) -> Vec<LostStudy> {
    let Ok(entries) = fs::read_dir(directory) else {
        return Vec::new();
    };
    let mut lost: Vec<LostStudy> = Vec::new();
    for entry in entries.flatten() {
        lost.extend(lost_study(&entry.path()));
    }
    lost.sort_by_key(|lost| std::cmp::Reverse(lost.kept_at));
    lost
}

/// Returns the recovery file that belongs to a lock file. `None` for any other file, if the process
/// still runs, and without a recovery file; an old lock file without one is removed.
fn lost_study(lock_path: &Path) -> Option<LostStudy> {
    if lock_path.extension()? != LOCK_EXTENSION {
        return None;
    }
    let path = lock_path.with_extension(STUDY_EXTENSION);
    let mut lock = File::options()
        .read(true)
        .write(true)
        .open(lock_path)
        .ok()?;
    match lock.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock | TryLockError::Error(_)) => return None,
    }
    let Ok(kept_at) = fs::metadata(&path).and_then(|study| study.modified()) else {
        // No recovery file was written. Keep a recent lock file: its process may have created it
        // but not yet locked it.
        let created_at = lock.metadata().and_then(|lock| lock.modified()).ok();
        let age = created_at.and_then(|time| time.elapsed().ok());
        if age.is_some_and(|age| age > YOUNG) {
            let _ = remove(lock_path);
        }
        return None;
    };
    let mut name = String::new();
    // Treat an unreadable path as absent.
    let _ = lock.read_to_string(&mut name);
    let saved_as = if name.is_empty() {
        None
    } else {
        Some(PathBuf::from(name))
    };
    let dataset = dataset_of_study(&path).unwrap_or_else(|| "an unknown dataset".to_owned());
    Some(LostStudy {
        path,
        lock_path: lock_path.to_owned(),
        _lock: lock,
        kept_at,
        dataset,
        saved_as,
    })
}

fn remove(path: &Path) -> Result<(), FileError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(FileError::writing(path, &error))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::dataset_file::embedded_example;
    use crate::files::study_file::open_study;

    fn example() -> (Study, LoadedDataset) {
        let loaded = embedded_example().unwrap();
        (Study::new(loaded.dataset.clone()), loaded)
    }

    fn written(directory: &Path) -> RecoveryFile {
        let (study, loaded) = example();
        let mut file = RecoveryFile::claim(directory).unwrap();
        file.write(
            &study,
            &loaded,
            Some(Path::new("/somewhere/mine.gdcm-study.json")),
        )
        .unwrap();
        file
    }

    #[test]
    fn only_recovery_files_of_closed_windows_are_offered() {
        let directory = tempfile::tempdir().unwrap();
        let mine = written(directory.path());
        let other = written(directory.path());
        assert!(lost_studies(directory.path()).is_empty());
        drop(other);
        let lost = lost_studies(directory.path());
        assert_eq!(lost.len(), 1);
        assert_eq!(lost[0].dataset, "the embedded example");
        assert_eq!(
            lost[0].saved_as.as_deref(),
            Some(Path::new("/somewhere/mine.gdcm-study.json"))
        );
        assert_eq!(
            open_study(lost[0].path()).unwrap().study,
            example().0,
            "it opens by hand too"
        );
        drop(mine);
    }

    #[test]
    fn a_lost_study_is_offered_to_one_window_at_a_time() {
        let directory = tempfile::tempdir().unwrap();
        drop(written(directory.path()));
        let offered = lost_studies(directory.path());
        assert!(
            lost_studies(directory.path()).is_empty(),
            "held by the first"
        );
        drop(offered);
        assert_eq!(lost_studies(directory.path()).len(), 1);
    }

    #[test]
    fn saved_or_removed_studies_leave_nothing_behind() {
        let directory = tempfile::tempdir().unwrap();
        let mut file = written(directory.path());
        file.clear().unwrap();
        drop(file);
        drop(written(directory.path()));
        lost_studies(directory.path()).remove(0).remove().unwrap();
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
    }
}
