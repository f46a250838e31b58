//! Thread that keeps unsaved decisions in a recovery file.
//!
//! [`Autosave`] sends tasks to the thread, whose state is the [`Keeper`]. Decisions first wait as
//! pending, so that a drag does not write the file at each step; the oldest pending decision sets
//! the time at which the newest are written. After an error they remain pending for a retry.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant, SystemTime};

use gdcm_io::files::recovery_file::{LostStudy, RecoveryFile, lost_studies};
use gdcm_io::{FileError, LoadedDataset};
use gdcm_study::Study;

use super::threads::ReplySender;

/// Folder for recovery files in the program's directory.
const FOLDER: &str = "recovery";
/// Delay before a retry after a failure, such as a full disk.
const AGAIN_AFTER: Duration = Duration::from_secs(10);
/// Waiting time if no work is pending.
const NEVER: Duration = Duration::from_secs(3600);

/// Decisions to keep. All parts are shared, so a copy is cheap.
#[derive(Clone, Debug)]
pub(super) struct Unsaved {
    pub(super) study: Study,
    pub(super) loaded: LoadedDataset,
    pub(super) saved_as: Option<PathBuf>,
}

/// Unsaved decisions stored in a recovery file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    pub path: PathBuf,
    /// Time of the latest decision in the file.
    pub at: SystemTime,
}

/// Fate of the unsaved decisions when the window ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remains {
    /// There are no unsaved decisions.
    Saved,
    /// All unsaved decisions are in the recovery file.
    Kept(Kept),
    /// Some decisions are in the recovery file; for later ones, writing failed for the given
    /// reason.
    KeptInPart(Kept, String),
    /// Unsaved decisions are lost, because writing failed for the given reason.
    Lost(String),
}

impl Remains {
    fn new(last: Option<Kept>, trouble: Option<String>) -> Self {
        match (last, trouble) {
            (None, None) => Self::Saved,
            (Some(kept), None) => Self::Kept(kept),
            (Some(kept), Some(why)) => Self::KeptInPart(kept, why),
            (None, Some(why)) => Self::Lost(why),
        }
    }
}

/// Task for the recovery thread.
pub(super) enum Task {
    /// Keep these decisions, made at this time.
    Keep(Box<Unsaved>, SystemTime),
    /// Delete the recovery file: every decision is saved or discarded.
    Clear,
    /// The lost decisions are open again: delete their old recovery file once they are kept in a
    /// new one or saved.
    Restored(LostStudy),
    /// Delete the recovery file of these lost decisions.
    Discard(LostStudy),
    /// Finish pending work now and reply with the resulting state.
    Flush(Sender<Remains>),
    /// End the thread; the recovery file remains for the next start.
    Close,
}

/// Handle to the recovery thread. Without a directory, no decisions are kept.
#[derive(Clone)]
pub struct Autosave {
    tasks: Sender<Task>,
    /// Decisions most recently kept; `None` once they are saved.
    kept: Arc<Mutex<Option<Kept>>>,
    /// State of the unsaved decisions when the window and this thread ended.
    at_end: Arc<OnceLock<Remains>>,
}

impl Autosave {
    /// Starts the thread, which first offers the unsaved decisions of windows that crashed.
    pub(super) fn start(
        directory: Option<&Path>,
        keep_after: Duration,
        replies: ReplySender,
    ) -> std::io::Result<Self> {
        let (tasks, received) = channel();
        let folder = directory.map(|directory| directory.join(FOLDER));
        let kept = Arc::<Mutex<Option<Kept>>>::default();
        let keeper_kept = Arc::clone(&kept);
        let work = move || {
            if let Some(folder) = &folder {
                let lost = lost_studies(folder);
                replies.send(move |app| app.offer(lost));
            }
            let keeper = Keeper {
                folder,
                keep_after,
                replies,
                file: None,
                pending: None,
                kept: keeper_kept,
                restored: Vec::new(),
            };
            keeper.work(&received);
        };
        std::thread::Builder::new()
            .name("autosave".to_owned())
            .spawn(work)?;
        Ok(Self {
            tasks,
            kept,
            at_end: Arc::default(),
        })
    }

    pub(super) fn send(&self, task: Task) {
        // Ignore a failure: the thread ends with the window.
        let _ = self.tasks.send(task);
    }

    /// Keeps unsaved decisions; the newest reach the recovery file soon after the first change.
    pub(super) fn keep(&self, unsaved: Unsaved) {
        self.send(Task::Keep(Box::new(unsaved), SystemTime::now()));
    }

    /// Deletes the recovery file: every decision is saved or discarded.
    pub(super) fn clear(&self) {
        self.send(Task::Clear);
    }

    /// Finishes pending work and returns the state of the unsaved decisions; waits at most `limit`.
    /// After the window has ended, returns the state at its end.
    pub(super) fn flush(&self, limit: Duration) -> Remains {
        if let Some(remains) = self.at_end.get() {
            return remains.clone();
        }
        let (answer, answered) = channel();
        self.send(Task::Flush(answer));
        match answered.recv_timeout(limit) {
            Ok(remains) => remains,
            Err(_) => Remains::new(
                locked(&self.kept).clone(),
                Some("the disk did not respond".to_owned()),
            ),
        }
    }

    /// Finishes pending work, then ends the thread.
    pub(super) fn close(&self, limit: Duration) {
        self.at_end.get_or_init(|| self.flush(limit));
        self.send(Task::Close);
    }
}

/// Locks a mutex; the content is consistent even after a panic under the lock.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Decisions that are not yet in the recovery file.
struct Pending {
    unsaved: Box<Unsaved>,
    /// Time of the latest of these decisions.
    decided: SystemTime,
    due: Instant,
}

/// State of the recovery thread.
struct Keeper {
    folder: Option<PathBuf>,
    keep_after: Duration,
    replies: ReplySender,
    file: Option<RecoveryFile>,
    pending: Option<Pending>,
    kept: Arc<Mutex<Option<Kept>>>,
    restored: Vec<LostStudy>,
}

impl Keeper {
    /// Carries out tasks until the window closes.
    fn work(mut self, tasks: &Receiver<Task>) {
        loop {
            match tasks.recv_timeout(self.wait()) {
                Ok(Task::Keep(unsaved, decided)) => self.postpone(unsaved, decided),
                Ok(Task::Clear) => {
                    let cleared = self.clear();
                    self.report(cleared);
                }
                Ok(Task::Restored(lost)) => self.restored.push(lost),
                Ok(Task::Discard(lost)) => self.report(lost.remove()),
                Ok(Task::Flush(answer)) => {
                    let remains = self.flush();
                    // Ignore a failure: after a timeout, no one receives the reply.
                    let _ = answer.send(remains);
                }
                Err(RecvTimeoutError::Timeout) => {
                    let kept = self.keep();
                    self.report(kept);
                }
                Ok(Task::Close) | Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    /// Returns the time until the pending decisions are due.
    fn wait(&self) -> Duration {
        match &self.pending {
            Some(pending) => pending.due.saturating_duration_since(Instant::now()),
            None => NEVER,
        }
    }

    /// Replaces the pending decisions by newer ones; the time at which they are due does not
    /// change.
    fn postpone(&mut self, unsaved: Box<Unsaved>, decided: SystemTime) {
        let due = match &self.pending {
            Some(pending) => pending.due,
            None if self.folder.is_some() => Instant::now() + self.keep_after,
            None => Instant::now() + NEVER,
        };
        self.pending = Some(Pending {
            unsaved,
            decided,
            due,
        });
    }

    /// Deletes the recovery file, and those of restored decisions.
    fn clear(&mut self) -> Result<(), FileError> {
        self.pending = None;
        *locked(&self.kept) = None;
        if let Some(file) = &mut self.file {
            file.clear()?;
        }
        self.remove_restored()
    }

    /// Keeps the pending decisions now; returns the resulting state.
    fn flush(&mut self) -> Remains {
        let kept = self.keep();
        let trouble = match (&self.pending, &self.folder) {
            (None, _) => None,
            (Some(_), None) => Some("there is no directory in which to keep them".to_owned()),
            (Some(_), Some(_)) => kept.err().map(|error| error.to_string()),
        };
        Remains::new(locked(&self.kept).clone(), trouble)
    }

    /// Keeps the pending decisions; on an error, they remain pending for a retry.
    fn keep(&mut self) -> Result<(), FileError> {
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        let Some(pending) = self.pending.take() else {
            return Ok(());
        };
        match write_recovery(&pending.unsaved, &mut self.file, folder) {
            Ok(path) => {
                let at = pending.decided;
                *locked(&self.kept) = Some(Kept { path, at });
                self.remove_restored()
            }
            Err(error) => {
                let due = Instant::now() + AGAIN_AFTER;
                self.pending = Some(Pending { due, ..pending });
                Err(error)
            }
        }
    }

    /// Removes the recovery files of restored decisions, which have been kept anew or saved; stops
    /// at the first error.
    fn remove_restored(&mut self) -> Result<(), FileError> {
        for lost in self.restored.drain(..) {
            lost.remove()?;
        }
        Ok(())
    }

    fn report(&self, done: Result<(), FileError>) {
        if let Err(error) = done {
            let message = format!("unsaved decisions cannot be stored for recovery: {error}");
            self.replies.send(|app| app.notify_error(message));
        }
    }
}

/// Writes the recovery file and returns its path. The first call reserves the file name.
fn write_recovery(
    unsaved: &Unsaved,
    file: &mut Option<RecoveryFile>,
    folder: &Path,
) -> Result<PathBuf, FileError> {
    let file = match file {
        Some(file) => file,
        None => file.insert(RecoveryFile::claim(folder)?),
    };
    file.write(&unsaved.study, &unsaved.loaded, unsaved.saved_as.as_deref())?;
    Ok(file.path().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unsaved() -> Unsaved {
        let loaded = gdcm_io::embedded_example().unwrap();
        Unsaved {
            study: Study::new(Arc::clone(&loaded.dataset)),
            loaded,
            saved_as: None,
        }
    }

    fn start_autosave(directory: Option<&Path>) -> Autosave {
        Autosave::start(
            directory,
            NEVER,
            ReplySender::new(&egui::Context::default()).0,
        )
        .unwrap()
    }

    /// Timeout in tests, far longer than the slowest disk needs.
    const LONG: Duration = Duration::from_secs(600);

    #[test]
    fn decisions_kept_when_the_window_ended_are_not_reported_as_lost() {
        let directory = tempfile::tempdir().unwrap();
        let autosave = start_autosave(Some(directory.path()));
        autosave.keep(unsaved());
        // The window and its thread end with the display; the program then reports the state of the
        // decisions.
        autosave.clone().close(LONG);
        let Remains::Kept(kept) = autosave.flush(LONG) else {
            panic!("{:?}", autosave.flush(LONG))
        };
        assert!(kept.path.is_file() && gdcm_io::files::study_file::open_study(&kept.path).is_ok());
    }

    #[test]
    fn a_window_that_ends_without_decisions_or_without_a_directory_reports_it() {
        let directory = tempfile::tempdir().unwrap();
        let nothing = start_autosave(Some(directory.path()));
        nothing.close(LONG);
        assert_eq!(nothing.flush(LONG), Remains::Saved);
        let nowhere = start_autosave(None);
        nowhere.keep(unsaved());
        nowhere.close(LONG);
        assert!(matches!(nowhere.flush(LONG), Remains::Lost(_)));
    }

    #[test]
    fn the_decisions_kept_before_the_disk_failed_are_named() {
        let directory = tempfile::tempdir().unwrap();
        let autosave = start_autosave(Some(directory.path()));
        autosave.keep(unsaved());
        let Remains::Kept(first) = autosave.flush(LONG) else {
            panic!("the disk takes it")
        };
        // A folder at the path of the recovery file, so that no file can be written there.
        std::fs::remove_file(&first.path).unwrap();
        std::fs::create_dir(&first.path).unwrap();
        std::fs::write(first.path.join("in the way"), "").unwrap();
        autosave.keep(unsaved());
        autosave.close(LONG);
        assert!(matches!(autosave.flush(LONG), Remains::KeptInPart(kept, _) if kept == first));
    }
}
