//! Budget for the branch-and-bound search, and the limit that ends it before a proof.

/// Budget for proving the minimum. It is counted instead of timed, so that results are
/// reproducible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProofBudget {
    /// Maximum total work, in evaluations of a term in the objective (20 to 30 ns on a core). A
    /// step in progress is completed.
    pub work: u64,
    /// Maximum work after the proof, spent on finding every other local minimum within 1 % above
    /// the best.
    pub listing: u64,
    /// Maximum memory for the open nodes \[bytes\].
    pub bytes: usize,
}

impl Default for ProofBudget {
    /// Returns about two seconds on one core and 64 MB, far more than a condition with constrained
    /// on-axis responses needs, and at most a few milliseconds for the other minima.
    fn default() -> Self {
        Self {
            work: 80_000_000,
            listing: 200_000,
            bytes: 64_000_000,
        }
    }
}

/// Limit that ended a search before the proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The work, [`ProofBudget::work`].
    Work,
    /// The memory, [`ProofBudget::bytes`].
    Memory,
    /// Double precision: a sharper bound is not possible.
    Rounding,
}
