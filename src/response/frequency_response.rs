//! The frequency response of a model on a grid.

use nalgebra::Complex;

use crate::dataset::{Dynamics, PairTable};

use super::frequency_grid::FrequencyGrid;
use super::interpolation::interpolate;
use super::state_space_response::evaluate;

/// `H(j omega)` of every response of a model on a grid: p x m tables of `N` complex values.
///
/// A value is not finite where the response has none: at a pole on the imaginary axis, or outside the frequencies of
/// measured data.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyResponse {
    values: PairTable<Vec<Complex<f64>>>,
}

impl FrequencyResponse {
    /// `H(j omega) = C (j omega I - A)^-1 B + D` on the grid, or measured data interpolated on it (M2).
    pub fn of(dynamics: &Dynamics, grid: &FrequencyGrid) -> Self {
        let values = match dynamics {
            Dynamics::StateSpace(model) => evaluate(model, grid.omega()),
            Dynamics::Measured(response) => interpolate(response, grid.omega()),
        };
        Self { values }
    }

    /// The values of every response, `[output, input]`, one for each frequency.
    pub fn values(&self) -> &PairTable<Vec<Complex<f64>>> {
        &self.values
    }
}
