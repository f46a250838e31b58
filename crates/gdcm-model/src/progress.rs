//! Progress and cancellation for long computations.
//!
//! A computation reports to a [`Progress`], which its caller provides. If it consists of several
//! parts, [`Shares`] adds up their shares of the whole, and a [`Portion`] is the [`Progress`] of a
//! single part.

use std::sync::{Mutex, PoisonError};

use crate::dataset::StateSpace;

/// Receives a computation's progress, and can cancel it. Its methods may be called from several
/// threads.
pub trait Progress: Sync {
    /// Returns whether the computation should stop now, without a result.
    fn cancelled(&self) -> bool;

    /// Called when `done` of `total` units of work are complete; the computation chooses the unit.
    fn advanced(&self, done: usize, total: usize);

    /// Called with the name of the step in progress, possibly several times for the same step.
    fn step(&self, _name: &str) {}

    /// Called with a preliminary identified model, in the units of the record; a better model
    /// follows.
    fn first_model(&self, _model: &StateSpace) {}
}

/// Receiver that ignores progress and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Progress for Unobserved {
    fn cancelled(&self) -> bool {
        false
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

/// Error from a computation that was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the analysis was stopped")]
pub struct Cancelled;

/// Progress for a computation that is split into shares, which may be completed in any order; the
/// reported total never decreases.
pub struct Shares<'a> {
    progress: &'a dyn Progress,
    /// Completed share, 0 to 1.
    completed: Mutex<f64>,
}

impl<'a> Shares<'a> {
    /// Creates the progress for a computation that has just begun.
    pub fn new(progress: &'a dyn Progress) -> Self {
        Self {
            progress,
            completed: Mutex::new(0.0),
        }
    }

    /// Returns the progress receiver.
    pub fn progress(&self) -> &'a dyn Progress {
        self.progress
    }

    /// Reports the step `name`, before which a share `completed` (0 to 1) of the computation is
    /// complete.
    ///
    /// # Errors
    /// [`Cancelled`] if the computation was cancelled.
    pub fn next(&self, completed: f64, name: &str) -> Result<(), Cancelled> {
        self.report(|_| completed, name)
    }

    /// Reports that a further `share` (0 to 1) of the computation is complete, in the step `name`.
    ///
    /// # Errors
    /// [`Cancelled`] if the computation was cancelled.
    pub fn advance(&self, share: f64, name: &str) -> Result<(), Cancelled> {
        self.report(|completed| completed + share, name)
    }

    /// Reports the step `name`; `update` returns the new completed share (0 to 1), given the
    /// previous share.
    fn report(&self, update: impl Fn(f64) -> f64, name: &str) -> Result<(), Cancelled> {
        /// Number of units in which a share is reported: finer than any progress bar shows.
        const UNITS: f64 = 1000.0;
        if self.progress.cancelled() {
            return Err(Cancelled);
        }
        // `into_inner`: a thread that panicked while it held the lock leaves a valid value.
        let mut completed = self
            .completed
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *completed = completed.max(update(*completed).min(1.0));
        self.progress.step(name);
        self.progress
            .advanced((*completed * UNITS) as usize, UNITS as usize);
        Ok(())
    }
}

/// Part of a computation, which converts its own progress to a share of the whole. Its own step
/// names and preliminary models are not passed on.
pub struct Portion<'a> {
    whole: &'a Shares<'a>,
    /// Share of the whole that this part amounts to, 0 to 1.
    share: f64,
    /// Step name under which the part is reported.
    name: &'static str,
    /// Share reported so far, 0 to `share`.
    reported: Mutex<f64>,
}

impl<'a> Portion<'a> {
    /// Creates a part that amounts to `share` (0 to 1) of the whole and is reported as the step
    /// `name`.
    pub fn new(whole: &'a Shares<'a>, share: f64, name: &'static str) -> Self {
        Self {
            whole,
            share,
            name,
            reported: Mutex::new(0.0),
        }
    }

    /// Reports that the part is complete.
    ///
    /// # Errors
    /// [`Cancelled`] if the computation was cancelled.
    pub fn finish(self) -> Result<(), Cancelled> {
        self.report(1.0)
    }

    /// Reports that a share `completed` (0 to 1) of the part is complete; a smaller value than
    /// before is ignored.
    fn report(&self, completed: f64) -> Result<(), Cancelled> {
        // `into_inner`: a thread that panicked while it held the lock leaves a valid value.
        let mut reported = self.reported.lock().unwrap_or_else(PoisonError::into_inner);
        let rise = (completed.min(1.0) * self.share - *reported).max(0.0);
        *reported += rise;
        self.whole.advance(rise, self.name)
    }
}

impl Progress for Portion<'_> {
    fn cancelled(&self) -> bool {
        self.whole.progress().cancelled()
    }

    fn advanced(&self, done: usize, total: usize) {
        // `let _`: the part itself checks for cancellation.
        let _ = self.report(done as f64 / total.max(1) as f64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Receiver that records every reported count of completed parts.
    #[derive(Default)]
    struct Heard(Mutex<Vec<usize>>);

    impl Progress for Heard {
        fn cancelled(&self) -> bool {
            false
        }

        fn advanced(&self, done: usize, _total: usize) {
            self.0.lock().unwrap().push(done);
        }
    }

    #[test]
    fn a_portion_reports_its_own_steps_as_its_share_of_the_whole() {
        let heard = Heard::default();
        let shares = Shares::new(&heard);
        let portion = Portion::new(&shares, 0.5, "a half");
        for (done, total) in [(1, 4), (2, 4), (1, 4)] {
            portion.advanced(done, total);
        }
        portion.finish().unwrap();
        assert_eq!(
            *heard.0.lock().unwrap(),
            [125, 250, 250, 500],
            "of a thousand, never backwards"
        );
    }
}
