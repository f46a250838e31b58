//! How a long analysis is watched and stopped.

use crate::dataset::ConditionId;

use super::condition_analysis::{ConditionAnalysis, ConditionFailure};

/// Told of the progress of an analysis, and asked whether it is still wanted.
///
/// The work may be carried out by several threads, and each of them asks.
pub trait Watch: Sync {
    /// Whether the analysis should end now, without a result.
    fn stopped(&self) -> bool;

    /// `done` of `total` steps are behind.
    fn progress(&self, done: usize, total: usize);

    /// The condition whose result is wanted before the others'.
    fn wanted_first(&self) -> Option<ConditionId> {
        None
    }

    /// The result of the condition wanted first, which the whole analysis will contain.
    fn first_result(&self, _result: &Result<ConditionAnalysis, ConditionFailure>) {}
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
