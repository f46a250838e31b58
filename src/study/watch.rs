//! How a long analysis is watched and stopped.

/// Told of the progress of an analysis, and asked whether it is still wanted.
///
/// Conditions may be carried out by several threads, and each of them asks.
pub trait Watch: Sync {
    /// Whether the analysis should end now, without a result.
    fn stopped(&self) -> bool;

    /// `done` of `total` conditions are finished.
    fn progress(&self, done: usize, total: usize);
}

/// Nobody watches: the analysis runs to its end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn stopped(&self) -> bool {
        false
    }

    fn progress(&self, _done: usize, _total: usize) {}
}

/// The analysis was stopped before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the analysis was stopped")]
pub struct Stopped;
