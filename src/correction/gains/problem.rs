//! What the channel gains are asked to do.

use crate::dataset::{Pair, PairTable};

/// Least and greatest gain of every channel (M7): `0 < lower <= upper`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainBounds {
    /// Least channel gain.
    pub lower: f64,
    /// Greatest channel gain.
    pub upper: f64,
}

/// What "close to the wanted gain" means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GainObjective {
    /// `sum w (G - k_o k_i)^2 + alpha sum (k_o - 1)^2`, equation (7) of the paper.
    #[default]
    Ratio,
    /// `sum w (20 log10 G - 20 log10 k_o k_i)^2 + alpha sum (20 log10 k_o)^2`: errors up and down count alike, and an entry with
    /// a large `G` counts no more than another. Convex.
    Decibel,
}

/// The gains that a condition's correction is to have (M8).
#[derive(Clone, Debug, PartialEq)]
pub struct GainProblem {
    /// Delta gain `G` of each response, p x m; `None` where the response has none: it is left out of the objective.
    pub wanted: PairTable<Option<f64>>,
    /// Entries whose product `k_o k_i` is to be held at `G`, p x m.
    pub constrained: PairTable<bool>,
    /// Entries that count in the objective (`w = 1`), p x m.
    pub fitted: PairTable<bool>,
    /// Bounds of every channel gain.
    pub bounds: GainBounds,
    /// Weight of the departure of the output gains from 1; `alpha = 0` stands for the limit `alpha -> 0+`.
    pub alpha: f64,
    /// Which departure is minimised.
    pub objective: GainObjective,
}

/// Why gains cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GainError {
    /// A table has another shape than the wanted gains.
    #[error(
        "the table of {table} entries has {outputs} outputs and {inputs} inputs, but the gains have {wanted_outputs} and {wanted_inputs}"
    )]
    Shape {
        /// Which table.
        table: &'static str,
        /// Its number of outputs.
        outputs: usize,
        /// Its number of inputs.
        inputs: usize,
        /// Number of outputs of the wanted gains.
        wanted_outputs: usize,
        /// Number of inputs of the wanted gains.
        wanted_inputs: usize,
    },
    /// A held entry has no delta gain.
    #[error("the response of output {} to input {} has no delta gain, so its gain cannot be held", pair.output + 1, pair.input + 1)]
    ConstrainedUndefined {
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
    /// The bounds are not `0 < lower <= upper`.
    #[error(
        "the gain bounds {lower} and {upper} must be positive (1e-50 to 1e50), the lower one not above the upper one"
    )]
    Bounds {
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// `alpha` is negative or not a number.
    #[error("alpha is {alpha}; it must be a number from 0 to 1e12")]
    Alpha {
        /// The weight.
        alpha: f64,
    },
}

/// Delta gains outside of this range overflow when squared and summed.
const GAINS: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// Bounds outside of this range (180 dB) overflow in the products of the search for a proof.
const BOUNDS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

impl GainProblem {
    /// The problem of equation (7) that fits every entry: `alpha = 1`, the paper's objective.
    pub fn new(wanted: PairTable<Option<f64>>, constrained: PairTable<bool>, bounds: GainBounds) -> Self {
        let fitted = PairTable::filled(wanted.outputs(), wanted.inputs(), true);
        Self { wanted, constrained, fitted, bounds, alpha: 1.0, objective: GainObjective::Ratio }
    }

    /// Checks shapes and figures.
    ///
    /// # Errors
    /// The first [`GainError`] found.
    pub fn check(&self) -> Result<(), GainError> {
        let (wanted_outputs, wanted_inputs) = (self.wanted.outputs(), self.wanted.inputs());
        for (table, entries) in [("constrained", &self.constrained), ("fitted", &self.fitted)] {
            let (outputs, inputs) = (entries.outputs(), entries.inputs());
            if (outputs, inputs) != (wanted_outputs, wanted_inputs) {
                return Err(GainError::Shape { table, outputs, inputs, wanted_outputs, wanted_inputs });
            }
        }
        for (pair, gain) in self.wanted.iter() {
            match gain {
                Some(gain) if !GAINS.contains(gain) => return Err(GainError::Gain { pair, gain: *gain }),
                None if self.constrained[pair] => return Err(GainError::ConstrainedUndefined { pair }),
                _ => {}
            }
        }
        let GainBounds { lower, upper } = self.bounds;
        if !(BOUNDS.contains(&lower) && BOUNDS.contains(&upper) && lower <= upper) {
            return Err(GainError::Bounds { lower, upper });
        }
        if !(0.0..=1e12).contains(&self.alpha) {
            return Err(GainError::Alpha { alpha: self.alpha });
        }
        Ok(())
    }

    /// The objective at these channel gains (inputs m, outputs p).
    pub fn objective_at(&self, inputs: &[f64], outputs: &[f64]) -> f64 {
        let error = |wanted: f64, gain: f64| match self.objective {
            GainObjective::Ratio => (wanted - gain).powi(2),
            GainObjective::Decibel => (20.0 * (wanted / gain).log10()).powi(2),
        };
        let fit: f64 =
            self.fit_entries().map(|(pair, wanted)| error(wanted, outputs[pair.output] * inputs[pair.input])).sum();
        // Skipped at alpha = 0, where it would only add rounding.
        if self.alpha == 0.0 {
            fit
        } else {
            fit + self.alpha * outputs.iter().map(|gain| error(1.0, *gain)).sum::<f64>()
        }
    }

    /// The entries that count in the objective, with their wanted gain.
    pub(crate) fn fit_entries(&self) -> impl Iterator<Item = (Pair, f64)> + '_ {
        self.wanted
            .iter()
            .filter(|(pair, _)| self.fitted[*pair])
            .filter_map(|(pair, gain)| gain.map(|gain| (pair, gain)))
    }

    /// The held entries, with their wanted gain.
    pub(crate) fn held_entries(&self) -> impl Iterator<Item = (Pair, f64)> + '_ {
        self.constrained.marked().filter_map(|pair| self.wanted[pair].map(|gain| (pair, gain)))
    }
}
