//! The progress of long work, and its cancellation.

use crate::dataset::ConditionId;

use super::condition_analysis::{ConditionAnalysis, ConditionFailure};

/// Told of the progress of long work, and asked whether it is still wanted.
///
/// The work may be carried out by several threads, and each of them asks.
pub trait Progress: Sync {
    /// Whether the work should end now, without a result.
    fn cancelled(&self) -> bool;

    /// `done` of `total` steps are behind.
    fn advanced(&self, done: usize, total: usize);

    /// The condition whose result is wanted before the others'.
    fn wanted_first(&self) -> Option<ConditionId> {
        None
    }

    /// The result of the condition wanted first, which the whole analysis will contain.
    fn first_result(&self, _result: &Result<ConditionAnalysis, ConditionFailure>) {}
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

/// The work was stopped before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the analysis was stopped")]
pub struct Cancelled;
