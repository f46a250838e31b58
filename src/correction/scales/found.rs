//! What a search may spend, and what it finds.

/// A relative gap that counts as proof.
pub(crate) const PROOF: f64 = 1e-9;

/// How far the search goes.
#[derive(Clone, Copy)]
pub(crate) struct Effort<'a> {
    /// Regions to visit at most.
    pub(crate) boxes: usize,
    /// Regions to visit at most after the proof, to list the minima.
    pub(crate) listing: usize,
    /// Objective below which the gap is no longer relative: what rounding allows.
    pub(crate) floor: f64,
    /// Asked before each region.
    pub(crate) stop: &'a dyn Fn() -> bool,
}

/// What the search found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// Distinct local minima within 1 % of the best, best first, each with its value.
    pub(crate) minima: Vec<(Vec<f64>, f64)>,
    /// No point of the box is below this.
    pub(crate) lower_bound: f64,
    /// `(best - lower_bound) / max(best, floor)`.
    pub(crate) gap: f64,
    /// Regions visited.
    pub(crate) boxes: usize,
    /// Whether there can be no other local minimum within 1 %.
    pub(crate) all_minima: bool,
}
