//! The frequency response of a model on a grid.

use nalgebra::Complex;

use crate::dataset::{Dynamics, PairTable, StateSpace};

use super::frequency_grid::FrequencyGrid;
use super::interpolation::interpolate;
use super::state_space_response::evaluate;
use super::structure::connected;

/// `H(j omega)` of every response of a model on a grid: p x m tables of `N` complex values.
///
/// A value is not finite where the response has none: at a pole on the imaginary axis, or outside the frequencies of
/// measured data.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyResponse {
    values: PairTable<Vec<Complex<f64>>>,
}

impl FrequencyResponse {
    /// `H(j omega) = C (j omega I - A)^-1 B + D` on the grid, or measured data interpolated on it (M2). A response that its
    /// input cannot reach is exactly zero.
    pub fn of(dynamics: &Dynamics, grid: &FrequencyGrid) -> Self {
        let values = match dynamics {
            Dynamics::StateSpace(model) => of_state_space(model, grid.omega()),
            Dynamics::Measured(response) => interpolate(response, grid.omega()),
        };
        Self { values }
    }

    /// The values of every response, `[output, input]`, one for each frequency.
    pub fn values(&self) -> &PairTable<Vec<Complex<f64>>> {
        &self.values
    }
}

fn of_state_space(model: &StateSpace, omega: &[f64]) -> PairTable<Vec<Complex<f64>>> {
    let mut values = evaluate(model, omega);
    let connected = connected(model);
    for (_, values) in values.iter_mut().filter(|(pair, _)| !connected[*pair]) {
        values.fill(Complex::new(0.0, 0.0));
    }
    values
}
