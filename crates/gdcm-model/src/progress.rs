//! Progress and cancellation of long computations.

use std::sync::{Mutex, PoisonError};

use crate::dataset::StateSpace;

/// Receives progress reports, and can cancel the computation. Methods may be called from
/// several threads.
pub trait Progress: Sync {
    /// Returns whether the computation should stop now, without a result.
    fn cancelled(&self) -> bool;

    /// Reports `done` out of `total` steps as complete.
    fn advanced(&self, done: usize, total: usize);

    /// Reports the start of a step.
    fn step(&self, _name: &str) {}

    /// Reports a preliminary identified model, in record units; a better model follows.
    fn first_model(&self, _model: &StateSpace) {}
}

/// Ignores progress and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Progress for Unobserved {
    fn cancelled(&self) -> bool {
        false
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

/// Reports progress within a part as its share of the whole computation.
pub struct Portion<'a> {
    shares: &'a Shares<'a>,
    share: f64,
    name: &'static str,
    /// The share reported so far.
    reported: Mutex<f64>,
}

impl<'a> Portion<'a> {
    /// Creates a part with `share` (0 to 1) of the whole, reported as the step `name`.
    pub fn new(shares: &'a Shares<'a>, share: f64, name: &'static str) -> Self {
        Self {
            shares,
            share,
            name,
            reported: Mutex::new(0.0),
        }
    }

    /// Reports the part as complete.
    ///
    /// # Errors
    /// [`Cancelled`] where the computation was cancelled.
    pub fn finish(self) -> Result<(), Cancelled> {
        self.report(1.0)
    }

    /// Reports that `done` (0 to 1) of the part is complete; the reported share never decreases.
    fn report(&self, done: f64) -> Result<(), Cancelled> {
        // A panic of another holder of the lock leaves a valid value.
        let mut reported = self.reported.lock().unwrap_or_else(PoisonError::into_inner);
        let rise = (done.min(1.0) * self.share - *reported).max(0.0);
        *reported += rise;
        self.shares.advance(rise, self.name)
    }
}

impl Progress for Portion<'_> {
    fn cancelled(&self) -> bool {
        self.shares.progress().cancelled()
    }

    fn advanced(&self, done: usize, total: usize) {
        // The part itself checks for cancellation.
        let _ = self.report(done as f64 / total.max(1) as f64);
    }
}

/// Error for a cancelled computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the analysis was stopped")]
pub struct Cancelled;

/// Reports progress of a computation split into shares that may end in any order; the reported
/// total never decreases.
pub struct Shares<'a> {
    progress: &'a dyn Progress,
    done: Mutex<f64>,
}

impl<'a> Shares<'a> {
    /// Creates the shares, none of them complete.
    pub fn new(progress: &'a dyn Progress) -> Self {
        Self {
            progress,
            done: Mutex::new(0.0),
        }
    }

    /// Returns the receiver of the reports.
    pub fn progress(&self) -> &'a dyn Progress {
        self.progress
    }

    /// Starts the next step; `done` (0 to 1) is the share complete before it.
    pub fn next(&self, done: f64, name: &str) -> Result<(), Cancelled> {
        self.report(|_| done, name)
    }

    /// Reports a completed step with its share (0 to 1).
    pub fn advance(&self, share: f64, name: &str) -> Result<(), Cancelled> {
        self.report(|done| done + share, name)
    }

    /// Reports the step `name`; `done` computes the new total share (0 to 1) from the previous.
    fn report(&self, done: impl Fn(f64) -> f64, name: &str) -> Result<(), Cancelled> {
        /// Resolution of the reported progress.
        const PARTS: f64 = 1000.0;
        if self.progress.cancelled() {
            return Err(Cancelled);
        }
        // A panic of another holder of the lock leaves a valid value.
        let mut total = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *total = total.max(done(*total).min(1.0));
        self.progress.step(name);
        self.progress
            .advanced((*total * PARTS) as usize, PARTS as usize);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Records every reported number.
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
