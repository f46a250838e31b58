//! A search's work, counted instead of timed, so that the results are reproducible; and the request
//! to stop the search. The unit is an evaluation of a term in the objective.

use std::cell::Cell;

/// Number of multiply-adds that count as one term evaluation.
pub(crate) const MULTIPLY_ADDS: u64 = 16;

/// Returns the work for a Cholesky factorisation of an n x n matrix, `n^3 / 6` multiply-adds.
pub(crate) fn cholesky_work(n: u64) -> u64 {
    n * n * n / (6 * MULTIPLY_ADDS)
}

/// Error if the caller stopped the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SearchStopped;

/// Counter for a search's work, in term evaluations. At intervals it polls whether to stop.
pub(crate) struct Effort<'a> {
    stop: &'a dyn Fn() -> bool,
    work: Cell<u64>,
    polled_at: Cell<u64>,
    stopped: Cell<bool>,
}

impl<'a> Effort<'a> {
    /// Work between two polls, about half a millisecond.
    const POLL_INTERVAL: u64 = 20_000;

    /// Creates a counter at zero; `stop` returns whether to stop, and is polled at once.
    pub(crate) fn new(stop: &'a dyn Fn() -> bool) -> Self {
        Self {
            stop,
            work: Cell::new(0),
            polled_at: Cell::new(0),
            stopped: Cell::new(stop()),
        }
    }

    /// Adds `work`, and polls `stop` if [`Self::POLL_INTERVAL`] has passed since the last poll.
    pub(crate) fn spend(&self, work: u64) {
        let spent = self.work.get() + work;
        self.work.set(spent);
        if spent - self.polled_at.get() >= Self::POLL_INTERVAL {
            self.polled_at.set(spent);
            self.stopped.set(self.stopped.get() || (self.stop)());
        }
    }

    /// Returns the total work so far, in term evaluations.
    pub(crate) fn spent(&self) -> u64 {
        self.work.get()
    }

    /// Returns whether a stop was requested at any poll so far.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.get()
    }

    /// Returns an error if a stop was requested.
    pub(crate) fn check(&self) -> Result<(), SearchStopped> {
        if self.is_stopped() {
            Err(SearchStopped)
        } else {
            Ok(())
        }
    }
}
