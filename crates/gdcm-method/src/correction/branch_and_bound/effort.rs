//! Work of a search, counted instead of timed, so that results repeat.

use std::cell::Cell;

/// The search was stopped from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SearchStopped;

/// Counts the work of a search, in evaluations of a term, and polls at intervals whether to stop.
pub(crate) struct Effort<'a> {
    stop: &'a dyn Fn() -> bool,
    work: Cell<u64>,
    polled_at: Cell<u64>,
    stopped: Cell<bool>,
}

impl<'a> Effort<'a> {
    /// Work between two polls: half a millisecond.
    const POLL_INTERVAL: u64 = 20_000;

    /// Starts with no work spent.
    pub(crate) fn new(stop: &'a dyn Fn() -> bool) -> Self {
        Self {
            stop,
            work: Cell::new(0),
            polled_at: Cell::new(0),
            stopped: Cell::new(stop()),
        }
    }

    /// Counts `work`.
    pub(crate) fn spend(&self, work: u64) {
        let spent = self.work.get() + work;
        self.work.set(spent);
        if spent - self.polled_at.get() >= Self::POLL_INTERVAL {
            self.polled_at.set(spent);
            self.stopped.set(self.stopped.get() || (self.stop)());
        }
    }

    /// Returns the total work so far.
    pub(crate) fn spent(&self) -> u64 {
        self.work.get()
    }

    /// Whether a stop was requested.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.get()
    }

    /// Returns an error where a stop was requested.
    pub(crate) fn check(&self) -> Result<(), SearchStopped> {
        if self.is_stopped() {
            Err(SearchStopped)
        } else {
            Ok(())
        }
    }
}
