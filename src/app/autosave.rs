//! The thread that keeps decisions that are not saved in a recovery file.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime};

use gdcm_core::study::Study;
use gdcm_files::{FileError, LoadedDataset, LostStudy, RecoveryFile, lost_studies};

/// Folder of the recovery files in the program's directory.
const FOLDER: &str = "recovery";
/// How long after a failure (a full disk) it is tried again.
const AGAIN_AFTER: Duration = Duration::from_secs(10);

/// What is to be kept. All of it is shared, so that it costs next to nothing.
#[derive(Clone, Debug)]
pub(super) struct Unsaved {
    pub(super) study: Study,
    pub(super) loaded: LoadedDataset,
    /// The study's own file.
    pub(super) saved_as: Option<PathBuf>,
}

/// What is kept on the disk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    /// The recovery file.
    pub path: PathBuf,
    /// When the decisions in it were taken.
    pub at: SystemTime,
}

/// What waits to be done on the disk.
enum Task {
    Keep { unsaved: Box<Unsaved>, decided: SystemTime, due: Instant },
    Clear,
}

impl Task {
    /// What is to be tried again after a failure. A file that cannot be removed is offered at the next start.
    fn again(self) -> Option<Task> {
        match self {
            Task::Keep { unsaved, decided, .. } => {
                Some(Task::Keep { unsaved, decided, due: Instant::now() + AGAIN_AFTER })
            }
            Task::Clear => None,
        }
    }
}

#[derive(Default)]
struct Mailbox {
    task: Option<Task>,
    /// To be removed once the decisions restored from them are kept anew, or saved.
    restored: Vec<LostStudy>,
    /// To be removed at once.
    discarded: Vec<LostStudy>,
    /// To be offered, until the window takes them.
    offers: Vec<LostStudy>,
    kept: Option<Kept>,
    failure: Option<FileError>,
    busy: bool,
    hurried: bool,
    closed: bool,
}

#[derive(Default)]
struct Shared {
    mailbox: Mutex<Mailbox>,
    changed: Condvar,
}

impl Shared {
    fn mailbox(&self) -> MutexGuard<'_, Mailbox> {
        // A panic while the lock was held leaves a mailbox that is still whole.
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Keeps decisions that are not saved. Without a directory it has nowhere to.
#[derive(Clone)]
pub struct Autosave {
    shared: Arc<Shared>,
    has_thread: bool,
    keep_after: Duration,
}

impl Autosave {
    /// Starts the thread; `wake` is called when there is something to offer or to tell.
    pub(super) fn start(
        directory: Option<&Path>,
        keep_after: Duration,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let Some(directory) = directory else { return Ok(Self { shared, has_thread: false, keep_after }) };
        let (of_thread, folder) = (Arc::clone(&shared), directory.join(FOLDER));
        let work = move || {
            of_thread.mailbox().offers = lost_studies(&folder);
            wake();
            work(&of_thread, &folder, &wake);
        };
        std::thread::Builder::new().name("autosave".to_owned()).spawn(work)?;
        Ok(Self { shared, has_thread: true, keep_after })
    }

    /// These decisions are not saved: the newest are in the recovery file soon after the first.
    pub(super) fn keep(&self, unsaved: Unsaved) {
        let mut mailbox = self.shared.mailbox();
        let due = match &mailbox.task {
            Some(Task::Keep { due, .. }) => *due,
            _ => Instant::now() + self.keep_after,
        };
        mailbox.task = Some(Task::Keep { unsaved: Box::new(unsaved), decided: SystemTime::now(), due });
        self.shared.changed.notify_all();
    }

    /// Every decision is saved, or not wanted: there is nothing to recover.
    pub(super) fn clear(&self) {
        self.shared.mailbox().task = Some(Task::Clear);
        self.shared.changed.notify_all();
    }

    /// The lost decisions are open again: their file goes as soon as they are kept anew, or saved.
    pub(super) fn restored(&self, lost: LostStudy) {
        self.shared.mailbox().restored.push(lost);
    }

    /// The lost decisions are not wanted.
    pub(super) fn discard(&self, lost: LostStudy) {
        self.shared.mailbox().discarded.push(lost);
        self.shared.changed.notify_all();
    }

    /// What can be offered for recovery and was not taken yet.
    pub(super) fn offers(&self) -> Vec<LostStudy> {
        std::mem::take(&mut self.shared.mailbox().offers)
    }

    /// Why decisions could not be kept, if that was not taken yet.
    pub(super) fn failure(&self) -> Option<FileError> {
        self.shared.mailbox().failure.take()
    }

    /// Does what waits now, and says what is kept after it, or why it is not; gives up waiting after `limit`.
    pub(super) fn flush(&self, limit: Duration) -> Result<Option<Kept>, String> {
        let mut mailbox = self.shared.mailbox();
        let still_busy = |mailbox: &mut Mailbox| mailbox.task.is_some() || mailbox.busy;
        if !self.has_thread {
            let lost = matches!(mailbox.task, Some(Task::Keep { .. }));
            return if lost { Err("there is no directory for them".to_owned()) } else { Ok(None) };
        }
        mailbox.hurried = true;
        self.shared.changed.notify_all();
        let waited = self.shared.changed.wait_timeout_while(mailbox, limit, still_busy);
        let (mut mailbox, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        mailbox.hurried = false;
        match mailbox.failure.take() {
            Some(error) => Err(error.to_string()),
            None if timeout.timed_out() => Err("the disk did not answer".to_owned()),
            None => Ok(mailbox.kept.clone()),
        }
    }

    /// Does what waits, then ends the thread: what is kept now stays for the next start.
    pub(super) fn close(&self, limit: Duration) {
        // Nobody is left to be told.
        let _ = self.flush(limit);
        self.shared.mailbox().closed = true;
        self.shared.changed.notify_all();
    }
}

fn work(shared: &Shared, folder: &Path, wake: &dyn Fn()) {
    let mut file = None;
    loop {
        let mut mailbox = shared.mailbox();
        let discarded = std::mem::take(&mut mailbox.discarded);
        let task = due_task(&mut mailbox);
        if task.is_none() && discarded.is_empty() {
            if mailbox.closed {
                return;
            }
            let due = match &mailbox.task {
                Some(Task::Keep { due, .. }) => due.saturating_duration_since(Instant::now()),
                _ => Duration::from_secs(3600),
            };
            drop(shared.changed.wait_timeout(mailbox, due));
            continue;
        }
        mailbox.busy = true;
        drop(mailbox);
        let removed = discarded.into_iter().try_for_each(LostStudy::remove);
        let outcome = task.as_ref().map(|task| carry_out(task, &mut file, folder));
        let mut mailbox = shared.mailbox();
        mailbox.busy = false;
        mailbox.failure = removed.err().or_else(|| mailbox.failure.take());
        match (outcome, task) {
            (Some(Ok(kept)), _) => {
                mailbox.kept = kept;
                let restored = std::mem::take(&mut mailbox.restored);
                mailbox.discarded.extend(restored);
            }
            (Some(Err(error)), task) => {
                mailbox.failure = Some(error);
                let again = task.filter(|_| !mailbox.hurried && !mailbox.closed).and_then(Task::again);
                mailbox.task = mailbox.task.take().or(again);
            }
            (None, _) => {}
        }
        let failed = mailbox.failure.is_some();
        drop(mailbox);
        shared.changed.notify_all();
        if failed {
            wake();
        }
    }
}

/// The task that waits, if its time has come.
fn due_task(mailbox: &mut Mailbox) -> Option<Task> {
    let hurried = mailbox.hurried || mailbox.closed;
    mailbox.task.take_if(|task| match task {
        Task::Keep { due, .. } => hurried || Instant::now() >= *due,
        Task::Clear => true,
    })
}

/// What is kept after the task.
fn carry_out(task: &Task, file: &mut Option<RecoveryFile>, folder: &Path) -> Result<Option<Kept>, FileError> {
    match task {
        Task::Clear => file.as_mut().map_or(Ok(()), RecoveryFile::clear).map(|()| None),
        Task::Keep { unsaved, decided, .. } => {
            keep(unsaved, file, folder).map(|path| Some(Kept { path, at: *decided }))
        }
    }
}

fn keep(unsaved: &Unsaved, file: &mut Option<RecoveryFile>, folder: &Path) -> Result<PathBuf, FileError> {
    let file = match file {
        Some(file) => file,
        None => file.insert(RecoveryFile::claim(folder)?),
    };
    file.write(&unsaved.study, &unsaved.loaded, unsaved.saved_as.as_deref())?;
    Ok(file.path().to_owned())
}
