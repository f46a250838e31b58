//! Thread that detects changes in the open dataset's file.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use gdcm_io::file_reading::file_sha256;
use gdcm_io::user_paths::FileStamp;

use super::threads::ReplySender;

/// The watched file, and the hash of its content after a change.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ChangedFile {
    pub(super) path: PathBuf,
    pub(super) sha256: String,
}

/// Thread that checks a file at a fixed interval: its modification time and length, and its bytes
/// if these have changed. It polls, because network drives send no events.
pub(super) struct DiskWatch {
    paths: Sender<Option<PathBuf>>,
    watched: Option<PathBuf>,
}

impl DiskWatch {
    /// Starts the thread, which ends with the window.
    pub(super) fn start(every: Duration, replies: ReplySender) -> std::io::Result<Self> {
        let (paths, received) = channel();
        std::thread::Builder::new()
            .name("disk".to_owned())
            .spawn(move || poll(&received, every, &replies))?;
        Ok(Self {
            paths,
            watched: None,
        })
    }

    /// Watches the file at `path` from now on; `None` ends the watching.
    pub(super) fn watch(&mut self, path: Option<&Path>) {
        if self.watched.as_deref() != path {
            self.watched = path.map(Path::to_owned);
            // Ignore a failure: if the thread has ended, no file is watched.
            let _ = self.paths.send(self.watched.clone());
        }
    }
}

/// The watched file at the last check.
#[derive(Default)]
struct LastCheck {
    path: PathBuf,
    /// Modification time and length at the last check.
    stamp: Option<FileStamp>,
    /// Modification time and length when the bytes were last read.
    read: Option<FileStamp>,
    sha256: Option<String>,
}

impl LastCheck {
    /// Checks the file once; returns the hash of its content if this has changed, or is read for
    /// the first time. The bytes are read if time and length (the stamp) equal those of the last
    /// check, so that a file that is being written is not read, and differ from those at the last
    /// reading. `None` in every other case: the file is missing, cannot be read, was written
    /// meanwhile, or has the same bytes as before.
    fn check(&mut self, path: &Path) -> Option<ChangedFile> {
        if self.path != path {
            *self = LastCheck {
                path: path.to_owned(),
                ..LastCheck::default()
            };
        }
        // A missing file may be about to be replaced; the open dataset remains until the file
        // reappears.
        let stamp = FileStamp::read(path)?;
        let is_unchanged = self.stamp == Some(stamp);
        self.stamp = Some(stamp);
        if !is_unchanged || self.read == Some(stamp) {
            return None;
        }
        let sha256 = file_sha256(path).ok()?;
        // The file was written again in the meantime: wait for the next check.
        if FileStamp::read(path) != Some(stamp) {
            return None;
        }
        self.read = Some(stamp);
        if self.sha256.as_ref() == Some(&sha256) {
            return None;
        }
        self.sha256 = Some(sha256.clone());
        let path = path.to_owned();
        Some(ChangedFile { path, sha256 })
    }
}

/// Checks the watched file at every interval until the window ends.
fn poll(paths: &Receiver<Option<PathBuf>>, every: Duration, replies: &ReplySender) {
    let mut last = LastCheck::default();
    let mut watched = None;
    loop {
        match paths.recv_timeout(every) {
            Ok(path) => watched = path,
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                if let Some(changed) = watched.as_deref().and_then(|path| last.check(path)) {
                    replies.send(move |app| app.file_changed(&changed));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_reported_once_it_rests_and_again_only_when_its_bytes_change() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("data.json");
        let mut last = LastCheck::default();
        assert_eq!(last.check(&path), None, "there is none");
        std::fs::write(&path, "one").unwrap();
        assert_eq!(last.check(&path), None, "it may be being written");
        let first = last.check(&path).expect("it rests");
        assert_eq!(last.check(&path), None, "reported already");
        std::fs::write(&path, "one, and more").unwrap();
        assert_eq!(last.check(&path), None);
        assert_ne!(last.check(&path).expect("it rests").sha256, first.sha256);
        // The file is rewritten with the same bytes: another modification time, but the same hash.
        std::fs::remove_file(&path).unwrap();
        std::thread::sleep(Duration::from_millis(20));
        std::fs::write(&path, "one, and more").unwrap();
        assert_eq!(
            [last.check(&path), last.check(&path), last.check(&path)],
            [None, None, None]
        );
    }
}
