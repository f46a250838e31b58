//! The regions that are still to be visited.

use std::cmp::Ordering;

use super::region::Region;

/// A region that is still to be visited.
pub(super) struct Open {
    /// No point of the region is below this.
    pub(super) bound: f64,
    pub(super) region: Region,
    /// Where the descent on its relaxation begins.
    pub(super) start: Vec<f64>,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    /// The least bound is the greatest, so that a heap gives it first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}
