//! Unsaved decisions: a thread keeps them in a recovery file, and the next start offers the
//! decisions of a window that ended without saving.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant, SystemTime};

use jiff::Timestamp;
use jiff::tz::TimeZone;

use gdcm_io::files::user_state::{LostStudy, RecoveryFile, lost_studies};
use gdcm_io::formats::variables::ReadingBudget;
use gdcm_io::{FileError, LoadedDataset, Opened, load_any};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_study::Study;

use super::GdcmApp;
use super::document_files::ReadFor;
use super::files::study_name;
use super::threads::ReplySender;
use crate::gui::state::notices::Bar;

/// Folder of the recovery files in the program's directory.
const FOLDER: &str = "recovery";
/// Delay before a retry after a failure, such as a full disk.
const AGAIN_AFTER: Duration = Duration::from_secs(10);
/// Waiting time if nothing is due.
const NEVER: Duration = Duration::from_secs(3600);

/// State to keep. All parts are shared, so a copy is cheap.
#[derive(Clone, Debug)]
pub(super) struct Unsaved {
    pub(super) study: Study,
    pub(super) loaded: LoadedDataset,
    pub(super) saved_as: Option<PathBuf>,
}

/// Decisions kept on the disk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    pub path: PathBuf,
    /// Time of the decisions in the file.
    pub at: SystemTime,
}

/// Fate of the unsaved decisions when the window ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remains {
    /// There are no unsaved decisions.
    Saved,
    /// All unsaved decisions are in the recovery file.
    Kept(Kept),
    /// Later decisions than these could not be kept; holds the reason.
    KeptInPart(Kept, String),
    /// No decisions could be kept; holds the reason.
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

/// Task of the recovery thread.
enum Task {
    /// Keep these decisions, taken at this time.
    Keep(Box<Unsaved>, SystemTime),
    /// Every decision is saved or discarded: nothing to recover.
    Clear,
    /// The lost decisions are open again: delete their file once they are kept anew or saved.
    Restored(LostStudy),
    /// Discard the lost decisions.
    Discard(LostStudy),
    /// Finish pending work now and report what remains.
    Flush(Sender<Remains>),
    /// Leave the kept decisions for the next start.
    Close,
}

/// Keeps unsaved decisions; without a directory, keeps none.
#[derive(Clone)]
pub struct Autosave {
    tasks: Sender<Task>,
    /// Decisions last kept; `None` once they are saved.
    kept: Arc<Mutex<Option<Kept>>>,
    /// State of the decisions when the window, and with it the thread, ended.
    at_end: Arc<OnceLock<Remains>>,
}

impl Autosave {
    /// Starts the thread, which first offers lost decisions.
    pub(super) fn start(
        directory: Option<&Path>,
        keep_after: Duration,
        replies: ReplySender,
    ) -> std::io::Result<Self> {
        let (tasks, to_do) = channel();
        let folder = directory.map(|directory| directory.join(FOLDER));
        let kept = Arc::<Mutex<Option<Kept>>>::default();
        let keeper_kept = Arc::clone(&kept);
        let work = move || {
            if let Some(lost) = folder.as_deref().map(lost_studies) {
                replies.send(move |app| app.offer(lost));
            }
            let file = None;
            let waits = None;
            let restored = Vec::new();
            Keeper {
                folder,
                keep_after,
                replies,
                file,
                waits,
                kept: keeper_kept,
                restored,
            }
            .work(&to_do);
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

    fn send(&self, task: Task) {
        // The thread ends with the window.
        let _ = self.tasks.send(task);
    }

    /// Keeps unsaved decisions; the newest reach the recovery file soon after the first change.
    pub(super) fn keep(&self, unsaved: Unsaved) {
        self.send(Task::Keep(Box::new(unsaved), SystemTime::now()));
    }

    /// Clears the kept decisions: every decision is saved or discarded.
    pub(super) fn clear(&self) {
        self.send(Task::Clear);
    }

    /// Finishes pending work and reports what remains; waits at most `limit`. After the window has
    /// ended, returns the state at its end.
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
                Some("the disk did not answer".to_owned()),
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

/// State of the recovery thread.
struct Keeper {
    folder: Option<PathBuf>,
    keep_after: Duration,
    replies: ReplySender,
    file: Option<RecoveryFile>,
    /// Pending state, with the time of the decisions and the time at which it is due.
    waits: Option<(Box<Unsaved>, SystemTime, Instant)>,
    kept: Arc<Mutex<Option<Kept>>>,
    restored: Vec<LostStudy>,
}

impl Keeper {
    fn work(mut self, to_do: &Receiver<Task>) {
        loop {
            let due = self.waits.as_ref().map_or(NEVER, |(_, _, due)| {
                due.saturating_duration_since(Instant::now())
            });
            match to_do.recv_timeout(due) {
                Ok(Task::Keep(unsaved, decided)) => {
                    let after = if self.folder.is_some() {
                        self.keep_after
                    } else {
                        NEVER
                    };
                    let due = self
                        .waits
                        .take()
                        .map_or_else(|| Instant::now() + after, |(_, _, due)| due);
                    self.waits = Some((unsaved, decided, due));
                }
                Ok(Task::Clear) => {
                    self.waits = None;
                    *locked(&self.kept) = None;
                    let cleared = self.file.as_mut().map_or(Ok(()), RecoveryFile::clear);
                    let removed = cleared.and_then(|()| self.remove_restored());
                    self.tell(removed);
                }
                Ok(Task::Restored(lost)) => self.restored.push(lost),
                Ok(Task::Discard(lost)) => self.tell(lost.remove()),
                Ok(Task::Flush(answer)) => {
                    let kept = self.keep();
                    let trouble = match (&self.waits, &self.folder) {
                        (None, _) => None,
                        (Some(_), None) => Some("there is no directory for them".to_owned()),
                        (Some(_), Some(_)) => kept.err().map(|error| error.to_string()),
                    };
                    // After a timeout nobody listens.
                    let _ = answer.send(Remains::new(locked(&self.kept).clone(), trouble));
                }
                Err(RecvTimeoutError::Timeout) => {
                    let kept = self.keep();
                    self.tell(kept);
                }
                Ok(Task::Close) | Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    /// Keeps the pending decisions; those that cannot be kept stay pending for a retry.
    fn keep(&mut self) -> Result<(), FileError> {
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        let Some((unsaved, decided, _)) = self.waits.take() else {
            return Ok(());
        };
        match keep(&unsaved, &mut self.file, folder) {
            Ok(path) => {
                *locked(&self.kept) = Some(Kept { path, at: decided });
                self.remove_restored()
            }
            Err(error) => {
                self.waits = Some((unsaved, decided, Instant::now() + AGAIN_AFTER));
                Err(error)
            }
        }
    }

    fn remove_restored(&mut self) -> Result<(), FileError> {
        self.restored.drain(..).try_for_each(LostStudy::remove)
    }

    fn tell(&self, done: Result<(), FileError>) {
        if let Err(error) = done {
            let words = format!("decisions that are not saved cannot be kept safe: {error}");
            self.replies.send(|app| app.notify_error(words));
        }
    }
}

fn keep(
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

/// How long a closing window waits for the disk to store the latest decisions.
pub(super) const LAST_WAIT: Duration = Duration::from_secs(2);

/// Protection against the loss of unsaved decisions.
pub(super) struct Recovery {
    pub(super) autosave: Autosave,
    /// Set once the window has drawn a frame; gives the caller that opened the window access to the
    /// autosave.
    pub(super) drawn: Arc<OnceLock<Autosave>>,
    /// Lost studies by the number of the offer, until restored or discarded.
    pub(super) offers: Vec<Option<LostStudy>>,
}

impl GdcmApp {
    /// Offers to restore lost decisions.
    fn offer(&mut self, lost: Vec<LostStudy>) {
        for lost in lost {
            let sentence = offer_words(&lost, &TimeZone::system());
            self.state.bars.push(Bar::Recovery {
                offer: self.recovery.offers.len(),
                sentence,
            });
            self.recovery.offers.push(Some(lost));
        }
    }

    /// Keeps unsaved decisions, or clears the kept ones once saved.
    pub(super) fn keep_unsaved(&self) {
        if self.state.unsaved {
            let study = self.state.study.clone();
            let loaded = self.files.loaded.clone();
            self.recovery.autosave.keep(Unsaved {
                study,
                loaded,
                saved_as: self.files.saved.path.clone(),
            });
        } else {
            self.recovery.autosave.clear();
        }
    }

    /// Opens lost decisions; the bar disappears once they are open.
    pub(super) fn restore(&mut self, offer: usize) {
        if let Some(Some(lost)) = self.recovery.offers.get(offer) {
            let path = lost.path().to_owned();
            let read = move |budget: &ReadingBudget<'_>| load_any(&path, budget);
            self.read(
                ReadFor::Restoring(offer),
                "decisions that were not saved".to_owned(),
                read,
            );
        }
    }

    /// Shows restored decisions, which are still unsaved.
    pub(super) fn show_restored(&mut self, offer: usize, opened: Opened) {
        let Some(lost) = self.recovery.offers.get_mut(offer).and_then(Option::take) else {
            return;
        };
        let words = format!(
            "restored the decisions of {}",
            when(lost.kept_at, &TimeZone::system())
        );
        let saved_as = lost.saved_as.clone();
        self.show(opened);
        self.state.study_name = study_name(saved_as.as_deref());
        self.files.saved.path = saved_as;
        self.files.saved.study = None;
        self.recovery.autosave.send(Task::Restored(lost));
        self.close_offer(offer);
        self.look_for_recent();
        self.study_changed();
        self.done(words);
    }

    pub(super) fn discard(&mut self, offer: usize) {
        if let Some(lost) = self.recovery.offers.get_mut(offer).and_then(Option::take) {
            self.recovery.autosave.send(Task::Discard(lost));
        }
        self.close_offer(offer);
    }

    fn close_offer(&mut self, closed: usize) {
        self.state
            .bars
            .retain(|bar| !matches!(bar, Bar::Recovery { offer, .. } if *offer == closed));
    }
}

/// "Decisions of 14:32 on 21 Nov 2026 for data.json.gz (study mine.gdcm-study.json) were not
/// saved."
fn offer_words(lost: &LostStudy, zone: &TimeZone) -> String {
    let study = lost.saved_as.as_ref().and_then(|path| path.file_name());
    let study = study.map_or(String::new(), |name| {
        format!(" (study {})", sanitized(&name.to_string_lossy()))
    });
    format!(
        "Decisions of {} for {}{study} were not saved.",
        when(lost.kept_at, zone),
        sanitized(&lost.dataset)
    )
}

/// "14:32 on 21 Nov 2026", in the given zone.
fn when(at: SystemTime, zone: &TimeZone) -> String {
    let at = Timestamp::try_from(at).unwrap_or(Timestamp::UNIX_EPOCH);
    at.to_zoned(zone.clone())
        .strftime("%H:%M on %-d %b %Y")
        .to_string()
}

/// Returns the message for standard error if the window itself fails.
pub(super) fn end_words(fault: &str, remains: &Remains) -> String {
    let fault = format!("stopped by a fault in its window: {fault}");
    let kept_words = |kept: &Kept| {
        let time = when(kept.at, &TimeZone::system());
        format!(
            "your decisions up to {time} are in {}",
            sanitized_path(&kept.path)
        )
    };
    match remains {
        Remains::Kept(kept) => format!("{fault}; {}", kept_words(kept)),
        Remains::Saved => format!("{fault}; every decision was saved"),
        Remains::KeptInPart(kept, why) => {
            format!("{fault}; {}, later ones are lost: {why}", kept_words(kept))
        }
        Remains::Lost(why) => format!("{fault}; the decisions that were not saved are lost: {why}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_is_that_of_the_clock_on_the_wall() {
        let at = SystemTime::UNIX_EPOCH + Duration::from_secs(1_795_271_520);
        assert_eq!(when(at, &TimeZone::UTC), "14:32 on 21 Nov 2026");
        assert_eq!(
            when(at, &TimeZone::fixed(jiff::tz::offset(1))),
            "15:32 on 21 Nov 2026"
        );
    }

    fn unsaved() -> Unsaved {
        let loaded = gdcm_io::embedded_example().unwrap();
        Unsaved {
            study: Study::new(Arc::clone(&loaded.dataset)),
            loaded,
            saved_as: None,
        }
    }

    fn autosave(directory: Option<&Path>) -> Autosave {
        Autosave::start(
            directory,
            NEVER,
            ReplySender::new(&egui::Context::default()).0,
        )
        .unwrap()
    }

    /// Far above the time that the slowest disk needs.
    const LONG: Duration = Duration::from_secs(600);

    #[test]
    fn decisions_that_were_kept_when_the_window_ended_are_not_said_to_be_lost() {
        let directory = tempfile::tempdir().unwrap();
        let autosave = autosave(Some(directory.path()));
        autosave.keep(unsaved());
        // The window and its thread end with the display; the program then reports what remains of
        // the decisions.
        autosave.clone().close(LONG);
        let Remains::Kept(kept) = autosave.flush(LONG) else {
            panic!("{:?}", autosave.flush(LONG))
        };
        assert!(kept.path.is_file() && gdcm_io::files::study_file::open_study(&kept.path).is_ok());
        let words = end_words("no display", &autosave.flush(LONG));
        assert!(
            words.contains(&*kept.path.to_string_lossy()) && !words.contains("lost"),
            "{words}"
        );
    }

    #[test]
    fn a_window_that_ends_without_decisions_or_without_a_directory_says_so() {
        let directory = tempfile::tempdir().unwrap();
        let nothing = autosave(Some(directory.path()));
        nothing.close(LONG);
        assert_eq!(nothing.flush(LONG), Remains::Saved);
        let nowhere = autosave(None);
        nowhere.keep(unsaved());
        nowhere.close(LONG);
        assert!(matches!(nowhere.flush(LONG), Remains::Lost(_)));
    }

    #[test]
    fn what_was_kept_before_the_disk_failed_is_named() {
        let directory = tempfile::tempdir().unwrap();
        let autosave = autosave(Some(directory.path()));
        autosave.keep(unsaved());
        let Remains::Kept(first) = autosave.flush(LONG) else {
            panic!("the disk takes it")
        };
        // A folder at the file's path: no file can be written there.
        std::fs::remove_file(&first.path).unwrap();
        std::fs::create_dir(&first.path).unwrap();
        std::fs::write(first.path.join("in the way"), "").unwrap();
        autosave.keep(unsaved());
        autosave.close(LONG);
        assert!(matches!(autosave.flush(LONG), Remains::KeptInPart(kept, _) if kept == first));
    }

    #[test]
    fn the_last_words_name_the_fault_its_place_and_the_recovery_file() {
        let fault = "out of range at src/view/centre.rs:7";
        let kept = Kept {
            path: "/data/recovery/7-1.gdcm-study.json".into(),
            at: SystemTime::UNIX_EPOCH,
        };
        let words = end_words(fault, &Remains::Kept(kept));
        assert!(
            words.starts_with(
                "stopped by a fault in its window: out of range at src/view/centre.rs:7;"
            ),
            "{words}"
        );
        assert!(
            words.ends_with("1970 are in /data/recovery/7-1.gdcm-study.json"),
            "{words}"
        );
        assert!(end_words(fault, &Remains::Saved).ends_with("; every decision was saved"));
    }
}
