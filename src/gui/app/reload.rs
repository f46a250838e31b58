//! A dataset whose file changes on the disk while open: the thread that detects changes, and the
//! reload.

use gdcm_words::decisions::dataset_difference_text;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use gdcm_io::files::dataset_file::load_dataset_within;
use gdcm_io::source::{FileStamp, file_sha256};
use gdcm_io::{LoadedDataset, Opened};

use super::GdcmApp;
use super::files::ReadFor;
use super::threads::ReplySender;
use crate::gui::panels::bars::Bar;

impl GdcmApp {
    /// Watches the file of the open dataset.
    pub(super) fn watch_disk(&mut self) {
        self.disk.watch(self.loaded.path());
    }

    /// Reports whether the dataset's file has changed.
    fn file_seen(&mut self, seen: &Seen) {
        if self.loaded.path() != Some(&seen.path) {
            return;
        }
        self.keep_open();
        if seen.sha256 != self.loaded.sha256 {
            self.state.bars.push(Bar::Changed {
                name: self.loaded.file_name(),
            });
        }
    }

    /// Keeps the open dataset until the file changes again.
    pub(super) fn keep_open(&mut self) {
        self.state
            .bars
            .retain(|bar| !matches!(bar, Bar::Changed { .. }));
    }

    /// Reads the dataset's file again; the open dataset stays until it is read.
    pub(super) fn reload(&mut self) {
        if let Some(path) = self.loaded.path().map(ToOwned::to_owned) {
            let name = path.display().to_string();
            self.read(ReadFor::Reloading, name, move |budget| {
                load_dataset_within(&path, budget).map(Opened::Dataset)
            });
        }
    }

    /// Shows the reloaded dataset with every decision that still applies, as one undoable step.
    pub(super) fn show_reloaded(&mut self, loaded: LoadedDataset) {
        if loaded.path() != self.loaded.path() {
            // Another file was opened in the meantime.
            return;
        }
        self.keep_open();
        self.state
            .bars
            .retain(|bar| !matches!(bar, Bar::Differences { .. }));
        let name = loaded.file_name();
        let (study, differences) = self.state.study.reconciled(Arc::clone(&loaded.dataset));
        let before = std::mem::replace(&mut self.state.study, study);
        self.state
            .history
            .record_reload(before, format!("reload {name}"));
        self.earlier.push(loaded);
        self.study_changed();
        let sentences: Vec<String> = differences.iter().map(dataset_difference_text).collect();
        if sentences.is_empty() {
            self.done(format!("reloaded {name}: every decision still applies"));
        } else {
            self.state.bars.push(Bar::Differences { name, sentences });
        }
    }

    /// Selects the file of the study's dataset, after a reload or an undo or redo across one.
    pub(super) fn follow_dataset(&mut self) {
        let dataset = self.state.study.file_dataset();
        if let Some(index) = self
            .earlier
            .iter()
            .position(|loaded| Arc::ptr_eq(&loaded.dataset, dataset))
        {
            std::mem::swap(&mut self.loaded, &mut self.earlier[index]);
            self.state.file_cautions.clone_from(&self.loaded.cautions);
        }
        self.state.follow_dataset();
    }
}

/// New content of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Seen {
    path: PathBuf,
    sha256: String,
}

/// Checks one file every second or two: its time and length, and its bytes if these have changed.
/// It polls, because network drives send no events.
pub(super) struct DiskWatch {
    paths: Sender<Option<PathBuf>>,
    watched: Option<PathBuf>,
}

impl DiskWatch {
    /// Starts the thread, which ends with the window.
    pub(super) fn start(every: Duration, replies: ReplySender) -> std::io::Result<Self> {
        let (paths, to_watch) = channel();
        let look = move || look(&to_watch, every, &replies);
        std::thread::Builder::new()
            .name("disk".to_owned())
            .spawn(look)?;
        Ok(Self {
            paths,
            watched: None,
        })
    }

    /// Watches this file from now on, or none.
    pub(super) fn watch(&mut self, path: Option<&Path>) {
        if self.watched.as_deref() != path {
            self.watched = path.map(Path::to_owned);
            // Without the thread nothing is watched.
            let _ = self.paths.send(self.watched.clone());
        }
    }
}

/// Known state of the watched file.
#[derive(Default)]
struct Known {
    path: PathBuf,
    /// Stamp at the last check.
    stamp: Option<FileStamp>,
    /// Stamp at the last read of its bytes.
    read: Option<FileStamp>,
    sha256: Option<String>,
}

impl Known {
    /// Checks the file once; returns its content if new. A file being written is read once its
    /// stamp stays the same.
    fn look(&mut self, path: &Path) -> Option<Seen> {
        if self.path != path {
            *self = Known {
                path: path.to_owned(),
                ..Known::default()
            };
        }
        // A missing file may be about to appear; until then the open dataset stays.
        let stamp = FileStamp::of(path)?;
        let rests = self.stamp == Some(stamp);
        self.stamp = Some(stamp);
        if !rests || self.read == Some(stamp) {
            return None;
        }
        let sha256 = file_sha256(path).ok()?;
        // Written again in the meantime: wait for the next check.
        if FileStamp::of(path) != Some(stamp) {
            return None;
        }
        self.read = Some(stamp);
        let is_new = self.sha256.as_ref() != Some(&sha256);
        self.sha256 = Some(sha256.clone());
        is_new.then(|| Seen {
            path: path.to_owned(),
            sha256,
        })
    }
}

fn look(to_watch: &Receiver<Option<PathBuf>>, every: Duration, replies: &ReplySender) {
    let mut known = Known::default();
    let mut watched = None;
    loop {
        match to_watch.recv_timeout(every) {
            Ok(path) => watched = path,
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                if let Some(seen) = watched.as_deref().and_then(|path| known.look(path)) {
                    replies.send(move |app| app.file_seen(&seen));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_told_once_it_rests_and_again_only_when_its_bytes_are_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("data.json");
        let mut known = Known::default();
        assert_eq!(known.look(&path), None, "there is none");
        std::fs::write(&path, "one").unwrap();
        assert_eq!(known.look(&path), None, "it may be being written");
        let first = known.look(&path).expect("it rests");
        assert_eq!(known.look(&path), None, "told already");
        std::fs::write(&path, "one, and more").unwrap();
        assert_eq!(known.look(&path), None);
        assert_ne!(known.look(&path).expect("it rests").sha256, first.sha256);
        // Rewritten with the same bytes: another time, the same hash.
        std::fs::remove_file(&path).unwrap();
        std::thread::sleep(Duration::from_millis(20));
        std::fs::write(&path, "one, and more").unwrap();
        assert_eq!(
            [known.look(&path), known.look(&path), known.look(&path)],
            [None, None, None]
        );
    }
}
