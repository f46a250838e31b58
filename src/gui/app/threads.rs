//! Tools shared by the window and its threads: mailboxes, replies, threads for a single task, and
//! panics, which are caught and reported as sentences instead of raw traces.

use std::any::Any;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use egui::Context;

use super::GdcmApp;

/// A value that threads wait for; every change wakes them.
#[derive(Default)]
pub(super) struct Mailbox<T> {
    content: Mutex<T>,
    changed: Condvar,
}

impl<T> Mailbox<T> {
    /// Locks the content for reading.
    pub(super) fn lock(&self) -> MutexGuard<'_, T> {
        // The content is consistent even after a panic under the lock.
        self.content.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the content; every waiting thread checks it again.
    pub(super) fn change<R>(&self, change: impl FnOnce(&mut T) -> R) -> R {
        let changed = change(&mut self.lock());
        self.changed.notify_all();
        changed
    }

    /// Waits until `take` returns a value for the content.
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

/// A thread's reply, applied to the window.
pub(super) type Reply = Box<dyn FnOnce(&mut GdcmApp) + Send>;

/// Sender for replies from threads; each reply wakes the window.
#[derive(Clone)]
pub struct ReplySender {
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
        // Sending fails only after the window is gone; the threads end soon after.
        let _ = self.sender.send(Box::new(reply));
        self.ctx.request_repaint();
    }
}

impl GdcmApp {
    /// Runs `work` in a thread called `name` and passes its result to `take`: `None` after a fault,
    /// or if no thread could be started. Both are reported first.
    pub(super) fn in_thread<T: Send + 'static, Work, Take>(
        &self,
        name: &'static str,
        work: Work,
        take: Take,
    ) where
        Work: FnOnce() -> T + Send + 'static,
        Take: FnOnce(&mut Self, Option<T>) + Send + 'static,
    {
        // The work is sent once the thread exists.
        let (order, ordered) = channel::<(Work, Take)>();
        let replies = self.work.replies.clone();
        let thread = move || {
            let Ok((work, take)) = ordered.recv() else {
                return;
            };
            let outcome = caught(work);
            replies.send(move |app| match outcome {
                Ok(result) => take(app, Some(result)),
                Err(fault) => {
                    app.report_fault(name, &fault);
                    take(app, None);
                }
            });
        };
        let thread = std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(thread);
        match thread {
            Ok(_) => drop(order.send((work, take))),
            Err(error) => self.work.replies.send(move |app| {
                app.notify_error(format!("{name} could not start: {error}"));
                take(app, None);
            }),
        }
    }

    /// Stops the work shown next to the Stop button: a reading, or else the computation.
    pub(super) fn stop_work(&mut self) {
        let opening = self.state.opening.take();
        let records = self.state.records.reading.take();
        let Some(name) = opening.or_else(|| records.clone()) else {
            return self.stop_jobs();
        };
        self.readers.opener.give_up();
        self.readers.record_reader.give_up();
        if records.is_some() {
            // An existing entry prevents another automatic search.
            self.records_of(self.state.condition().id());
        }
        self.done(format!("stopped reading {name}; the open study stays"));
    }
}

/// A panic: its message and its source location.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The message, on a single line.
    pub message: String,
    /// "src/study/engine.rs:49"; `None` if the location was not recorded.
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

/// Recorded faults that are not reported yet. Only the panic hook knows the location of a panic,
/// and another thread may catch the panic.
static NOTED: Mutex<Vec<Fault>> = Mutex::new(Vec::new());
/// Maximum number of recorded faults; uncaught panics are rare.
const MOST_NOTED: usize = 50;

/// Records a panic's message and location; called by the process's panic hook.
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

/// Returns the result of `work`, or the fault that ended it.
pub(super) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, Fault> {
    // The caller discards values that a panic left inconsistent.
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

/// Returns a panic's message, on a single line.
fn message_of(payload: &(dyn Any + Send)) -> String {
    let text = if let Some(text) = payload.downcast_ref::<String>() {
        text
    } else if let Some(text) = payload.downcast_ref::<&str>() {
        text
    } else {
        "a fault without a message"
    };
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ")
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
    fn the_place_is_named_if_known() {
        let fault = Fault {
            message: "no".to_owned(),
            place: Some("src/a.rs:3".to_owned()),
        };
        assert_eq!(fault.words(), "no at src/a.rs:3");
    }
}
