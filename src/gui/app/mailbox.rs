//! Value shared by threads that wait for its changes.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

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
