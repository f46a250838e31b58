//! The gains or delays found, and how sure they are.

use super::{Channels, Conflict, Limit, Quantity, Remedy, pair_name};
use crate::dataset::{Pair, PairTable};
use crate::units::{s_to_ms, telling, told_apart};

/// Whether the answer is known to be the best there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// No channels inside the bounds that hold the targets are better by more than the relative gap, which is at most 1e-9.
    Proven {
        /// `(objective - lower bound) / objective`.
        gap: f64,
    },
    /// The search ended first: better ones may exist, but none better by more than the relative gap.
    NotProven {
        /// `(objective - lower bound) / objective`.
        gap: f64,
        /// What ended the search.
        limit: Limit,
    },
}

impl Outcome {
    /// `(objective - lower bound) / objective`.
    pub fn gap(self) -> f64 {
        match self {
            Outcome::Proven { gap } | Outcome::NotProven { gap, .. } => gap,
        }
    }

    /// The outcome in words.
    pub fn words(self) -> String {
        match self {
            Outcome::Proven { .. } => {
                "Proven: no gains within the bounds that hold the held responses are better.".to_owned()
            }
            Outcome::NotProven { gap, limit } => {
                let ended = match limit {
                    Limit::Work => "at its budget of work",
                    Limit::Memory => "at its budget of memory",
                    Limit::Rounding => "where rounding decides",
                };
                let percent = 100.0 * gap;
                format!("Not proven: gains that are up to {percent:.2} % better may exist; the search ended {ended}.")
            }
        }
    }
}

/// One local minimum of the objective.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalMinimum {
    /// Value of each input channel.
    pub inputs: Vec<f64>,
    /// Value of each output channel.
    pub outputs: Vec<f64>,
    /// The objective there.
    pub objective: f64,
}

/// What is known of the least objective besides its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// No channels inside the bounds that hold the targets have a lower objective.
    pub lower_bound: f64,
    /// Whether that is a proof. The gap is relative to the objective, or to a billionth of `sum w G^2` where the objective is
    /// smaller: below that, rounding decides.
    pub outcome: Outcome,
    /// Nodes visited by the search.
    pub nodes: usize,
    /// Distinct local minima within 1 % of the objective, best first; the first is the answer.
    pub local_minima: Vec<LocalMinimum>,
    /// Whether the search has shown that there is no other local minimum within 1 %.
    pub all_minima: bool,
}

/// A held entry that the bounds or the other held entries do not allow.
#[derive(Clone, Debug, PartialEq)]
pub struct Unmatched {
    /// What is held: a gain, or a delay or a signed delay in seconds.
    pub quantity: Quantity,
    /// The entry.
    pub pair: Pair,
    /// Its delta gain `G` or delta delay `D`; a negative `D` asks for phase lead.
    pub delta: f64,
    /// The product or the sum at which it is held instead.
    pub target: f64,
    /// What it gets too much: `20 log10 (target / delta)` dB of gain, negative where the correction is too weak; or
    /// `target - delta` seconds of delay, the lead that would be needed besides.
    pub excess: f64,
    /// What is in the way; where the entry is not part of it, its miss is the compromise with those that are.
    pub why: Conflict,
}

impl Unmatched {
    /// Phase error in degrees that a missed delay leaves at `omega` rad/s: the reference less the corrected model.
    pub fn phase_left_deg(&self, omega: f64) -> f64 {
        (self.delta - self.target).to_degrees() * -omega
    }

    /// The miss in words; of a delay with the phase that remains at `omega_top`, the top of the band in rad/s.
    pub fn words(&self, omega_top: f64, inputs: &[String], outputs: &[String]) -> String {
        let pair = pair_name(self.pair, inputs, outputs);
        if let Quantity::Gain(_) = self.quantity {
            let (target, delta) = told_apart(self.target, self.delta, 3);
            let sign = if self.excess > 0.0 { "+" } else { "" };
            return format!("{pair} is held at {target} instead of {delta} ({sign}{} dB).", telling(self.excess, 1));
        }
        if self.quantity == Quantity::SignedDelay && self.delta < 0.0 {
            let (target, delta) = told_apart(s_to_ms(-self.target), s_to_ms(-self.delta), 1);
            let left = telling(self.phase_left_deg(omega_top).abs(), 0);
            return format!(
                "{pair} gets {target} of the {delta} ms of lead it wants; {left}° of phase error remain at {omega_top} rad/s."
            );
        }
        let lead_ms = 1e3 * self.excess;
        let left = telling(self.phase_left_deg(omega_top).abs(), 0);
        let why = if self.why.is_lone_lead() && self.why.entries == [self.pair] {
            format!("{pair} needs {} ms of lead: a delay cannot give it", telling(lead_ms, 1))
        } else if lead_ms > 0.0 {
            format!("{pair} gets {} ms more delay than it needs", telling(lead_ms, 1))
        } else {
            format!("{pair} lacks {} ms of delay", telling(-lead_ms, 1))
        };
        format!("{why}; {left}° of phase error remain at {omega_top} rad/s.")
    }
}

/// The channel gains of equation (7), the channel delays of equation (11) or the signed delays of M15.4 in seconds, with the proof.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// What was minimised.
    pub quantity: Quantity,
    /// Value of each input channel, m.
    pub inputs: Vec<f64>,
    /// Value of each output channel, p.
    pub outputs: Vec<f64>,
    /// The objective: of squared ratios, of squared dB, or in s².
    pub objective: f64,
    /// How sure that is.
    pub proof: Proof,
    /// Product or sum at which each held entry is held, p x m: its delta where that is possible (M8 and M9, stage 1).
    pub targets: PairTable<Option<f64>>,
    /// Whether every held entry is held at its delta, within 1e-8 of its logarithm, or of the greatest delay in the problem; or
    /// within the tolerance of [`Problem::agreement`](super::Problem::agreement) where a loop of entries asks for it.
    pub matched: bool,
    /// The entries that are not.
    pub unmatched: Vec<Unmatched>,
    /// The loops of held entries that disagree by no more than the tolerance: each is held at the nearest that agrees.
    pub agreeing: Vec<Conflict>,
    /// Each set of held entries and bounds that cannot hold together, once; loops first, then by number of entries.
    pub conflicts: Vec<Conflict>,
    /// The single changes that would let every held entry be held, where some cannot.
    pub remedy: Option<Remedy>,
}

impl Solution {
    /// Gain, delay or signed delay of each channel.
    pub fn channels(&self) -> Channels<f64> {
        Channels { inputs: self.inputs.clone(), outputs: self.outputs.clone() }
    }
}
