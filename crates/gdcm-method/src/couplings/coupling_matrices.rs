//! Input mixing and output feedback, and their effect on a frequency response and on a model
//! (M16.3).
//!
//! The output-to-input loop is closed around a response frequency by frequency:
//!
//! ```text
//! F = (I - H K)^-1 H = H (I - K H)^-1: of the two inverses the one of m x m
//! 1  T <- I - K H
//! 2  for each row j of T: the column of the largest |T_jk|, k >= j, comes to place j, and the columns k > j lose that multiple of it
//!       which makes their T_jk zero; the columns of H with those of T
//! 3  for each column j from the last: divided by T_jj; the columns k < j lose T_jk times it
//! ```
//!
//! Gaussian elimination with partial pivoting, on columns: Golub & Van Loan, "Matrix Computations",
//! 4th ed. 2013, 3.4.

use nalgebra::{Complex, DMatrix, Dyn, LU};

use gdcm_model::dataset::state_space::{StateSpaceError, Timing};
use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::response::FrequencyResponse;
use gdcm_model::units::number;

use super::problem::{CouplingError, Unknown};
use crate::correction::corrected_model::{CorrectedModel, CorrectedModelError};
use crate::correction::{ChannelCorrection, Pade};
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
    /// Returns `M = I`, `K = 0` for m inputs and p outputs.
    pub fn none(airspeeds: Airspeeds, inputs: usize, outputs: usize) -> Self {
        let unit = |to: usize, from: usize| if to == from { 1.0 } else { 0.0 };
        let polynomial = |entry: usize| Regression::Polynomial {
            coefficients: vec![unit(entry / inputs, entry % inputs)],
        };
        Self {
            airspeeds,
            mixing: (0..inputs * inputs).map(polynomial).collect(),
            feedback: DMatrix::zeros(inputs, outputs),
        }
    }

    /// Returns a copy with these values for the unknowns: for each entry of `M` every power of the
    /// airspeed from 0 up. Entries that are not among the unknowns are 0.
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
        Self {
            airspeeds: self.airspeeds.clone(),
            mixing: mixing.into_iter().map(polynomial).collect(),
            feedback,
        }
    }

    /// Checks that the mixing keeps the sign of every input at the airspeeds of the conditions.
    ///
    /// # Errors
    /// [`CouplingError::ReversedInput`] for the first input that is reversed.
    pub(super) fn check(&self) -> Result<(), CouplingError> {
        for &airspeed_kt in &self.airspeeds.values_kt {
            let diagonal = self.mixing(airspeed_kt).diagonal();
            if let Some(input) = diagonal
                .iter()
                .position(|factor| factor.is_nan() || *factor <= 0.0)
            {
                return Err(CouplingError::ReversedInput {
                    input: input + 1,
                    airspeed_kt,
                    factor: diagonal[input],
                });
            }
        }
        Ok(())
    }

    /// Returns the airspeeds of the fitted conditions.
    pub fn airspeeds(&self) -> &Airspeeds {
        &self.airspeeds
    }

    /// Returns `M_to,from` over the scaled airspeed of [`CouplingMatrices::airspeeds`].
    pub fn mixing_curve(&self, to: usize, from: usize) -> &Regression {
        &self.mixing[to * self.feedback.nrows() + from]
    }

    /// Returns `M(V)`, m x m, `[to, from]`, constant beyond the range of the conditions' airspeeds.
    pub fn mixing(&self, airspeed_kt: f64) -> DMatrix<f64> {
        let inputs = self.feedback.nrows();
        DMatrix::from_fn(inputs, inputs, |to, from| {
            self.mixing[to * inputs + from].at(&self.airspeeds, airspeed_kt)
        })
    }

    /// Returns `M~(V) = M(V) diag(M(V))^-1`, m x m: ones on the diagonal, since the gain level
    /// belongs to the channels.
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

    /// Computes `H~ = (I - H K)^-1 H M~(V)` at every frequency of `H`, p x m.
    ///
    /// Not finite where `I - H K` is singular or `H` lacks a response of an output that is fed
    /// back. An output with a missing response that is not fed back stays without a response.
    #[must_use]
    pub fn response(&self, physics: &FrequencyResponse, airspeed_kt: f64) -> FrequencyResponse {
        let inputs = physics.inputs();
        let outputs = physics.outputs();
        let mixing = self.normalised_mixing(airspeed_kt);
        let mut closed_loop = ClosedLoop::new(&self.feedback);
        let mut coupled = physics.curves().clone();
        let mut f = vec![Complex::new(0.0, 0.0); inputs * outputs];
        for k in 0..physics.curve(Pair::new(0, 0)).len() {
            let lacking = self.fill(physics, k, &mut f);
            let is_closed = closed_loop.close(&mut f);
            for (pair, curve) in coupled.iter_mut() {
                let terms =
                    (0..inputs).map(|to| f[to * outputs + pair.output] * mixing[(to, pair.input)]);
                let is_known = is_closed && !lacking.contains(&pair.output);
                curve[k] = if is_known {
                    terms.sum()
                } else {
                    Complex::new(f64::NAN, f64::NAN)
                };
            }
        }
        FrequencyResponse::new(coupled)
    }

    /// Writes `H` at one frequency, column by column; returns the outputs that lack a response and
    /// are not fed back. Their values are zeros, which do not affect the other outputs.
    fn fill(
        &self,
        physics: &FrequencyResponse,
        k: usize,
        columns: &mut [Complex<f64>],
    ) -> Vec<usize> {
        let outputs = physics.outputs();
        let mut lacking = Vec::new();
        for output in 0..outputs {
            let row = (0..physics.inputs()).map(|input| physics.curve(Pair::new(output, input))[k]);
            let is_free = self
                .feedback
                .column(output)
                .iter()
                .all(|entry| *entry == 0.0);
            let is_lacking = is_free && row.clone().any(|value| !value.is_finite());
            for (input, value) in row.enumerate() {
                columns[input * outputs + output] = if is_lacking {
                    Complex::new(0.0, 0.0)
                } else {
                    value
                };
            }
            if is_lacking {
                lacking.push(output);
            }
        }
        lacking
    }
}

/// Closes `u = u' + K y` around responses of p outputs and m inputs; reuses its work memory.
pub(super) struct ClosedLoop<'a> {
    /// `K`, m x p.
    feedback: &'a DMatrix<f64>,
    is_open: bool,
    /// `T`, m x m, column by column.
    difference: Vec<Complex<f64>>,
}

impl<'a> ClosedLoop<'a> {
    /// Creates the loop of a feedback `K`, m x p.
    pub(super) fn new(feedback: &'a DMatrix<f64>) -> Self {
        let inputs = feedback.nrows();
        let is_open = feedback.iter().all(|entry| *entry == 0.0);
        Self {
            feedback,
            is_open,
            difference: vec![Complex::new(0.0, 0.0); inputs * inputs],
        }
    }

    /// Replaces `H` (p x m, column by column) by `F = (I - H K)^-1 H`; returns false if the result
    /// is not finite.
    pub(super) fn close(&mut self, response: &mut [Complex<f64>]) -> bool {
        if self.is_open {
            return response.iter().all(|value| value.is_finite());
        }
        self.return_difference(response);
        let inputs = self.feedback.nrows();
        (0..inputs).all(|column| self.eliminate(column, response)) && self.substitute_back(response)
    }

    /// Computes `T = I - K H`.
    fn return_difference(&mut self, response: &[Complex<f64>]) {
        let (inputs, outputs) = self.feedback.shape();
        for (column, of_input) in response.chunks_exact(outputs).enumerate() {
            for row in 0..inputs {
                let sum: Complex<f64> = of_input
                    .iter()
                    .enumerate()
                    .map(|(output, value)| value * self.feedback[(row, output)])
                    .sum();
                let unit = if row == column { 1.0 } else { 0.0 };
                self.difference[column * inputs + row] = Complex::from(unit) - sum;
            }
        }
    }

    /// Eliminates row `at` from the columns after column `at`; returns false without a pivot.
    fn eliminate(&mut self, at: usize, response: &mut [Complex<f64>]) -> bool {
        let (inputs, outputs) = self.feedback.shape();
        let size = |column: &usize| self.difference[column * inputs + at].norm_sqr();
        let Some(pivot) = (at..inputs).max_by(|a, b| size(a).total_cmp(&size(b))) else {
            return false;
        };
        let is_usable = size(&pivot).is_finite() && size(&pivot) > 0.0;
        for row in 0..inputs {
            self.difference
                .swap(at * inputs + row, pivot * inputs + row);
        }
        for output in 0..outputs {
            response.swap(at * outputs + output, pivot * outputs + output);
        }
        let divisor = self.difference[at * inputs + at].inv();
        for column in at + 1..inputs {
            let factor = self.difference[column * inputs + at] * divisor;
            subtract(&mut self.difference, inputs, (column, at), factor);
            subtract(response, outputs, (column, at), factor);
        }
        is_usable
    }

    /// Reduces the triangular `T` to the identity; returns false if a value is not finite.
    fn substitute_back(&mut self, response: &mut [Complex<f64>]) -> bool {
        let (inputs, outputs) = self.feedback.shape();
        for column in (0..inputs).rev() {
            let divisor = self.difference[column * inputs + column].inv();
            response[column * outputs..][..outputs]
                .iter_mut()
                .for_each(|value| *value *= divisor);
            for before in 0..column {
                let factor = self.difference[before * inputs + column];
                subtract(response, outputs, (before, column), factor);
            }
        }
        response.iter().all(|value| value.is_finite())
    }
}

/// Subtracts `factor` times column `of` from column `from`; columns of `rows` entries.
fn subtract(
    columns: &mut [Complex<f64>],
    rows: usize,
    (from, of): (usize, usize),
    factor: Complex<f64>,
) {
    for row in 0..rows {
        let part = columns[of * rows + row] * factor;
        columns[from * rows + row] -= part;
    }
}

/// Condition number of `I - D K` beyond which a loop through the feed-through is refused.
const WORST_CONDITION: f64 = 1e6;

/// Reasons why mixing and feedback cannot be applied to a model as matrices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CoupledModelError {
    /// The algebraic loop through the feed-through cannot be closed.
    #[error(
        "the feedback through its feed-through cannot be computed with: the condition number of I − D K is {}, and at most \
         {WORST_CONDITION:e} is allowed",
        number(*condition_number)
    )]
    AlgebraicLoop {
        /// Condition number of `I - D K`; infinite where it is singular.
        condition_number: f64,
    },
    /// The channels of the model differ from those of the couplings.
    #[error(
        "it has {} outputs and {} inputs, and the couplings are of {} and {}", found.0, found.1, expected.0, expected.1
    )]
    Channels {
        /// Numbers of outputs and inputs of the model.
        found: (usize, usize),
        /// Numbers of outputs and inputs of the couplings.
        expected: (usize, usize),
    },
    /// The channel delays inside the loop cannot become states.
    #[error(transparent)]
    Delays(#[from] CorrectedModelError),
    /// A product is not finite.
    #[error(transparent)]
    Matrices(#[from] StateSpaceError),
}

impl CoupledModelError {
    /// Returns the reason with channel names.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        match self {
            Self::Delays(error) => error.words(inputs, outputs),
            other => other.to_string(),
        }
    }
}

impl CouplingMatrices {
    /// Builds the physics model with mixing and feedback, in continuous or discrete time. Channel
    /// delays, which lie inside the loop, become states first: Padé approximants `pade`, or whole
    /// samples.
    ///
    /// ```text
    /// K~ = K (I - D K)^-1
    /// A' = A + B K~ C,             B' = B (I + K~ D) M~
    /// C' = (I - D K)^-1 C,         D' = (I - D K)^-1 D M~
    /// ```
    ///
    /// # Errors
    /// [`CoupledModelError`] if the condition number of `I - D K` exceeds 1e6, the channels differ,
    /// the delays cannot become states, or a product is not finite.
    pub fn model(
        &self,
        physics: &StateSpace,
        airspeed_kt: f64,
        pade: Pade,
    ) -> Result<StateSpace, CoupledModelError> {
        let (inputs, outputs) = self.feedback.shape();
        let found = (physics.outputs(), physics.inputs());
        let expected = (outputs, inputs);
        if found != expected {
            return Err(CoupledModelError::Channels { found, expected });
        }
        let physics = without_delays(physics, pade)?;
        let a = physics.a();
        let b = physics.b();
        let c = physics.c();
        let d = physics.d();
        let k = self.feedback();
        let mixing = self.normalised_mixing(airspeed_kt);
        let algebraic = algebraic_loop(d, k)?;
        let refused = || CoupledModelError::AlgebraicLoop {
            condition_number: f64::INFINITY,
        };
        let c_closed = algebraic.solve(c).ok_or_else(refused)?;
        let d_closed = algebraic.solve(d).ok_or_else(refused)?;
        // K~ C = K (I - D K)^-1 C, and likewise with D.
        let a_closed = a + b * (k * &c_closed);
        let b_closed = (b + b * (k * &d_closed)) * &mixing;
        let model = StateSpace::new(a_closed, b_closed, c_closed, d_closed * mixing)?;
        Ok(model.timed(physics.timing().clone())?)
    }
}

/// Returns `I - D K` with its factors.
fn algebraic_loop(
    d: &DMatrix<f64>,
    k: &DMatrix<f64>,
) -> Result<LU<f64, Dyn, Dyn>, CoupledModelError> {
    let difference = DMatrix::identity(d.nrows(), d.nrows()) - d * k;
    let singular = difference.clone().svd(false, false).singular_values;
    let condition_number = singular.max() / singular.min();
    // True for NaN as well, where D K overflows.
    if !condition_number.le(&WORST_CONDITION) {
        return Err(CoupledModelError::AlgebraicLoop { condition_number });
    }
    Ok(difference.lu())
}

/// Returns the model with its channel delays as states.
///
/// # Errors
/// A Padé approximant with more states than a model may have.
pub fn without_delays(physics: &StateSpace, pade: Pade) -> Result<StateSpace, CorrectedModelError> {
    let timing = Timing {
        sample_time_s: physics.timing().sample_time_s,
        ..Timing::default()
    };
    if *physics.timing() == timing {
        return Ok(physics.clone());
    }
    let inputs = physics.inputs();
    let outputs = physics.outputs();
    let no_correction = ChannelCorrection {
        input_gains: vec![1.0; inputs],
        output_gains: vec![1.0; outputs],
        input_delays_s: vec![0.0; inputs],
        output_delays_s: vec![0.0; outputs],
        leads: None,
    };
    Ok(CorrectedModel::new(physics, &no_correction, pade)?.model)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_loop_is_the_inverse_of_the_textbook() {
        let value = |k: usize| Complex::new((1.0 + k as f64).sin(), (2.0 + 3.0 * k as f64).cos());
        let h = DMatrix::from_fn(3, 2, |row, column| value(3 * column + row));
        let k = nalgebra::dmatrix![0.4, -1.1, 0.3; 2.0, 0.7, -0.6];
        let mut f: Vec<Complex<f64>> = h.iter().copied().collect();
        assert!(ClosedLoop::new(&k).close(&mut f));
        let loop_gain = &h * k.map(Complex::from);
        let expected = (DMatrix::identity(3, 3) - loop_gain).try_inverse().unwrap() * &h;
        // Two eliminations with condition numbers below ten.
        assert!(
            f.iter()
                .zip(&expected)
                .all(|(found, expected)| (found - expected).norm() < 1e-13)
        );
    }

    #[test]
    fn a_loop_of_gain_one_cannot_be_closed() {
        let k = nalgebra::dmatrix![0.5];
        assert!(!ClosedLoop::new(&k).close(&mut [Complex::new(2.0, 0.0)]));
        assert!(ClosedLoop::new(&nalgebra::dmatrix![0.0]).close(&mut [Complex::new(2.0, 0.0)]));
    }
}
