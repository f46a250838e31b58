//! What a search may spend: counted, never timed, so that results repeat.

use std::cell::Cell;

/// A relative gap that counts as proof.
pub(crate) const PROOF: f64 = 1e-9;

/// How far the search for a proof goes. Both are counted, never timed: results repeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProofBudget {
    /// Work in all, in units of one term of the objective evaluated (20 to 30 ns of one core). What is begun is ended.
    pub work: u64,
    /// Work after the proof, to find every other local minimum within 1 %.
    pub listing: u64,
    /// Bytes of the nodes that are still open.
    pub bytes: usize,
}

impl Default for ProofBudget {
    /// About two seconds of one core and 64 MB: far more than a condition with its on-axis responses held needs. Of that at most
    /// some milliseconds for the other minima.
    fn default() -> Self {
        Self { work: 80_000_000, listing: 200_000, bytes: 64_000_000 }
    }
}

/// What ended a search before the proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// [`ProofBudget::work`].
    Work,
    /// [`ProofBudget::bytes`].
    Memory,
    /// Double precision: no bound can be sharper.
    Rounding,
}

/// The search was told to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SearchStopped;

/// Counts the work of one search, and asks now and then whether it is still wanted.
pub(crate) struct Effort<'a> {
    stop: &'a dyn Fn() -> bool,
    work: Cell<u64>,
    asked_at: Cell<u64>,
    stopped: Cell<bool>,
}

impl<'a> Effort<'a> {
    /// Work between two questions: half a millisecond.
    const ASKING: u64 = 20_000;

    /// Nothing spent yet.
    pub(crate) fn new(stop: &'a dyn Fn() -> bool) -> Self {
        Self { stop, work: Cell::new(0), asked_at: Cell::new(0), stopped: Cell::new(stop()) }
    }

    /// Counts `work`.
    pub(crate) fn spend(&self, work: u64) {
        let spent = self.work.get() + work;
        self.work.set(spent);
        if spent - self.asked_at.get() >= Self::ASKING {
            self.asked_at.set(spent);
            self.stopped.set(self.stopped.get() || (self.stop)());
        }
    }

    /// Work so far.
    pub(crate) fn spent(&self) -> u64 {
        self.work.get()
    }

    /// Whether the search was told to stop.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.get()
    }

    /// An error where the search was told to stop.
    pub(crate) fn check(&self) -> Result<(), SearchStopped> {
        if self.is_stopped() { Err(SearchStopped) } else { Ok(()) }
    }
}
