//! The gains found, and how sure they are.

use super::conflict::GainConflict;
use super::problem::GainObjective;
use super::remedy::GainRemedy;
use crate::correction::channel::pair_name;
use crate::dataset::{Pair, PairTable};

/// How far the search may go, in regions of the scales visited (never in time: results repeat).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProofBudget {
    /// Most regions visited in all.
    pub boxes: usize,
    /// Most regions visited after the proof, to find every other local minimum within 1 %.
    pub minima: usize,
}

impl Default for ProofBudget {
    /// Far more than a condition needs for the proof, and at most a millisecond or two for the other minima.
    fn default() -> Self {
        Self { boxes: 20_000, minima: 300 }
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

impl Outcome {
    /// `(objective - lower bound) / objective`.
    pub fn gap(self) -> f64 {
        match self {
            Outcome::Proven { gap } | Outcome::NotProven { gap } => gap,
        }
    }

    /// The outcome in words.
    pub fn words(self) -> String {
        match self {
            Outcome::Proven { .. } => "Proven: no gains within the bounds are better.".to_owned(),
            Outcome::NotProven { gap } => {
                format!("Not proven: gains that are up to {:.2} % better may exist.", 100.0 * gap)
            }
        }
    }
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
    /// What is in the way; where the entry is not part of it, its miss is the compromise with those that are.
    pub why: GainConflict,
}

impl UnmatchedGain {
    /// The miss in words.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let pair = pair_name(self.pair, inputs, outputs);
        format!("{pair} is held at {:.3} instead of {:.3} ({:+.1} dB).", self.target, self.wanted, self.shortfall_db)
    }
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
    /// Whether that is a proof. The gap is relative to the objective, or to a billionth of `sum w G^2` where the objective is
    /// smaller: below that, rounding decides.
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
    /// The single changes that would let every held entry be held, where some cannot.
    pub remedy: Option<GainRemedy>,
    /// Distinct local minima within 1 % of the objective, best first; the first is the answer.
    pub local_minima: Vec<LocalMinimum>,
    /// Whether the search has shown that there is no other local minimum within 1 %.
    pub all_minima: bool,
}

impl GainSolution {
    /// What there is to say about the answer, a sentence each: how sure it is, what could not be held, why, and what would help.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> Vec<String> {
        let mut words = vec![self.outcome.words()];
        if self.local_minima.len() > 1 {
            words.push(format!("{} different sets of gains are within 1 % of each other.", self.local_minima.len()));
        }
        words.extend(self.unmatched.iter().map(|miss| miss.words(inputs, outputs)));
        words.extend(self.conflicts.iter().map(|conflict| conflict.words(inputs, outputs)));
        words
            .extend(self.remedy.iter().map(|remedy| remedy.words(inputs, outputs)).filter(|remedy| !remedy.is_empty()));
        words
    }
}
