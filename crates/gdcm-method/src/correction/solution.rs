//! Solution to a problem: the channel values, the proof that they are optimal, and the constrained
//! entries that could not be matched.

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::units::{s_to_ms, telling, told_apart};

use super::branch_and_bound::search::Limit;
use super::channels::{Channels, pair_name};
use super::conflict::Conflict;
use super::quantity::Quantity;
use super::remedy::Remedy;

/// Whether the solution is proven to be the global minimum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// No feasible channel values are better by more than the relative gap, which is at most 1e-9.
    Proven {
        /// `(objective - lower bound) / objective`.
        gap: f64,
    },
    /// The search ended before a proof: better solutions may exist, but none better by more than
    /// the relative gap.
    NotProven {
        /// `(objective - lower bound) / objective`.
        gap: f64,
        /// Limit that ended the search.
        limit: Limit,
    },
}

impl Outcome {
    /// Returns `(objective - lower bound) / objective`.
    pub fn gap(self) -> f64 {
        match self {
            Outcome::Proven { gap } | Outcome::NotProven { gap, .. } => gap,
        }
    }

    /// Describes the outcome.
    pub fn words(self) -> String {
        match self {
            Outcome::Proven { .. } => {
                "Proven: no gains within the bounds that hold the held responses are better."
                    .to_owned()
            }
            Outcome::NotProven { gap, limit } => {
                let ended = match limit {
                    Limit::Work => "at its budget of work",
                    Limit::Memory => "at its budget of memory",
                    Limit::Rounding => "where rounding decides",
                };
                let percent = 100.0 * gap;
                format!(
                    "Not proven: gains that are up to {percent:.2} % better may exist; the search ended {ended}."
                )
            }
        }
    }
}

/// A local minimum.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalMinimum {
    pub inputs: Vec<f64>,
    pub outputs: Vec<f64>,
    /// Objective at the minimum.
    pub objective: f64,
}

/// Proof of the minimum objective.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Lower bound on the objective over all channels inside the bounds that meet the targets.
    pub lower_bound: f64,
    /// Whether the bound is a proof. The gap is relative to the objective, or to 1e-9 `sum w G^2`
    /// where the objective is smaller: below that, rounding decides.
    pub outcome: Outcome,
    pub nodes: usize,
    /// Distinct local minima within 1 % of the objective, best first; the first is the solution.
    pub local_minima: Vec<LocalMinimum>,
    /// Whether the search has excluded any other local minimum within 1 %.
    pub all_minima: bool,
}

/// A constrained entry made infeasible by the bounds or by the other constrained entries.
#[derive(Clone, Debug, PartialEq)]
pub struct Unmatched {
    /// Constrained quantity: a gain, or a delay or a signed delay in seconds.
    pub quantity: Quantity,
    pub pair: Pair,
    /// Delta gain `G` or delta delay `D`; a negative `D` asks for phase lead.
    pub delta: f64,
    /// Product or sum to which the entry is constrained instead.
    pub target: f64,
    /// Excess over the delta: `20 log10 (target / delta)` dB, negative where the correction is too
    /// weak; or `target - delta` seconds, the additional lead that would be needed.
    pub excess: f64,
    /// The conflict; where it does not contain the entry, the entry is missed as a compromise with
    /// the conflicting entries.
    pub why: Conflict,
}

impl Unmatched {
    /// Computes the phase error in degrees that a missed delay leaves at `omega` rad/s: the
    /// reference less the corrected model.
    pub fn phase_left_deg(&self, omega: f64) -> f64 {
        (self.delta - self.target).to_degrees() * -omega
    }

    /// Describes the miss; for a delay with the remaining phase at `omega_top`, the band's top in
    /// rad/s.
    pub fn words(&self, omega_top: f64, inputs: &[String], outputs: &[String]) -> String {
        let pair = pair_name(self.pair, inputs, outputs);
        match self.quantity {
            Quantity::Gain(_) => self.gain_words(&pair),
            Quantity::SignedDelay if self.delta < 0.0 => self.lead_words(&pair, omega_top),
            Quantity::Delay | Quantity::SignedDelay => self.delay_words(&pair, omega_top),
        }
    }

    fn gain_words(&self, pair: &str) -> String {
        let (target, delta) = told_apart(self.target, self.delta, 3);
        let sign = if self.excess > 0.0 { "+" } else { "" };
        let excess = telling(self.excess, 1);
        format!("{pair} is held at {target} instead of {delta} ({sign}{excess} dB).")
    }

    fn lead_words(&self, pair: &str, omega_top: f64) -> String {
        let (target, delta) = told_apart(s_to_ms(-self.target), s_to_ms(-self.delta), 1);
        let left = telling(self.phase_left_deg(omega_top).abs(), 0);
        format!(
            "{pair} gets {target} of the {delta} ms of lead it wants; {left}° of phase error remain at {omega_top} rad/s."
        )
    }

    fn delay_words(&self, pair: &str, omega_top: f64) -> String {
        let excess_ms = 1e3 * self.excess;
        let size_ms = telling(excess_ms.abs(), 1);
        let why = if self.why.is_lone_lead() && self.why.entries == [self.pair] {
            let lead_ms = telling(excess_ms, 1);
            format!("{pair} needs {lead_ms} ms of lead: a delay cannot give it")
        } else if excess_ms > 0.0 {
            format!("{pair} gets {size_ms} ms more delay than it needs")
        } else {
            format!("{pair} lacks {size_ms} ms of delay")
        };
        let left = telling(self.phase_left_deg(omega_top).abs(), 0);
        format!("{why}; {left}° of phase error remain at {omega_top} rad/s.")
    }
}

/// The channel gains (eq. (7)), the channel delays (eq. (11)) or the signed delays (M15.4) in
/// seconds, with the proof.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    pub quantity: Quantity,
    /// Input channel values, m.
    pub inputs: Vec<f64>,
    /// Output channel values, p.
    pub outputs: Vec<f64>,
    /// The objective: in squared ratios, in squared dB, or in s².
    pub objective: f64,
    pub proof: Proof,
    /// Product or sum to which each entry is constrained, p x m: its delta where that is feasible
    /// (M8 and M9, stage 1).
    pub targets: PairTable<Option<f64>>,
    /// Whether every constrained entry meets its delta, within 1e-8 of its logarithm, or within
    /// 1e-8 times the problem's longest delay (at least a nanosecond); or within the tolerance
    /// [`Problem::agreement`](super::problem::Problem::agreement) where a loop requires it.
    pub matched: bool,
    /// The constrained entries that miss their delta.
    pub unmatched: Vec<Unmatched>,
    /// The loops that disagree by no more than the tolerance: each is constrained to the nearest
    /// consistent values.
    pub agreeing: Vec<Conflict>,
    /// Each infeasible set (constrained entries and bounds), without duplicates; loops first, then
    /// by number of entries.
    pub conflicts: Vec<Conflict>,
    /// Single changes that would make every constrained entry feasible, where some are not.
    pub remedy: Option<Remedy>,
}

impl Solution {
    /// Returns every channel's gain, delay or signed delay.
    pub fn channels(&self) -> Channels<f64> {
        Channels {
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
        }
    }
}
