//! The thread that looks whether the dataset's file has changed on the disk.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use gdcm_files::{FileStamp, file_sha256};

/// What a file holds now, told when that is new.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Seen {
    pub(super) path: PathBuf,
    pub(super) sha256: String,
}

#[derive(Default)]
struct Watched {
    path: Option<PathBuf>,
    closed: bool,
}

#[derive(Default)]
struct Shared {
    watched: Mutex<Watched>,
    changed: Condvar,
}

impl Shared {
    fn watched(&self) -> MutexGuard<'_, Watched> {
        // A panic while the lock was held leaves a path that is still whole.
        self.watched.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// PlotStyle at one file every second or two: its time and its length, and where these are new, its bytes. Polling, because
/// network drives send no events.
pub(super) struct DiskWatch {
    shared: Arc<Shared>,
    seen: Receiver<Seen>,
}

impl DiskWatch {
    /// Starts the thread; `wake` is called when there is something to tell.
    pub(super) fn start(every: Duration, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (sender, seen) = channel();
        let of_thread = Arc::clone(&shared);
        let look = move || look(&of_thread, every, &sender, &wake);
        std::thread::Builder::new().name("disk".to_owned()).spawn(look)?;
        Ok(Self { shared, seen })
    }

    /// PlotStyle at this file from now on, or at none.
    pub(super) fn watch(&self, path: Option<&Path>) {
        let mut watched = self.shared.watched();
        if watched.path.as_deref() != path {
            watched.path = path.map(Path::to_owned);
            self.shared.changed.notify_one();
        }
    }

    /// What was seen last, if that is new.
    pub(super) fn seen(&self) -> Option<Seen> {
        self.seen.try_iter().last()
    }
}

impl Drop for DiskWatch {
    fn drop(&mut self) {
        self.shared.watched().closed = true;
        self.shared.changed.notify_one();
    }
}

/// What is known of the file looked at.
#[derive(Default)]
struct Known {
    path: PathBuf,
    /// At the last look.
    stamp: Option<FileStamp>,
    /// When its bytes were read last.
    read: Option<FileStamp>,
    sha256: Option<String>,
}

impl Known {
    /// PlotStyle once; what the file holds, where that is new. A file that is being written is read once it rests.
    fn look(&mut self, path: &Path) -> Option<Seen> {
        if self.path != path {
            *self = Known { path: path.to_owned(), ..Known::default() };
        }
        // A file that is not there is about to be, or what is open stays.
        let stamp = FileStamp::of(path)?;
        let rests = self.stamp == Some(stamp);
        self.stamp = Some(stamp);
        if !rests || self.read == Some(stamp) {
            return None;
        }
        let sha256 = file_sha256(path).ok()?;
        // Written again in between: at the next look.
        if FileStamp::of(path) != Some(stamp) {
            return None;
        }
        self.read = Some(stamp);
        let is_new = self.sha256.as_ref() != Some(&sha256);
        self.sha256 = Some(sha256.clone());
        is_new.then(|| Seen { path: path.to_owned(), sha256 })
    }
}

fn look(shared: &Shared, every: Duration, sender: &Sender<Seen>, wake: &dyn Fn()) {
    let mut known = Known::default();
    loop {
        let path = {
            let watched = shared.watched();
            let waits = |watched: &mut Watched| !watched.closed;
            let waited = shared.changed.wait_timeout_while(watched, every, waits);
            let (watched, _) = waited.unwrap_or_else(PoisonError::into_inner);
            if watched.closed {
                return;
            }
            watched.path.clone()
        };
        if let Some(seen) = path.and_then(|path| known.look(&path)) {
            // The window may be gone by now.
            let _ = sender.send(seen);
            wake();
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
        // Written anew with the same bytes: another time, the same hash.
        std::fs::remove_file(&path).unwrap();
        std::thread::sleep(Duration::from_millis(20));
        std::fs::write(&path, "one, and more").unwrap();
        assert_eq!([known.look(&path), known.look(&path), known.look(&path)], [None, None, None]);
    }
}
