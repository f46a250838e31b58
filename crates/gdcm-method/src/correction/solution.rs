//! A problem's solution: the channel values, the proof that they are optimal, and the constrained
//! entries whose delta is infeasible. An entry is a response; its *delta* is the gain or delay that
//! it needs, its *target* the nearest feasible value, to which it is constrained instead.

use gdcm_model::dataset::{Pair, PairTable};

use super::branch_and_bound::proof_budget::Limit;
use super::channels::Channels;
use super::conflict::Conflict;
use super::quantity::Quantity;
use super::remedy::Remedy;

/// Whether the solution is proven to be the global minimum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// No feasible channel values are better by more than the relative gap, which is at most 1e-9.
    Proven {
        /// Relative gap ([`Outcome::gap`]).
        gap: f64,
    },
    /// The search ended before a proof: better solutions may exist, but none that is better by more
    /// than the relative gap.
    NotProven {
        /// Relative gap ([`Outcome::gap`]).
        gap: f64,
        /// Limit that ended the search.
        limit: Limit,
    },
}

impl Outcome {
    /// Returns the relative gap, `(objective - lower bound) / objective`; for a small objective,
    /// see [`Proof::outcome`].
    pub fn gap(self) -> f64 {
        match self {
            Outcome::Proven { gap } | Outcome::NotProven { gap, .. } => gap,
        }
    }

    /// Returns the stable code, for programs and tests.
    pub fn code(self) -> &'static str {
        match self {
            Outcome::Proven { .. } => "proven",
            Outcome::NotProven { .. } => "not-proven",
        }
    }
}

/// Channel values at a local minimum.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalMinimum {
    pub inputs: Vec<f64>,
    pub outputs: Vec<f64>,
    /// Objective at the minimum.
    pub objective: f64,
}

/// Result from the search for a proof that the objective is minimal.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Lower bound on the objective over all channel values that are within the bounds and meet the
    /// targets.
    pub lower_bound: f64,
    /// Whether the minimum is proven. The gap is relative to the objective, or to about 1e-9 `sum w
    /// G^2` (delays: `sum w D^2`) if the objective is smaller, because rounding errors then
    /// dominate.
    pub outcome: Outcome,
    pub nodes: usize,
    /// Distinct local minima within 1 % above the objective, best first; the first is the solution.
    pub local_minima: Vec<LocalMinimum>,
    /// Whether the search has excluded any further local minimum within 1 %.
    pub all_minima: bool,
}

/// A constrained entry whose delta the bounds or the other constrained entries make infeasible.
#[derive(Clone, Debug, PartialEq)]
pub struct Unmatched {
    /// Constrained quantity: gains, delays \[s\] or signed delays \[s\].
    pub quantity: Quantity,
    pub pair: Pair,
    /// Delta gain `G` or delta delay `D` \[s\]; a negative `D` requires phase lead.
    pub delta: f64,
    /// Gain product, or delay sum \[s\], to which the entry is constrained instead.
    pub target: f64,
    /// How much the target exceeds the delta. For gains it is `20 log10 (target / delta)` dB,
    /// negative if the correction is too weak; for delays it is `target - delta` in seconds: if
    /// positive, the additional lead that would be needed.
    pub excess: f64,
    /// Conflict that makes the delta infeasible. If it does not contain the entry, the entry
    /// deviates as a compromise with the entries in the conflict.
    pub why: Conflict,
}

impl Unmatched {
    /// Computes the phase error \[deg\] that an infeasible delay leaves at `omega` \[rad/s\]:
    /// reference minus corrected model.
    pub fn phase_left_deg(&self, omega: f64) -> f64 {
        (self.delta - self.target).to_degrees() * -omega
    }
}

/// Channel gains (eq. (7)), channel delays (eq. (11)) or signed delays (M15.4), both in seconds,
/// with the proof that they are optimal.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    pub quantity: Quantity,
    /// Input channel values, m of them.
    pub inputs: Vec<f64>,
    /// Output channel values, p of them.
    pub outputs: Vec<f64>,
    /// Minimum objective: in squared ratios, squared dB or s².
    pub objective: f64,
    pub proof: Proof,
    /// Product or sum to which each entry is constrained, p x m: its delta, if that is feasible (M8
    /// and M9, stage 1). `None` if the entry is not constrained.
    pub targets: PairTable<Option<f64>>,
    /// Whether every constrained entry meets its delta. The tolerance is 1e-8 in a gain's
    /// logarithm, and 1e-8 times the problem's longest delay (at least a nanosecond) for a delay;
    /// in a loop it is [`Problem::agreement`](super::problem::Problem::agreement).
    pub matched: bool,
    /// Constrained entries that do not meet their delta, without those in `agreeing` loops.
    pub unmatched: Vec<Unmatched>,
    /// Loops whose deviation is within the tolerance; their entries are constrained to the nearest
    /// consistent values.
    pub agreeing: Vec<Conflict>,
    /// Conflicts between constrained entries and bounds, without duplicates; loops first, then by
    /// entry count.
    pub conflicts: Vec<Conflict>,
    /// Single changes that would make every constrained entry feasible; `None` if every entry is
    /// feasible.
    pub remedy: Option<Remedy>,
}

impl Solution {
    /// Returns every channel's gain, delay \[s\] or signed delay \[s\].
    pub fn channels(&self) -> Channels<f64> {
        Channels {
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
        }
    }
}
