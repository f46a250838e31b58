//! The gains found, and how sure they are.

use super::conflict::GainConflict;
use super::problem::GainObjective;
use crate::dataset::{Pair, PairTable};

/// How far the search for a proof may go, in regions of the scales visited (never in time: results repeat).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProofBudget {
    /// Most regions visited.
    pub boxes: usize,
}

impl Default for ProofBudget {
    /// 20 000 regions: some tenths of a second at most, and far more than a condition needs.
    fn default() -> Self {
        Self { boxes: 20_000 }
    }
}

/// Whether the answer is known to be the best there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// No gains inside the bounds are better by more than the relative gap, which is at most 1e-9.
    Proven {
        /// `(objective - lower bound) / objective`.
        gap: f64,
    },
    /// The budget ended first: better gains may exist, but none better by more than the relative gap.
    NotProven {
        /// `(objective - lower bound) / objective`.
        gap: f64,
    },
}

/// One local minimum of the objective.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalMinimum {
    /// Gain of each input channel.
    pub inputs: Vec<f64>,
    /// Gain of each output channel.
    pub outputs: Vec<f64>,
    /// The objective there.
    pub objective: f64,
}

/// A held entry whose gain the bounds or the other held entries do not allow.
#[derive(Clone, Debug, PartialEq)]
pub struct UnmatchedGain {
    /// The entry.
    pub pair: Pair,
    /// Its delta gain `G`.
    pub wanted: f64,
    /// The product at which it is held instead.
    pub target: f64,
    /// `20 log10 (target / wanted)`: negative where the correction is too weak.
    pub shortfall_db: f64,
    /// What is in the way.
    pub why: GainConflict,
}

/// The channel gains of equation (7), with the proof.
#[derive(Clone, Debug, PartialEq)]
pub struct GainSolution {
    /// Gain of each input channel, m.
    pub inputs: Vec<f64>,
    /// Gain of each output channel, p.
    pub outputs: Vec<f64>,
    /// Which objective was minimised.
    pub minimised: GainObjective,
    /// Its value: of squared ratios, or of squared dB.
    pub objective: f64,
    /// No gains inside the bounds that hold the targets have a lower objective.
    pub lower_bound: f64,
    /// Whether that is a proof. The gap is relative to the objective, or to a hundred-thousandth of `sum w G^2` where the objective
    /// is smaller: below that, rounding decides.
    pub outcome: Outcome,
    /// Regions visited by the proof.
    pub boxes: usize,
    /// Product at which each held entry is held, p x m: its `G` where that is possible (M8, stage 1).
    pub targets: PairTable<Option<f64>>,
    /// Whether every held entry is held at its `G`, within 1e-8 of its logarithm.
    pub matched: bool,
    /// The entries that are not.
    pub unmatched: Vec<UnmatchedGain>,
    /// Each set of held entries and bounds that cannot hold together, once; loops first, then by number of entries.
    pub conflicts: Vec<GainConflict>,
    /// Distinct local minima within 1 % of the objective, best first; the first is the answer.
    pub local_minima: Vec<LocalMinimum>,
    /// Whether the search has shown that there is no other local minimum within 1 %.
    pub all_minima: bool,
}
