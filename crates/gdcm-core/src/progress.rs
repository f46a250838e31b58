//! The progress of long work, and its end before its time.

use std::sync::{Mutex, PoisonError};

use crate::dataset::StateSpace;

/// Told of the progress of long work, and asked whether it is still wanted.
///
/// The work may be carried out by several threads, and each of them asks.
pub trait Progress: Sync {
    /// Whether the work should end now, without a result.
    fn cancelled(&self) -> bool;

    /// `done` of `total` steps are behind.
    fn advanced(&self, done: usize, total: usize);

    /// The step that begins, in words.
    fn step(&self, _what: &str) {}

    /// A first model of an identification, in the units of the records; a better one follows.
    fn first_model(&self, _model: &StateSpace) {}
}

/// Nobody observes: the work runs to its end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Progress for Unobserved {
    fn cancelled(&self) -> bool {
        false
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

/// Asks whether a part of the work is still wanted, and tells nothing of that part's own steps.
pub struct Untold<'a>(pub &'a dyn Progress);

impl Progress for Untold<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

/// The work was stopped before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the analysis was stopped")]
pub struct Cancelled;

/// Tells of work that is divided by shares of the whole, some of which end in any order: never backwards.
pub struct Shares<'a> {
    progress: &'a dyn Progress,
    done: Mutex<f64>,
}

impl<'a> Shares<'a> {
    /// Nothing is done yet.
    pub fn new(progress: &'a dyn Progress) -> Self {
        Self { progress, done: Mutex::new(0.0) }
    }

    /// Who is told.
    pub fn progress(&self) -> &'a dyn Progress {
        self.progress
    }

    /// The next step, with `done` (0 to 1) of the whole done before it.
    pub fn next(&self, done: f64, what: &str) -> Result<(), Cancelled> {
        self.tell(|_| done, what)
    }

    /// A step of `share` of the whole, for work of which steps end in any order.
    pub fn advance(&self, share: f64, what: &str) -> Result<(), Cancelled> {
        self.tell(|done| done + share, what)
    }

    fn tell(&self, done: impl Fn(f64) -> f64, what: &str) -> Result<(), Cancelled> {
        /// Parts into which the whole is divided.
        const PARTS: f64 = 1000.0;
        if self.progress.cancelled() {
            return Err(Cancelled);
        }
        // A panic while the lock was held leaves a number that is still whole.
        let mut last = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *last = last.max(done(*last).min(1.0));
        self.progress.step(what);
        self.progress.advanced((*last * PARTS) as usize, PARTS as usize);
        Ok(())
    }
}
