//! Recovery thread: writes unsaved decisions after a delay, and deletes files that are no longer
//! needed.
//!
//! Decisions first wait as pending, so that a drag does not write the file at each step; the oldest
//! pending decision sets the time at which the newest are written. After an error they remain
//! pending for a retry. A *lost study* is the recovery file of an earlier window; once it is open
//! again, it is *restored*.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant, SystemTime};

use gdcm_io::FileError;
use gdcm_io::files::recovery_file::{LostStudy, RecoveryFile};

use super::super::threads::ReplySender;
use super::{IDLE_WAIT, Kept, Remains, Task, Unsaved, locked};
use crate::message::Message;

/// Delay before a retry after a failure, such as a full disk.
const AGAIN_AFTER: Duration = Duration::from_secs(10);

/// Decisions that are not yet in the recovery file.
struct Pending {
    unsaved: Box<Unsaved>,
    /// Time of the latest pending decision.
    decided: SystemTime,
    due: Instant,
}

/// State of the recovery thread: the pending decisions, and the files that it has written or is to
/// delete.
pub(super) struct Keeper {
    /// Folder for recovery files; with `None`, decisions remain pending.
    folder: Option<PathBuf>,
    /// Time between the first pending decision and the writing.
    keep_after: Duration,
    replies: ReplySender,
    /// This window's file, named at the first writing.
    file: Option<RecoveryFile>,
    pending: Option<Pending>,
    /// Decisions in the file, shared with the window.
    kept: Arc<Mutex<Option<Kept>>>,
    /// Lost studies that are open again, whose old files are still to be deleted.
    restored: Vec<LostStudy>,
}

impl Keeper {
    /// Creates the state without pending decisions. `kept` tells the window which decisions are in
    /// the recovery file.
    pub(super) fn new(
        folder: Option<PathBuf>,
        keep_after: Duration,
        replies: ReplySender,
        kept: Arc<Mutex<Option<Kept>>>,
    ) -> Self {
        Self {
            folder,
            keep_after,
            replies,
            file: None,
            pending: None,
            kept,
            restored: Vec::new(),
        }
    }

    /// Carries out tasks, and writes pending decisions when they are due, until the window closes.
    pub(super) fn work(mut self, tasks: &Receiver<Task>) {
        loop {
            match tasks.recv_timeout(self.wait()) {
                Ok(Task::Keep(unsaved, decided)) => self.postpone(unsaved, decided),
                Ok(Task::Clear) => {
                    let cleared = self.clear();
                    self.report_deletion(cleared);
                }
                Ok(Task::Restored(lost)) => self.restored.push(lost),
                Ok(Task::Discard(lost)) => self.report_deletion(lost.remove()),
                Ok(Task::Flush(answer)) => {
                    let remains = self.flush();
                    // Ignore a failure: after a timeout, no one receives the reply.
                    let _ = answer.send(remains);
                }
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(failure) = self.keep() {
                        self.report(&failure);
                    }
                }
                Ok(Task::Close) | Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    /// Returns the time until the pending decisions are due; [`IDLE_WAIT`] if there are none.
    fn wait(&self) -> Duration {
        match &self.pending {
            Some(pending) => pending.due.saturating_duration_since(Instant::now()),
            None => IDLE_WAIT,
        }
    }

    /// Replaces the pending decisions by newer ones, due at the same time. If none are pending, the
    /// new ones are due after `keep_after`; without a folder, where they cannot be written, after
    /// [`IDLE_WAIT`].
    fn postpone(&mut self, unsaved: Box<Unsaved>, decided: SystemTime) {
        let due = match &self.pending {
            Some(pending) => pending.due,
            None if self.folder.is_some() => Instant::now() + self.keep_after,
            None => Instant::now() + IDLE_WAIT,
        };
        self.pending = Some(Pending {
            unsaved,
            decided,
            due,
        });
    }

    /// Drops the pending decisions; deletes this window's recovery file, and those with restored
    /// decisions.
    fn clear(&mut self) -> Result<(), FileError> {
        self.pending = None;
        *locked(&self.kept) = None;
        if let Some(file) = &mut self.file {
            file.clear()?;
        }
        self.remove_restored()
    }

    /// Writes the pending decisions now; returns the resulting state.
    fn flush(&mut self) -> Remains {
        let kept = self.keep();
        let trouble = match (&self.pending, &self.folder) {
            (None, _) => None,
            (Some(_), None) => Some("the program has no directory for recovery files".to_owned()),
            (Some(_), Some(_)) => kept.err().map(|failure| failure.error().to_string()),
        };
        Remains::new(locked(&self.kept).clone(), trouble)
    }

    /// Writes the pending decisions, then deletes the old files of restored ones; does nothing
    /// without pending decisions or without a folder. Decisions that cannot be written remain
    /// pending for a retry.
    fn keep(&mut self) -> Result<(), KeepFailure> {
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
                self.remove_restored().map_err(KeepFailure::Deletion)
            }
            Err(error) => {
                let due = Instant::now() + AGAIN_AFTER;
                self.pending = Some(Pending { due, ..pending });
                Err(KeepFailure::Writing(error))
            }
        }
    }

    /// Removes the recovery files of restored decisions, which have been kept anew or saved.
    ///
    /// # Errors
    /// The first file that cannot be removed; the others are removed nevertheless.
    fn remove_restored(&mut self) -> Result<(), FileError> {
        let mut removed = Ok(());
        for lost in self.restored.drain(..) {
            removed = removed.and(lost.remove());
        }
        removed
    }

    fn report_deletion(&self, deleted: Result<(), FileError>) {
        if let Err(error) = deleted {
            self.report(&KeepFailure::Deletion(error));
        }
    }

    fn report(&self, failure: &KeepFailure) {
        let message = Message::new(failure.code(), failure.words());
        self.replies.send(|app| app.notify_error(message));
    }
}

/// Failure in the recovery thread.
enum KeepFailure {
    /// The decisions are not in the recovery file.
    Writing(FileError),
    /// A recovery file that is no longer needed remains.
    Deletion(FileError),
}

impl KeepFailure {
    fn error(&self) -> &FileError {
        let (Self::Writing(error) | Self::Deletion(error)) = self;
        error
    }

    fn code(&self) -> &'static str {
        match self {
            Self::Writing(_) => "recovery-not-stored",
            Self::Deletion(_) => "recovery-not-deleted",
        }
    }

    fn words(&self) -> String {
        match self {
            Self::Writing(error) => {
                format!("unsaved decisions cannot be stored for recovery ({error}); save the study")
            }
            Self::Deletion(error) => format!("the recovery file cannot be deleted: {error}"),
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
