//! How far a long computation is.

use super::{IdentificationError, StateSpaceMatrices, Watch};
use std::sync::{Mutex, PoisonError};

/// Tells a [`Watch`] of every step, never backwards, and stops between two of them.
pub(super) struct Steps<'a> {
    watch: &'a dyn Watch,
    done: Mutex<f64>,
}

impl<'a> Steps<'a> {
    pub(super) fn new(watch: &'a dyn Watch) -> Self {
        Self { watch, done: Mutex::new(0.0) }
    }

    /// The next step, with `done` (0 to 1) of the whole done before it.
    pub(super) fn next(&self, done: f64, what: &str) -> Result<(), IdentificationError> {
        let mut last = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        self.tell(&mut last, done, what)
    }

    /// A step of `share` of the whole, for work of which steps end in any order.
    pub(super) fn advance(&self, share: f64, what: &str) -> Result<(), IdentificationError> {
        let mut last = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        let done = *last + share;
        self.tell(&mut last, done, what)
    }

    /// Shows the first model, in the units of the records.
    pub(super) fn show(&self, model: &StateSpaceMatrices) {
        self.watch.first_model(model);
    }

    /// Whether the work was stopped.
    pub(super) fn is_stopped(&self) -> bool {
        self.watch.is_stopped()
    }

    fn tell(&self, last: &mut f64, done: f64, what: &str) -> Result<(), IdentificationError> {
        if self.is_stopped() {
            return Err(IdentificationError::Stopped);
        }
        *last = last.max(done.min(1.0));
        self.watch.progress(*last, what);
        Ok(())
    }
}
