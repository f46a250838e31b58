//! A mixing of the inputs and a feedback of the outputs, and what they make of a frequency response (M16.3).

use nalgebra::{Complex, DMatrix};

use super::{ClosedLoop, CouplingError, Unknown};
use crate::dataset::Pair;
use crate::response::FrequencyResponse;
use crate::schedule::{Airspeeds, Regression};

/// `M(V)`, m x m, and `K`, m x p: `y = H (u' + K y)`, `u' = M~(V) u`.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingMatrices {
    airspeeds: Airspeeds,
    /// `M`, row by row: polynomials in the scaled airspeed.
    mixing: Vec<Regression>,
    feedback: DMatrix<f64>,
}

impl CouplingMatrices {
    /// `M = I`, `K = 0`, of m inputs and p outputs.
    pub fn none(airspeeds: Airspeeds, inputs: usize, outputs: usize) -> Self {
        let unit = |to: usize, from: usize| if to == from { 1.0 } else { 0.0 };
        let polynomial =
            |entry: usize| Regression::Polynomial { coefficients: vec![unit(entry / inputs, entry % inputs)] };
        Self {
            airspeeds,
            mixing: (0..inputs * inputs).map(polynomial).collect(),
            feedback: DMatrix::zeros(inputs, outputs),
        }
    }

    /// The same with the unknowns at these values, of each entry of `M` every power of the airspeed from 0 on; what is not among the
    /// unknowns is 0.
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
        let polynomial = |coefficients| Regression::Polynomial { coefficients };
        Self { airspeeds: self.airspeeds.clone(), mixing: mixing.into_iter().map(polynomial).collect(), feedback }
    }

    /// Whether every input goes through the mixing with its own sign at the airspeeds of the conditions.
    ///
    /// # Errors
    /// [`CouplingError::ReversedInput`] of the first that does not.
    pub(super) fn check(&self) -> Result<(), CouplingError> {
        for &airspeed_kt in &self.airspeeds.values_kt {
            let diagonal = self.mixing(airspeed_kt).diagonal();
            if let Some(input) = diagonal.iter().position(|factor| factor.is_nan() || *factor <= 0.0) {
                return Err(CouplingError::ReversedInput { input: input + 1, airspeed_kt, factor: diagonal[input] });
            }
        }
        Ok(())
    }

    /// The airspeeds of the conditions that they were fitted to.
    pub fn airspeeds(&self) -> &Airspeeds {
        &self.airspeeds
    }

    /// `M_to,from` over the scaled airspeed of [`CouplingMatrices::airspeeds`].
    pub fn mixing_curve(&self, to: usize, from: usize) -> &Regression {
        &self.mixing[to * self.feedback.nrows() + from]
    }

    /// `M(V)`, m x m, `[to, from]`; outside the conditions' airspeeds that of the nearer end.
    pub fn mixing(&self, airspeed_kt: f64) -> DMatrix<f64> {
        let inputs = self.feedback.nrows();
        DMatrix::from_fn(inputs, inputs, |to, from| self.mixing[to * inputs + from].at(&self.airspeeds, airspeed_kt))
    }

    /// `M~(V) = M(V) diag(M(V))^-1`, m x m: ones on the diagonal, so that the level stays with the channels.
    pub fn normalised_mixing(&self, airspeed_kt: f64) -> DMatrix<f64> {
        let mixing = self.mixing(airspeed_kt);
        DMatrix::from_fn(mixing.nrows(), mixing.ncols(), |to, from| {
            if to == from { 1.0 } else { mixing[(to, from)] / mixing[(from, from)] }
        })
    }

    /// `K`, m x p, `[input, output]`: units of the input for each unit of the output.
    pub fn feedback(&self) -> &DMatrix<f64> {
        &self.feedback
    }

    /// `H~ = (I - H K)^-1 H M~(V)` at every frequency of `H`, p x m.
    ///
    /// Not finite where `I - H K` is singular, or `H` lacks a response of an output that is fed back; an output of which `H` lacks a
    /// response and that is not fed back has none.
    #[must_use]
    pub fn response(&self, physics: &FrequencyResponse, airspeed_kt: f64) -> FrequencyResponse {
        let (inputs, outputs) = (physics.inputs(), physics.outputs());
        let mixing = self.normalised_mixing(airspeed_kt);
        let mut closed_loop = ClosedLoop::new(&self.feedback);
        let mut coupled = physics.curves().clone();
        let mut f = vec![Complex::new(0.0, 0.0); inputs * outputs];
        for k in 0..physics.curve(Pair::new(0, 0)).len() {
            let lacking = self.fill(physics, k, &mut f);
            let is_closed = closed_loop.close(&mut f);
            for (pair, curve) in coupled.iter_mut() {
                let terms = (0..inputs).map(|to| f[to * outputs + pair.output] * mixing[(to, pair.input)]);
                let is_known = is_closed && !lacking.contains(&pair.output);
                curve[k] = if is_known { terms.sum() } else { Complex::new(f64::NAN, f64::NAN) };
            }
        }
        FrequencyResponse::new(coupled)
    }

    /// `H` at a frequency, column by column; returns the outputs that lack a response and are not fed back, which stand as zeros: they
    /// change nothing of the others.
    fn fill(&self, physics: &FrequencyResponse, k: usize, columns: &mut [Complex<f64>]) -> Vec<usize> {
        let outputs = physics.outputs();
        let mut lacking = Vec::new();
        for output in 0..outputs {
            let row = (0..physics.inputs()).map(|input| physics.curve(Pair::new(output, input))[k]);
            let is_free = self.feedback.column(output).iter().all(|entry| *entry == 0.0);
            let is_lacking = is_free && row.clone().any(|value| !value.is_finite());
            for (input, value) in row.enumerate() {
                columns[input * outputs + output] = if is_lacking { Complex::new(0.0, 0.0) } else { value };
            }
            if is_lacking {
                lacking.push(output);
            }
        }
        lacking
    }
}
