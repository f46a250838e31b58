//! The window's threads: a thread for a single task, and the replies with which threads change the
//! window.

use std::sync::mpsc::{Receiver, Sender, channel};

use egui::Context;

use super::GdcmApp;
use super::faults::caught;
use crate::message::Message;

/// Reply from a thread: a change that the window applies to itself.
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
                let text = format!("{name} could not start: {error}");
                app.notify_error(Message::new("no-threads", text));
                take(app, None);
            }),
        }
    }
}
