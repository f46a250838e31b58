//! What the window and its threads share: mailboxes, replies, panics, kept and put into words in place of a raw trace; and the threads
//! that read for the window, of which only the newest of one purpose count, and which can be stopped.

use std::any::Any;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use egui::Context;

use gdcm_io::FolderProgress;

use super::GdcmApp;

/// What a thread waits for: whoever changes it wakes the thread.
#[derive(Default)]
pub(super) struct Mailbox<T> {
    content: Mutex<T>,
    changed: Condvar,
}

impl<T> Mailbox<T> {
    pub(super) fn new(content: T) -> Self {
        Self {
            content: Mutex::new(content),
            changed: Condvar::new(),
        }
    }

    /// To look at it.
    pub(super) fn lock(&self) -> MutexGuard<'_, T> {
        // A panic while the lock was held leaves a content that is still whole.
        self.content.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// To change it: every thread that waits looks at it once more.
    pub(super) fn change<R>(&self, change: impl FnOnce(&mut T) -> R) -> R {
        let changed = change(&mut self.lock());
        self.changed.notify_all();
        changed
    }

    /// Waits until `take` makes something of it.
    pub(super) fn wait<R>(&self, mut take: impl FnMut(&mut T) -> Option<R>) -> R {
        let mut content = self.lock();
        loop {
            if let Some(taken) = take(&mut content) {
                return taken;
            }
            content = self
                .changed
                .wait(content)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// What a thread has the window do with what it made.
pub(super) type Reply = Box<dyn FnOnce(&mut GdcmApp) + Send>;

/// Where threads send their replies; the window wakes for each.
#[derive(Clone)]
pub(super) struct ReplySender {
    sender: Sender<Reply>,
    ctx: Context,
}

impl ReplySender {
    pub(super) fn new(ctx: &Context) -> (Self, Receiver<Reply>) {
        let (sender, receiver) = channel();
        (
            Self {
                sender,
                ctx: ctx.clone(),
            },
            receiver,
        )
    }

    pub(super) fn send(&self, reply: impl FnOnce(&mut GdcmApp) + Send + 'static) {
        // The window is gone when nobody listens; the threads end soon after.
        let _ = self.sender.send(Box::new(reply));
        self.ctx.request_repaint();
    }
}

impl GdcmApp {
    /// Does `work`, called `what`, in a thread of its own, and has the window take what comes of it: nothing where that was a fault, or
    /// no thread was to be had, which is told before.
    pub(super) fn in_thread<T: Send + 'static, Work, Take>(
        &self,
        what: &'static str,
        work: Work,
        take: Take,
    ) where
        Work: FnOnce() -> T + Send + 'static,
        Take: FnOnce(&mut Self, Option<T>) + Send + 'static,
    {
        // What the thread is to do follows once there is one.
        let (order, ordered) = channel::<(Work, Take)>();
        let replies = self.replies.clone();
        let thread = move || {
            let Ok((work, take)) = ordered.recv() else {
                return;
            };
            let made = caught(work);
            replies.send(move |app| {
                made.as_ref()
                    .err()
                    .iter()
                    .for_each(|fault| app.tell_fault(what, fault));
                take(app, made.ok());
            });
        };
        match std::thread::Builder::new()
            .name(what.to_owned())
            .spawn(thread)
        {
            Ok(_) => drop(order.send((work, take))),
            Err(error) => self.replies.send(move |app| {
                app.notify_error(format!("{what} cannot begin: {error}"));
                take(app, None);
            }),
        }
    }

    /// Stops what is told of beside it: the reading of files, or else what is being computed.
    pub(super) fn stop_work(&mut self) {
        let opening = self.state.opening.take();
        let records = self.state.records.reading.take();
        let Some(name) = opening.or_else(|| records.clone()) else {
            return self.stop_jobs();
        };
        self.opener.give_up();
        self.record_reader.give_up();
        if records.is_some() {
            // What was looked for is not looked for again by itself.
            self.records_of(self.state.condition().id());
        }
        self.done(format!("stopped reading {name}; what was open stays"));
    }
}

/// The newest thread that reads for one purpose, or several beside one another.
#[derive(Default)]
pub(super) struct Reader {
    newest: u64,
    stop: Arc<AtomicBool>,
}

impl Reader {
    /// Begins to read in place of what was being read: the number of the thread, and what ends it.
    pub(super) fn begin(&mut self) -> (u64, Arc<AtomicBool>) {
        self.give_up();
        self.stop = Arc::default();
        (self.newest, Arc::clone(&self.stop))
    }

    /// Begins to read beside what is being read: the number of these threads, and what ends them all.
    pub(super) fn join(&mut self) -> (u64, Arc<AtomicBool>) {
        if self.is_stopped() {
            return self.begin();
        }
        (self.newest, Arc::clone(&self.stop))
    }

    /// Whether the answer of this thread still counts.
    pub(super) fn is_newest(&self, number: u64) -> bool {
        self.newest == number
    }

    /// Ends the reading; what was read until then counts.
    pub(super) fn stop(&self) {
        self.stop.store(true, Ordering::Release);
    }

    /// Whether the reading was ended by hand.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }

    /// Ends the reading, whose answer counts no more, however long a drive keeps the thread waiting.
    pub(super) fn give_up(&mut self) {
        self.stop();
        self.newest += 1;
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Reads without telling how far it is, until it is stopped.
pub(super) struct Untold(pub(super) Arc<AtomicBool>);

impl FolderProgress for Untold {
    fn reading(&self, _: usize, _: usize, _: &str) {}

    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }
}

/// A panic: what it said, and where in the program's source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Its message, on one line.
    pub message: String,
    /// "src/study/engine.rs:49"; none where nobody noted it.
    pub place: Option<String>,
}

impl Fault {
    /// "index out of bounds at src/study/engine.rs:49".
    pub fn words(&self) -> String {
        match &self.place {
            Some(place) => format!("{} at {place}", self.message),
            None => self.message.clone(),
        }
    }
}

/// Faults noted and not told yet; a panic's place is known to the hook alone, and the thread that catches it may be another.
static NOTED: Mutex<Vec<Fault>> = Mutex::new(Vec::new());
/// Panics that nobody catches are few; more than this are not kept.
const MOST_NOTED: usize = 50;

/// To be called by the process's panic hook: keeps what was said, and where.
pub fn note(panic: &PanicHookInfo<'_>) {
    let place = panic
        .location()
        .map(|location| format!("{}:{}", location.file(), location.line()));
    let mut noted = NOTED.lock().unwrap_or_else(PoisonError::into_inner);
    if noted.len() == MOST_NOTED {
        noted.remove(0);
    }
    noted.push(Fault {
        message: message_of(panic.payload()),
        place,
    });
}

/// What `work` makes, or the fault that ended it.
pub(super) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, Fault> {
    // What a panic leaves half made is thrown away by whoever calls this.
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let message = message_of(payload.as_ref());
        let mut noted = NOTED.lock().unwrap_or_else(PoisonError::into_inner);
        match noted.iter().rposition(|fault| fault.message == message) {
            Some(index) => noted.remove(index),
            None => Fault {
                message,
                place: None,
            },
        }
    })
}

fn message_of(payload: &(dyn Any + Send)) -> String {
    let text = payload
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| payload.downcast_ref::<&str>().copied());
    text.unwrap_or("a fault without a message")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caught_panic_keeps_its_message_on_one_line() {
        let fault = caught(|| panic!("index {}\n  out of bounds", 3)).unwrap_err();
        assert_eq!(fault.message, "index 3 out of bounds");
        assert_eq!(caught(|| 7), Ok(7));
    }

    #[test]
    fn the_place_is_told_where_it_is_known() {
        let fault = Fault {
            message: "no".to_owned(),
            place: Some("src/a.rs:3".to_owned()),
        };
        assert_eq!(fault.words(), "no at src/a.rs:3");
    }
}
