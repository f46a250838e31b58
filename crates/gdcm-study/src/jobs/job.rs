//! Long computations in parallel to the interactive analysis.

use gdcm_model::progress::{Cancelled, Progress};

/// A long computation with progress and cancellation, run in parallel to the interactive analysis.
///
/// Two jobs are equal if they have the same output: a running job is cancelled only when no equal
/// job is requested any more.
pub trait Job: Clone + PartialEq + Send + 'static {
    /// Resources kept from one job to the next.
    type Tools;
    /// Result, sent back from the job's thread.
    type Output: Send;

    /// Computes the result, and reports progress.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    fn run(
        &self,
        tools: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled>;

    /// Returns whether this job, with `done` of `total` steps complete, should run to its end
    /// although `newer` is requested instead, because `newer` is then faster.
    fn serves(&self, _newer: &Self, _done: usize, _total: usize) -> bool {
        false
    }
}
