//! Input mixing `M~` and output feedback `K`, and their application to a frequency response
//! (M16.3): `H~ = (I - H K)^-1 H M~`, where `H` is the physics model's response with `m` inputs and
//! `p` outputs.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::Pair;
use gdcm_model::response::FrequencyResponse;

use super::closed_loop::ClosedLoop;
use super::error::CouplingError;
use super::unknown::Unknown;
use crate::schedule::{Airspeeds, Regression};

/// Input mixing `M(V)`, m x m, and output feedback `K`, m x p: `y = H (u' + K y)`, `u' = M~(V) u`,
/// where `M~` is the normalised mixing ([`CouplingMatrices::normalised_mixing`]).
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingMatrices {
    airspeeds: Airspeeds,
    /// `M`, row by row: polynomials in the scaled airspeed.
    mixing: Vec<Regression>,
    feedback: DMatrix<f64>,
}

impl CouplingMatrices {
    /// Returns `M = I` and `K = 0` for m inputs and p outputs.
    pub fn none(airspeeds: Airspeeds, inputs: usize, outputs: usize) -> Self {
        let mut mixing = Vec::with_capacity(inputs * inputs);
        for to in 0..inputs {
            for from in 0..inputs {
                mixing.push(Regression::Polynomial {
                    coefficients: vec![if to == from { 1.0 } else { 0.0 }],
                });
            }
        }
        Self {
            airspeeds,
            mixing,
            feedback: DMatrix::zeros(inputs, outputs),
        }
    }

    /// Returns a copy with new values for the unknowns. For each entry in `M`, the unknowns list
    /// the airspeed powers in ascending order from 0. Entries that are not among the unknowns are
    /// 0.
    #[must_use]
    pub fn with(&self, unknowns: &[Unknown], values: &[f64]) -> Self {
        let (inputs, outputs) = self.feedback.shape();
        let mut mixing = vec![Vec::new(); inputs * inputs];
        let mut feedback = DMatrix::zeros(inputs, outputs);
        for (unknown, &value) in unknowns.iter().zip(values) {
            match *unknown {
                Unknown::Mixing { to, from, .. } => mixing[to * inputs + from].push(value),
                Unknown::Feedback { input, output } => feedback[(input, output)] = value,
            }
        }
        Self {
            airspeeds: self.airspeeds.clone(),
            mixing: mixing
                .into_iter()
                .map(|coefficients| Regression::Polynomial { coefficients })
                .collect(),
            feedback,
        }
    }

    /// Checks that the mixing preserves every input's sign at the conditions' airspeeds.
    ///
    /// # Errors
    /// [`CouplingError::ReversedInput`] for the first input whose factor `M_ii` is not positive.
    pub(super) fn check(&self) -> Result<(), CouplingError> {
        for &airspeed_kt in &self.airspeeds.values_kt {
            let diagonal = self.mixing(airspeed_kt).diagonal();
            for (input, &factor) in diagonal.iter().enumerate() {
                if factor.is_nan() || factor <= 0.0 {
                    return Err(CouplingError::ReversedInput {
                        input: input + 1,
                        airspeed_kt,
                        factor,
                    });
                }
            }
        }
        Ok(())
    }

    /// Returns the airspeeds of the fitted conditions.
    pub fn airspeeds(&self) -> &Airspeeds {
        &self.airspeeds
    }

    /// Returns `M_to,from` as a function of the scaled airspeed, see
    /// [`CouplingMatrices::airspeeds`].
    pub fn mixing_curve(&self, to: usize, from: usize) -> &Regression {
        &self.mixing[to * self.feedback.nrows() + from]
    }

    /// Returns `M(V)`, m x m, `[to, from]`; constant outside the conditions' airspeed range.
    pub fn mixing(&self, airspeed_kt: f64) -> DMatrix<f64> {
        let inputs = self.feedback.nrows();
        DMatrix::from_fn(inputs, inputs, |to, from| {
            self.mixing[to * inputs + from].at(&self.airspeeds, airspeed_kt)
        })
    }

    /// Returns `M~(V) = M(V) diag(M(V))^-1`, m x m. Its diagonal entries are 1, because each
    /// input's gain belongs to the channel correction.
    pub fn normalised_mixing(&self, airspeed_kt: f64) -> DMatrix<f64> {
        let mixing = self.mixing(airspeed_kt);
        DMatrix::from_fn(mixing.nrows(), mixing.ncols(), |to, from| {
            if to == from {
                1.0
            } else {
                mixing[(to, from)] / mixing[(from, from)]
            }
        })
    }

    /// Returns `K`, m x p, `[input, output]`, in input units per output unit.
    pub fn feedback(&self) -> &DMatrix<f64> {
        &self.feedback
    }

    /// Computes `H~ = (I - H K)^-1 H M~(V)` at every frequency, p x m.
    ///
    /// Not finite if `I - H K` is singular, or if `H` lacks a fed-back response. If `H` lacks a
    /// response in an output that is not fed back, only this output's responses are not finite.
    #[must_use]
    pub fn response(&self, physics: &FrequencyResponse, airspeed_kt: f64) -> FrequencyResponse {
        let inputs = physics.inputs();
        let outputs = physics.outputs();
        let mixing = self.normalised_mixing(airspeed_kt);
        let mut closed_loop = ClosedLoop::new(&self.feedback);
        let mut coupled = physics.curves().clone();
        // `H`, then `(I - H K)^-1 H`, at a frequency, column by column.
        let mut closed = vec![Complex::new(0.0, 0.0); inputs * outputs];
        for k in 0..physics.curve(Pair::new(0, 0)).len() {
            let lacking = self.read_columns(physics, k, &mut closed);
            let is_closed = closed_loop.close(&mut closed);
            for (pair, curve) in coupled.iter_mut() {
                curve[k] = if is_closed && !lacking.contains(&pair.output) {
                    (0..inputs)
                        .map(|to| closed[to * outputs + pair.output] * mixing[(to, pair.input)])
                        .sum()
                } else {
                    Complex::new(f64::NAN, f64::NAN)
                };
            }
        }
        FrequencyResponse::new(coupled)
    }

    /// Writes `H` at frequency index `k` to `columns`, column by column. Returns the outputs that
    /// lack a response and are not fed back; their values are set to zero, which does not affect
    /// the other outputs.
    fn read_columns(
        &self,
        physics: &FrequencyResponse,
        k: usize,
        columns: &mut [Complex<f64>],
    ) -> Vec<usize> {
        let inputs = physics.inputs();
        let outputs = physics.outputs();
        let mut lacking = Vec::new();
        for output in 0..outputs {
            let is_fed_back = self
                .feedback
                .column(output)
                .iter()
                .any(|entry| *entry != 0.0);
            let is_lacking = !is_fed_back
                && (0..inputs).any(|input| !physics.curve(Pair::new(output, input))[k].is_finite());
            for input in 0..inputs {
                columns[input * outputs + output] = if is_lacking {
                    Complex::new(0.0, 0.0)
                } else {
                    physics.curve(Pair::new(output, input))[k]
                };
            }
            if is_lacking {
                lacking.push(output);
            }
        }
        lacking
    }
}
