//! The delays found.

use super::conflict::DelayConflict;
use super::remedy::DelayRemedy;
use crate::correction::channel::pair_name;
use crate::dataset::{Pair, PairTable};

/// A held entry whose delay non-negative, bounded channel delays cannot give.
#[derive(Clone, Debug, PartialEq)]
pub struct UnmatchedDelay {
    /// The entry.
    pub pair: Pair,
    /// Its delta delay `D` in seconds; negative: it asks for phase lead.
    pub wanted_s: f64,
    /// The sum at which it is held instead, in seconds.
    pub target_s: f64,
    /// What is in the way; where the entry is not part of it, its miss is the compromise with those that are.
    pub why: DelayConflict,
}

impl UnmatchedDelay {
    /// The lead in seconds that would be needed besides the delay (negative: the delay that is lacking).
    pub fn lead_s(&self) -> f64 {
        self.target_s - self.wanted_s
    }

    /// Phase error in degrees that remains at `omega` rad/s: the reference less the corrected model.
    pub fn phase_left_deg(&self, omega: f64) -> f64 {
        (self.wanted_s - self.target_s).to_degrees() * -omega
    }

    /// The miss in words, with the phase that remains at `omega_top`, the top of the band in rad/s.
    pub fn words(&self, omega_top: f64, inputs: &[String], outputs: &[String]) -> String {
        let pair = pair_name(self.pair, inputs, outputs);
        let lead_ms = 1e3 * self.lead_s();
        let left = self.phase_left_deg(omega_top).abs();
        let why = match self.why {
            DelayConflict::NeedsLead { ref entries, .. } if *entries == [self.pair] => {
                format!("{pair} needs {lead_ms:.1} ms of lead: a delay cannot give it")
            }
            _ if lead_ms > 0.0 => format!("{pair} gets {lead_ms:.1} ms more delay than it needs"),
            _ => format!("{pair} lacks {:.1} ms of delay", -lead_ms),
        };
        format!("{why}; {left:.0}° of phase error remain at {omega_top} rad/s.")
    }
}

/// The channel delays of equation (11), in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct DelaySolution {
    /// Delay of each input channel, m.
    pub inputs_s: Vec<f64>,
    /// Delay of each output channel, p.
    pub outputs_s: Vec<f64>,
    /// The objective in s², the least there is: the problem is convex.
    pub objective: f64,
    /// Sum at which each held entry is held, p x m: its `D` where that is possible (M9, stage 1).
    pub targets_s: PairTable<Option<f64>>,
    /// Whether every held entry is held at its `D`, within 1e-8 of the greatest delay in the problem.
    pub matched: bool,
    /// The entries that are not.
    pub unmatched: Vec<UnmatchedDelay>,
    /// Each set of held entries and bounds that cannot hold together, once; loops first, then by number of entries.
    pub conflicts: Vec<DelayConflict>,
    /// The single changes that would let every held entry be held, where some cannot.
    pub remedy: Option<DelayRemedy>,
}

impl DelaySolution {
    /// What there is to say about the answer, a sentence each: what could not be held, what remains of the phase error at
    /// `omega_top` rad/s, why, and what would help. Empty where everything is held.
    pub fn words(&self, omega_top: f64, inputs: &[String], outputs: &[String]) -> Vec<String> {
        let misses = self.unmatched.iter().map(|miss| miss.words(omega_top, inputs, outputs));
        let conflicts = self.conflicts.iter().map(|conflict| conflict.words(inputs, outputs));
        let remedies =
            self.remedy.iter().map(|remedy| remedy.words(inputs, outputs)).filter(|remedy| !remedy.is_empty());
        misses.chain(conflicts).chain(remedies).collect()
    }
}
