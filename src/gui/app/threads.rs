//! Communication between the window and its threads: mailboxes, replies, threads for a single task,
//! and caught panics, which are reported in a sentence instead of a raw trace.

use std::any::Any;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use egui::Context;

use super::GdcmApp;

/// Value that threads can wait for; every change wakes them.
#[derive(Default)]
pub(super) struct Mailbox<T> {
    content: Mutex<T>,
    changed: Condvar,
}

impl<T> Mailbox<T> {
    /// Locks the content for reading.
    pub(super) fn lock(&self) -> MutexGuard<'_, T> {
        // Ignore poisoning: the content is consistent even after a panic under the lock.
        self.content.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the content; every waiting thread checks it again.
    pub(super) fn change<R>(&self, change: impl FnOnce(&mut T) -> R) -> R {
        let changed = change(&mut self.lock());
        self.changed.notify_all();
        changed
    }

    /// Waits until `take` returns `Some`, and returns that value.
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

/// Reply of a thread: a change that the window applies to itself.
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
    /// Runs `work` in a thread called `name` and passes its result to `take`. After a panic, or if
    /// the thread could not be started, reports the error and passes `None`.
    pub(super) fn in_thread<T: Send + 'static, Work, Take>(
        &self,
        name: &'static str,
        work: Work,
        take: Take,
    ) where
        Work: FnOnce() -> T + Send + 'static,
        Take: FnOnce(&mut Self, Option<T>) + Send + 'static,
    {
        // `work` and `take` are sent once the thread exists, because `take` is also called if it
        // could not be started.
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

    /// Stops the work shown next to the Stop button: the file being read, or else the computation.
    pub(super) fn stop_work(&mut self) {
        let opening = self.state.opening.take();
        let records = self.state.records.reading.take();
        let Some(name) = opening.or_else(|| records.clone()) else {
            return self.stop_jobs();
        };
        self.readers.opener.give_up();
        self.readers.record_reader.give_up();
        if records.is_some() {
            // This entry, even if it is empty, prevents another automatic search for records.
            self.records_of(self.state.condition().id());
        }
        self.done(format!(
            "stopped reading {name}; the open study is unchanged"
        ));
    }
}

/// Message and source location of a panic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Message on a single line.
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

/// Recorded panics that have not been caught yet. Only the panic hook knows the location of a
/// panic. Another thread may catch it, so the list is not thread-local.
static NOTED: Mutex<Vec<Fault>> = Mutex::new(Vec::new());
/// Maximum number of recorded panics; the oldest is dropped.
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

/// Returns the result of `work`, or the panic that ended it.
pub(super) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, Fault> {
    // `AssertUnwindSafe`: callers discard values that a panic left inconsistent.
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
        "a panic without a message"
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
