//! Recovery of unsaved decisions: the window's handle to the thread that keeps them in a recovery
//! file.
//!
//! [`Autosave`] sends tasks to the thread, whose state is the [`Keeper`] in `autosave/keeper.rs`.
//! `recovery.rs` offers the kept decisions at the next start.
//!
//! | decisions | meaning |
//! |---|---|
//! | unsaved | made since the study was last saved; [`Remains`] says where they are |
//! | kept | in this window's recovery file ([`Kept`]) |
//! | lost | in the recovery file of an earlier window, which ended without saving ([`LostStudy`]) |
//! | restored | lost, and now open again in this window |

mod keeper;

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, SystemTime};

use gdcm_io::LoadedDataset;
use gdcm_io::files::recovery_file::{LostStudy, lost_studies};
use gdcm_study::Study;

use self::keeper::Keeper;
use super::threads::ReplySender;

/// Folder for recovery files in the program's directory.
const FOLDER: &str = "recovery";
/// Waiting time if no work is pending: long, because any task ends the wait.
const IDLE_WAIT: Duration = Duration::from_secs(3600);

/// Decisions to keep. Study and dataset are shared, so a copy is cheap.
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

/// Where unsaved decisions are when the window ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remains {
    /// There are no unsaved decisions.
    Saved,
    /// All unsaved decisions are in the recovery file.
    Kept(Kept),
    /// Some decisions are in the recovery file; later ones are not, for the given reason.
    KeptInPart(Kept, String),
    /// Unsaved decisions could not be kept, for the given reason.
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
    /// Delete these lost decisions' recovery file.
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
    /// Decisions most recently kept; `None` once they are saved or discarded.
    kept: Arc<Mutex<Option<Kept>>>,
    /// State of the unsaved decisions when the window ended; empty before.
    at_end: Arc<OnceLock<Remains>>,
}

impl Autosave {
    /// Starts the thread, which first offers the unsaved decisions of windows that ended without
    /// being closed by the user; without a directory, there are none.
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
            let keeper = Keeper::new(folder, keep_after, replies, keeper_kept);
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

    /// Passes unsaved decisions to the thread, which writes the newest ones to the recovery file a
    /// fixed time (`keep_after`) after the first that it has not yet written.
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

    /// Finishes pending work, for which it waits at most `limit`, records the resulting state for
    /// [`Self::flush`], then ends the thread.
    pub(super) fn close(&self, limit: Duration) {
        self.at_end.get_or_init(|| self.flush(limit));
        self.send(Task::Close);
    }
}

/// Locks a mutex; the content is consistent even after a panic under the lock.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
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
            IDLE_WAIT,
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
