//! Decisions that are not saved: a thread keeps them in a recovery file, and what a window lost that ended without saving is offered
//! at the next start.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use gdcm_core::message_text::{sanitized, sanitized_path};
use gdcm_core::study::Study;
use gdcm_files::{FileError, LoadedDataset, LostStudy, Opened, RecoveryFile, lost_studies, open_study};
use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::files::{ReadFor, study_name};
use super::threads::{Mailbox, ReplySender};
use super::window::GdcmApp;
use crate::view::bars::Bar;

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
struct Orders {
    task: Option<Task>,
    /// To be removed once the decisions restored from them are kept anew, or saved.
    restored: Vec<LostStudy>,
    /// To be removed at once.
    discarded: Vec<LostStudy>,
    kept: Option<Kept>,
    failure: Option<FileError>,
    busy: bool,
    hurried: bool,
    closed: bool,
}

/// Keeps decisions that are not saved. Without a directory it has nowhere to.
#[derive(Clone)]
pub struct Autosave {
    orders: Arc<Mailbox<Orders>>,
    has_thread: bool,
    keep_after: Duration,
}

impl Autosave {
    /// Starts the thread, which first offers what was lost.
    pub(super) fn start(directory: Option<&Path>, keep_after: Duration, replies: ReplySender) -> std::io::Result<Self> {
        let orders = Arc::<Mailbox<Orders>>::default();
        let Some(directory) = directory else { return Ok(Self { orders, has_thread: false, keep_after }) };
        let (of_thread, folder) = (Arc::clone(&orders), directory.join(FOLDER));
        let work = move || {
            let lost = lost_studies(&folder);
            replies.send(move |app| app.offer(lost));
            work(&of_thread, &folder, &replies);
        };
        std::thread::Builder::new().name("autosave".to_owned()).spawn(work)?;
        Ok(Self { orders, has_thread: true, keep_after })
    }

    /// These decisions are not saved: the newest are in the recovery file soon after the first.
    pub(super) fn keep(&self, unsaved: Unsaved) {
        self.orders.change(|orders| {
            let due = match &orders.task {
                Some(Task::Keep { due, .. }) => *due,
                _ => Instant::now() + self.keep_after,
            };
            orders.task = Some(Task::Keep { unsaved: Box::new(unsaved), decided: SystemTime::now(), due });
        });
    }

    /// Every decision is saved, or not wanted: there is nothing to recover.
    pub(super) fn clear(&self) {
        self.orders.change(|orders| orders.task = Some(Task::Clear));
    }

    /// The lost decisions are open again: their file goes as soon as they are kept anew, or saved.
    pub(super) fn restored(&self, lost: LostStudy) {
        self.orders.lock().restored.push(lost);
    }

    /// The lost decisions are not wanted.
    pub(super) fn discard(&self, lost: LostStudy) {
        self.orders.change(|orders| orders.discarded.push(lost));
    }

    /// Why decisions could not be kept, if that was not taken yet.
    pub(super) fn failure(&self) -> Option<FileError> {
        self.orders.lock().failure.take()
    }

    /// Does what waits now, and says what is kept after it, or why it is not; gives up waiting after `limit`.
    pub(super) fn flush(&self, limit: Duration) -> Result<Option<Kept>, String> {
        if !self.has_thread {
            let lost = matches!(self.orders.lock().task, Some(Task::Keep { .. }));
            return if lost { Err("there is no directory for them".to_owned()) } else { Ok(None) };
        }
        self.orders.change(|orders| orders.hurried = true);
        let (is_done, mut orders) = self.orders.wait_at_most(limit, |orders| orders.task.is_none() && !orders.busy);
        orders.hurried = false;
        match orders.failure.take() {
            Some(error) => Err(error.to_string()),
            None if !is_done => Err("the disk did not answer".to_owned()),
            None => Ok(orders.kept.clone()),
        }
    }

    /// Does what waits, then ends the thread: what is kept now stays for the next start.
    pub(super) fn close(&self, limit: Duration) {
        // Nobody is left to be told.
        let _ = self.flush(limit);
        self.orders.change(|orders| orders.closed = true);
    }
}

fn work(all: &Mailbox<Orders>, folder: &Path, replies: &ReplySender) {
    let mut file = None;
    loop {
        let mut orders = all.lock();
        let discarded = std::mem::take(&mut orders.discarded);
        let task = due_task(&mut orders);
        if task.is_none() && discarded.is_empty() {
            if orders.closed {
                return;
            }
            let due = match &orders.task {
                Some(Task::Keep { due, .. }) => due.saturating_duration_since(Instant::now()),
                _ => Duration::from_secs(3600),
            };
            all.pause(orders, due);
            continue;
        }
        orders.busy = true;
        drop(orders);
        let removed = discarded.into_iter().try_for_each(LostStudy::remove);
        let outcome = task.as_ref().map(|task| carry_out(task, &mut file, folder));
        let mut orders = all.lock();
        orders.busy = false;
        orders.failure = removed.err().or_else(|| orders.failure.take());
        match (outcome, task) {
            (Some(Ok(kept)), _) => {
                orders.kept = kept;
                let restored = std::mem::take(&mut orders.restored);
                orders.discarded.extend(restored);
            }
            (Some(Err(error)), task) => {
                orders.failure = Some(error);
                let again = task.filter(|_| !orders.hurried && !orders.closed).and_then(Task::again);
                orders.task = orders.task.take().or(again);
            }
            (None, _) => {}
        }
        let failed = orders.failure.is_some();
        drop(orders);
        all.change(|_| ());
        if failed {
            replies.send(|app| app.tell_not_kept());
        }
    }
}

/// The task that waits, if its time has come.
fn due_task(orders: &mut Orders) -> Option<Task> {
    let hurried = orders.hurried || orders.closed;
    orders.task.take_if(|task| match task {
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

/// How long a window that ends waits for the disk to take what was decided last.
pub(super) const LAST_WAIT: Duration = Duration::from_secs(2);

impl GdcmApp {
    /// Offers what was lost.
    fn offer(&mut self, lost: Vec<LostStudy>) {
        for lost in lost {
            let sentence = offer_words(&lost, &TimeZone::system());
            self.state.bars.push(Bar::Recovery { offer: self.offers.len(), sentence });
            self.offers.push(Some(lost));
        }
    }

    /// Says why decisions are not kept, unless that was taken already.
    fn tell_not_kept(&mut self) {
        if let Some(error) = self.autosave.failure() {
            self.notify_error(format!("decisions that are not saved cannot be kept safe: {error}"));
        }
    }

    /// Keeps what is not saved, or forgets what is.
    pub(super) fn keep_unsaved(&self) {
        if self.state.unsaved {
            let (study, loaded) = (self.state.study.clone(), self.loaded.clone());
            self.autosave.keep(Unsaved { study, loaded, saved_as: self.saved.path.clone() });
        } else {
            self.autosave.clear();
        }
    }

    /// Opens what was lost; the bar goes once it is open.
    pub(super) fn restore(&mut self, offer: usize) {
        if let Some(Some(lost)) = self.offers.get(offer) {
            let path = lost.path().to_owned();
            let read = move || Ok(Opened::Study(open_study(&path)?));
            self.read(ReadFor::Restoring(offer), "decisions that were not saved".to_owned(), read);
        }
    }

    /// Shows what was lost, not saved still.
    pub(super) fn show_restored(&mut self, offer: usize, opened: Opened) {
        let Some(lost) = self.offers.get_mut(offer).and_then(Option::take) else { return };
        let words = format!("restored the decisions of {}", when(lost.kept_at, &TimeZone::system()));
        let saved_as = lost.saved_as.clone();
        self.show(opened);
        self.state.study_name = study_name(saved_as.as_deref());
        self.saved.path = saved_as;
        self.saved.study = None;
        self.autosave.restored(lost);
        self.close_offer(offer);
        self.look_for_recent();
        self.study_changed();
        self.done(words);
    }

    pub(super) fn discard(&mut self, offer: usize) {
        if let Some(lost) = self.offers.get_mut(offer).and_then(Option::take) {
            self.autosave.discard(lost);
        }
        self.close_offer(offer);
    }

    fn close_offer(&mut self, closed: usize) {
        self.state.bars.retain(|bar| !matches!(bar, Bar::Recovery { offer, .. } if *offer == closed));
    }
}

/// "Decisions of 14:32 on 21 Nov 2026 for data.json.gz (study mine.gdcm-study.json) were not saved."
fn offer_words(lost: &LostStudy, zone: &TimeZone) -> String {
    let study = lost.saved_as.as_ref().and_then(|path| path.file_name());
    let study = study.map_or(String::new(), |name| format!(" (study {})", sanitized(&name.to_string_lossy())));
    format!("Decisions of {} for {}{study} were not saved.", when(lost.kept_at, zone), sanitized(&lost.dataset))
}

/// "14:32 on 21 Nov 2026", in the given zone.
fn when(at: SystemTime, zone: &TimeZone) -> String {
    let at = Timestamp::try_from(at).unwrap_or(Timestamp::UNIX_EPOCH);
    at.to_zoned(zone.clone()).strftime("%H:%M on %-d %b %Y").to_string()
}

/// What is said on standard error when the window itself fails.
pub(super) fn end_words(fault: &str, kept: &Result<Option<Kept>, String>) -> String {
    let fault = format!("stopped by a fault in its window: {fault}");
    match kept {
        Ok(Some(Kept { path, at })) => {
            let time = when(*at, &TimeZone::system());
            format!("{fault}; your decisions up to {time} are in {}", sanitized_path(path))
        }
        Ok(None) => format!("{fault}; every decision was saved"),
        Err(why) => format!("{fault}; the decisions that were not saved are lost: {why}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_is_that_of_the_clock_on_the_wall() {
        let at = SystemTime::UNIX_EPOCH + Duration::from_secs(1_795_271_520);
        assert_eq!(when(at, &TimeZone::UTC), "14:32 on 21 Nov 2026");
        assert_eq!(when(at, &TimeZone::fixed(jiff::tz::offset(1))), "15:32 on 21 Nov 2026");
    }

    #[test]
    fn the_last_words_name_the_fault_its_place_and_the_recovery_file() {
        let fault = "out of range at src/view/centre.rs:7";
        let kept = Kept { path: "/data/recovery/7-1.gdcm-study.json".into(), at: SystemTime::UNIX_EPOCH };
        let words = end_words(fault, &Ok(Some(kept)));
        assert!(
            words.starts_with("stopped by a fault in its window: out of range at src/view/centre.rs:7;"),
            "{words}"
        );
        assert!(words.ends_with("1970 are in /data/recovery/7-1.gdcm-study.json"), "{words}");
        assert!(end_words(fault, &Ok(None)).ends_with("; every decision was saved"));
    }
}
