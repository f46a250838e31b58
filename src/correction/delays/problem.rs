//! What the channel delays are asked to do.

use crate::dataset::{Pair, PairTable};

/// The delays that a condition's correction is to have (M9). All times in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayProblem {
    /// Delta delay `D` of each response, p x m; `None` where the response has none: it is left out of the objective.
    pub wanted_s: PairTable<Option<f64>>,
    /// Entries whose sum `tau_o + tau_i` is to be held at `D`, p x m.
    pub constrained: PairTable<bool>,
    /// Entries that count in the objective (`w = 1`), p x m.
    pub fitted: PairTable<bool>,
    /// Greatest delay of every channel; the least is 0.
    pub upper_s: f64,
    /// Weight of the output delays; `alpha = 0` stands for the limit `alpha -> 0+`.
    pub alpha: f64,
}

/// Why delays cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DelayError {
    /// A table has another shape than the wanted delays.
    #[error(
        "the table of {table} entries has {outputs} outputs and {inputs} inputs, but the delays have {wanted_outputs} and {wanted_inputs}"
    )]
    Shape {
        /// Which table.
        table: &'static str,
        /// Its number of outputs.
        outputs: usize,
        /// Its number of inputs.
        inputs: usize,
        /// Number of outputs of the wanted delays.
        wanted_outputs: usize,
        /// Number of inputs of the wanted delays.
        wanted_inputs: usize,
    },
    /// A held entry has no delta delay.
    #[error("the response of output {} to input {} has no delta delay, so its delay cannot be held", pair.output + 1, pair.input + 1)]
    ConstrainedUndefined {
        /// The entry.
        pair: Pair,
    },
    /// A delta delay is not a time.
    #[error("the delta delay of output {} and input {} is {delay_s} s; it must be a number below 1e50 s", pair.output + 1, pair.input + 1)]
    Delay {
        /// The entry.
        pair: Pair,
        /// Its delta delay.
        delay_s: f64,
    },
    /// The upper bound is negative or not a number.
    #[error("the upper bound of the delays is {upper_s} s; it must be a number from 0 to 1e50 s")]
    Upper {
        /// The bound.
        upper_s: f64,
    },
    /// `alpha` is negative or not a number.
    #[error("alpha is {alpha}; it must be a number from 0 to 1e12")]
    Alpha {
        /// The weight.
        alpha: f64,
    },
    /// The quadratic program was not solved.
    #[error("the quadratic program of the delays was not solved: {reason}")]
    Program {
        /// What the solver says.
        reason: String,
    },
}

impl DelayProblem {
    /// The problem of equation (11) that fits every entry, with `alpha = 1`.
    pub fn new(wanted_s: PairTable<Option<f64>>, constrained: PairTable<bool>, upper_s: f64) -> Self {
        let fitted = PairTable::filled(wanted_s.outputs(), wanted_s.inputs(), true);
        Self { wanted_s, constrained, fitted, upper_s, alpha: 1.0 }
    }

    /// Checks shapes and figures.
    ///
    /// # Errors
    /// The first [`DelayError`] found.
    pub fn check(&self) -> Result<(), DelayError> {
        let (wanted_outputs, wanted_inputs) = (self.wanted_s.outputs(), self.wanted_s.inputs());
        for (table, entries) in [("constrained", &self.constrained), ("fitted", &self.fitted)] {
            let (outputs, inputs) = (entries.outputs(), entries.inputs());
            if (outputs, inputs) != (wanted_outputs, wanted_inputs) {
                return Err(DelayError::Shape { table, outputs, inputs, wanted_outputs, wanted_inputs });
            }
        }
        for (pair, delay_s) in self.wanted_s.iter() {
            match delay_s {
                Some(delay_s) if !(-1e50..=1e50).contains(delay_s) => {
                    return Err(DelayError::Delay { pair, delay_s: *delay_s });
                }
                None if self.constrained[pair] => return Err(DelayError::ConstrainedUndefined { pair }),
                _ => {}
            }
        }
        if !(0.0..=1e50).contains(&self.upper_s) {
            return Err(DelayError::Upper { upper_s: self.upper_s });
        }
        if !(0.0..=1e12).contains(&self.alpha) {
            return Err(DelayError::Alpha { alpha: self.alpha });
        }
        Ok(())
    }

    /// The objective in s² at these channel delays in seconds (inputs m, outputs p).
    pub fn objective_at(&self, inputs_s: &[f64], outputs_s: &[f64]) -> f64 {
        let error = |(pair, wanted): (Pair, f64)| (wanted - outputs_s[pair.output] - inputs_s[pair.input]).powi(2);
        let fit: f64 = self.fit_entries().map(error).sum();
        fit + self.alpha * outputs_s.iter().map(|delay| delay * delay).sum::<f64>()
    }

    /// The entries that count in the objective, with their wanted delay.
    pub(crate) fn fit_entries(&self) -> impl Iterator<Item = (Pair, f64)> + '_ {
        self.wanted_s
            .iter()
            .filter(|(pair, _)| self.fitted[*pair])
            .filter_map(|(pair, delay)| delay.map(|delay| (pair, delay)))
    }

    /// The held entries, with their wanted delay.
    pub(crate) fn held_entries(&self) -> impl Iterator<Item = (Pair, f64)> + '_ {
        self.constrained.marked().filter_map(|pair| self.wanted_s[pair].map(|delay| (pair, delay)))
    }
}
