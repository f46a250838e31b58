//! What the channels are asked to do.

use serde::{Deserialize, Serialize};

use super::{Coordinate, GainObjective, Quantity, SearchStopped};
use crate::dataset::{Pair, PairTable};

/// Least and greatest value of every channel (M7): gains `0 < lower <= upper`, delays \[s\] `lower = 0`, signed delays \[s\]
/// `lower <= 0 <= upper` (M15.4).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Bounds {
    /// Least value.
    pub lower: f64,
    /// Greatest value.
    pub upper: f64,
}

impl From<[f64; 2]> for Bounds {
    fn from([lower, upper]: [f64; 2]) -> Self {
        Self { lower, upper }
    }
}

impl From<Bounds> for [f64; 2] {
    fn from(bounds: Bounds) -> Self {
        [bounds.lower, bounds.upper]
    }
}

/// Mismatch of a loop of held delays that counts as agreement \[s\]: half of the last digit in which delays are told.
pub const DELAY_AGREEMENT_S: f64 = 5e-5;

/// The gains (eq. (7), M8), the delays \[s\] (eq. (11), M9) or the signed delays \[s\] (M15.4) that a condition's correction is to have.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// What is asked for.
    pub quantity: Quantity,
    /// Delta gain `G` or delta delay `D` of each response, p x m; `None` where the response has none: it is left out of the
    /// objective.
    pub delta: PairTable<Option<f64>>,
    /// Entries at which the two channels together are to be held at their delta, p x m.
    pub constrained: PairTable<bool>,
    /// Entries that count in the objective (`w = 1`), p x m.
    pub fitted: PairTable<bool>,
    /// Bounds of every channel.
    pub bounds: Bounds,
    /// Weight of the departure of the output gains from 1, of the output delays, or of all signed delays; `alpha = 0` stands for the
    /// limit `alpha -> 0+`.
    pub alpha: f64,
    /// Greatest mismatch of a loop of held entries that counts as agreement: dB of gain, or seconds of delay.
    pub agreement: f64,
}

/// Why gains or delays cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// A table has another shape than the deltas.
    #[error(
        "the table of {table} entries has {outputs} outputs and {inputs} inputs, but the {quantity}s have {delta_outputs} and {delta_inputs}"
    )]
    Shape {
        /// What is asked for.
        quantity: Quantity,
        /// Which table.
        table: &'static str,
        /// Its number of outputs.
        outputs: usize,
        /// Its number of inputs.
        inputs: usize,
        /// Number of outputs of the deltas.
        delta_outputs: usize,
        /// Number of inputs of the deltas.
        delta_inputs: usize,
    },
    /// A held entry has no delta.
    #[error("the response of output {} to input {} has no delta {quantity}, so its {quantity} cannot be held", pair.output + 1, pair.input + 1)]
    ConstrainedUndefined {
        /// What is asked for.
        quantity: Quantity,
        /// The entry.
        pair: Pair,
    },
    /// A delta gain is not a positive number that can be squared.
    #[error("the delta gain of output {} and input {} is {gain}; it must lie between 1e-50 and 1e50", pair.output + 1, pair.input + 1)]
    Gain {
        /// The entry.
        pair: Pair,
        /// Its delta gain.
        gain: f64,
    },
    /// A delta delay is not a time.
    #[error("the delta delay of output {} and input {} is {delay_s} s; it must be a number below 1e50 s", pair.output + 1, pair.input + 1)]
    Delay {
        /// The entry.
        pair: Pair,
        /// Its delta delay.
        delay_s: f64,
    },
    /// The bounds are not those of the quantity ([`Bounds`]).
    #[error("{}", bounds_words(*quantity, bounds.lower, bounds.upper))]
    Bounds {
        /// What is asked for.
        quantity: Quantity,
        /// The bounds.
        bounds: Bounds,
    },
    /// `alpha` is negative or not a number.
    #[error("alpha is {alpha}; it must be a number from 0 to 1e12")]
    Alpha {
        /// The weight.
        alpha: f64,
    },
    /// The quadratic program of the delays was not solved.
    #[error("the quadratic program of the delays was not solved: {reason}")]
    Program {
        /// What the solver says.
        reason: String,
    },
    /// The search was told to stop.
    #[error("the search for the best answer was stopped")]
    Stopped,
}

fn bounds_words(quantity: Quantity, lower: f64, upper: f64) -> String {
    match quantity {
        Quantity::Gain(_) => format!(
            "the gain bounds {lower} and {upper} must be positive (1e-9 to 1e9), the lower one not above the upper one"
        ),
        Quantity::Delay => {
            format!("the delays are bounded by {lower} s and {upper} s; it must be 0 and a number from 0 to 1e50 s")
        }
        Quantity::SignedDelay => format!(
            "the signed delays are bounded by {lower} s and {upper} s; it must be a number from -1e50 to 0 and one from 0 to \
             1e50 s"
        ),
    }
}

impl From<SearchStopped> for ProblemError {
    fn from(_: SearchStopped) -> Self {
        ProblemError::Stopped
    }
}

/// Delta gains outside of this range overflow when squared and summed.
const GAINS: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// Bounds outside of this range (180 dB) overflow in the products of the search for a proof.
const GAIN_BOUNDS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

impl Problem {
    /// The problem of equation (7) that fits every entry: `alpha = 1`, the paper's objective, loops held to the last digit.
    pub fn gains(delta: PairTable<Option<f64>>, constrained: PairTable<bool>, bounds: Bounds) -> Self {
        let fitted = PairTable::filled(delta.outputs(), delta.inputs(), true);
        let quantity = Quantity::Gain(GainObjective::Ratio);
        Self { quantity, delta, constrained, fitted, bounds, alpha: 1.0, agreement: 0.0 }
    }

    /// The problem of equation (11) that fits every entry, with `alpha = 1`; all times in seconds.
    pub fn delays(delta_s: PairTable<Option<f64>>, constrained: PairTable<bool>, upper_s: f64) -> Self {
        let bounds = Bounds { lower: 0.0, upper: upper_s };
        Self { quantity: Quantity::Delay, ..Self::gains(delta_s, constrained, bounds) }
    }

    /// The convex program of M15.4 that fits every entry, with `alpha = 1`; all times in seconds.
    pub fn signed_delays(delta_s: PairTable<Option<f64>>, constrained: PairTable<bool>, bounds: Bounds) -> Self {
        Self { quantity: Quantity::SignedDelay, ..Self::gains(delta_s, constrained, bounds) }
    }

    /// Checks shapes and figures.
    ///
    /// # Errors
    /// The first [`ProblemError`] found.
    pub fn check(&self) -> Result<(), ProblemError> {
        let quantity = self.quantity;
        let (delta_outputs, delta_inputs) = (self.delta.outputs(), self.delta.inputs());
        for (table, entries) in [("constrained", &self.constrained), ("fitted", &self.fitted)] {
            let (outputs, inputs) = (entries.outputs(), entries.inputs());
            if (outputs, inputs) != (delta_outputs, delta_inputs) {
                return Err(ProblemError::Shape { quantity, table, outputs, inputs, delta_outputs, delta_inputs });
            }
        }
        for (pair, delta) in self.delta.iter() {
            match (*delta, quantity) {
                (None, _) if self.constrained[pair] => {
                    return Err(ProblemError::ConstrainedUndefined { quantity, pair });
                }
                (Some(gain), Quantity::Gain(_)) if !GAINS.contains(&gain) => {
                    return Err(ProblemError::Gain { pair, gain });
                }
                (Some(delay_s), Quantity::Delay | Quantity::SignedDelay) if !(-1e50..=1e50).contains(&delay_s) => {
                    return Err(ProblemError::Delay { pair, delay_s });
                }
                _ => {}
            }
        }
        let (Bounds { lower, upper }, times) = (self.bounds, 0.0..=1e50);
        let are_bounds = match quantity {
            Quantity::Gain(_) => GAIN_BOUNDS.contains(&lower) && GAIN_BOUNDS.contains(&upper) && lower <= upper,
            Quantity::Delay => lower == 0.0 && times.contains(&upper),
            Quantity::SignedDelay => times.contains(&-lower) && times.contains(&upper),
        };
        if !are_bounds {
            return Err(ProblemError::Bounds { quantity, bounds: self.bounds });
        }
        if (0.0..=1e12).contains(&self.alpha) { Ok(()) } else { Err(ProblemError::Alpha { alpha: self.alpha }) }
    }

    /// The objective at these channels (inputs m, outputs p): of squared ratios, of squared dB, or in s².
    pub fn objective_at(&self, inputs: &[f64], outputs: &[f64]) -> f64 {
        let miss = |(pair, delta): (Pair, f64)| self.quantity.miss(delta, outputs[pair.output], inputs[pair.input]);
        let fit: f64 = self.fit_entries().map(|entry| miss(entry).powi(2)).sum();
        // Skipped at alpha = 0, where it would only add rounding.
        if self.alpha == 0.0 {
            return fit;
        }
        let neutral = self.quantity.neutral();
        let departure = |output: &f64| self.quantity.miss(neutral, *output, neutral).powi(2);
        let inputs = if self.quantity.regularises_inputs() { inputs } else { &[] };
        fit + self.alpha * outputs.iter().chain(inputs).map(departure).sum::<f64>()
    }

    /// The entries that count in the objective, with their delta.
    pub(crate) fn fit_entries(&self) -> impl Iterator<Item = (Pair, f64)> + '_ {
        let fitted = self.delta.iter().filter(|(pair, _)| self.fitted[*pair]);
        fitted.filter_map(|(pair, delta)| delta.map(|delta| (pair, delta)))
    }

    /// The held entries, with their delta.
    pub(crate) fn held_entries(&self) -> impl Iterator<Item = (Pair, f64)> + '_ {
        self.constrained.marked().filter_map(|pair| self.delta[pair].map(|delta| (pair, delta)))
    }

    /// The coordinate in which the held entries are sums. Delays are homogeneous: in units of the greatest time of the problem
    /// (one second where every time is 0) every figure is of order 1.
    pub(crate) fn coordinate(&self) -> Coordinate {
        if let Quantity::Gain(_) = self.quantity {
            return Coordinate::Logarithm;
        }
        let asked =
            self.delta.iter().filter_map(|(_, delay)| *delay).fold(0.0_f64, |most, delay| most.max(delay.abs()));
        // A bound far above what any channel could be asked for says nothing about the size of the answer.
        let unit_s = if asked > 0.0 { asked } else { self.bounds.upper.max(-self.bounds.lower) };
        Coordinate::Time { unit_s: if unit_s > 0.0 { unit_s } else { 1.0 } }
    }

    /// Least and greatest coordinate of every channel.
    pub(crate) fn range(&self) -> (f64, f64) {
        let coordinate = self.coordinate();
        let (low, high) = (coordinate.of(self.bounds.lower), coordinate.of(self.bounds.upper));
        match coordinate {
            Coordinate::Logarithm => (low, high),
            // No path of held entries asks a channel for more than one unit each: a bound above that never acts.
            Coordinate::Time { .. } => {
                let most = (self.delta.outputs() + self.delta.inputs()) as f64;
                (low.max(-most), high.min(most))
            }
        }
    }
}
