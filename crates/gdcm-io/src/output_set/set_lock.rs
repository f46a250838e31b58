//! Locks a directory while a set's files are renamed.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use super::temporary_files::{PREFIX, SUFFIX};

/// Lock on a directory while a set's files are renamed in it: two sets must not be renamed at the
/// same time. Implemented as a file lock, which the operating system also releases if the process
/// crashes.
pub(super) struct SetLock {
    path: PathBuf,
    _file: File,
}

impl SetLock {
    /// Waits for the lock; `None` if there can be none, for example because the file system has no
    /// locks.
    pub(super) fn acquire(directory: &Path) -> Option<Self> {
        let path = directory.join(format!("{PREFIX}lock{SUFFIX}"));
        loop {
            let file = File::options()
                .create(true)
                .truncate(false)
                .write(true)
                .open(&path)
                .ok()?;
            file.lock().ok()?;
            let locked = same_file::Handle::from_file(file.try_clone().ok()?).ok()?;
            // The previous owner may have removed the file whose lock was awaited.
            if same_file::Handle::from_path(&path).is_ok_and(|there| there == locked) {
                return Some(Self { path, _file: file });
            }
        }
    }
}

impl Drop for SetLock {
    fn drop(&mut self) {
        // A file that cannot be removed now is removed as a leftover later.
        let _ = fs::remove_file(&self.path);
    }
}
