//! The frequency response of a model on a grid.

use nalgebra::Complex;

use crate::dataset::{Dynamics, PairTable};

use super::frequency_grid::FrequencyGrid;
use super::prepared_model::PreparedModel;

/// `H(j omega)` of every response of a model on a grid: p x m tables of `N` complex values.
///
/// A value is not finite where the response has none: at a pole on the imaginary axis, or outside the frequencies of
/// measured data.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyResponse {
    values: PairTable<Vec<Complex<f64>>>,
}

impl FrequencyResponse {
    /// The response of a model on one grid; for several grids prepare the model once, see [`PreparedModel`].
    pub fn of(dynamics: &Dynamics, grid: &FrequencyGrid) -> Self {
        PreparedModel::of(dynamics).response(grid)
    }

    pub(super) fn from_values(values: PairTable<Vec<Complex<f64>>>) -> Self {
        Self { values }
    }

    /// The values of every response, `[output, input]`, one for each frequency.
    pub fn values(&self) -> &PairTable<Vec<Complex<f64>>> {
        &self.values
    }
}
