//! Long computations beside the live answer.

use gdcm_model::progress::{Cancelled, Progress};

/// A long computation with progress and cancellation, run beside the live answer.
///
/// Two jobs are equal where they have the same output: a running job is cancelled only when no
/// equal job is requested any more.
pub trait Job: Clone + PartialEq + Send + 'static {
    /// Resources kept from one job to the next.
    type Tools;
    /// Result of the job.
    type Output: Send;

    /// Runs the job.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    fn run(
        &self,
        tools: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled>;

    /// Returns whether this job, `done` of `total` steps complete, should continue although `newer`
    /// is requested instead: `newer` is faster once this job is complete.
    fn serves(&self, _newer: &Self, _done: usize, _total: usize) -> bool {
        false
    }
}
