//! A model's dynamics.

use super::measured_response::MeasuredResponse;
use super::state_space::StateSpace;

/// A model's dynamics: matrices or measured data.
#[derive(Clone, Debug, PartialEq)]
pub enum Dynamics {
    StateSpace(StateSpace),
    /// Measured frequency response (identified models only), interpolated between its frequencies.
    Measured(MeasuredResponse),
}

impl Dynamics {
    /// Returns the output count `p` and the input count `m`.
    pub fn shape(&self) -> (usize, usize) {
        match self {
            Dynamics::StateSpace(model) => (model.outputs(), model.inputs()),
            Dynamics::Measured(response) => {
                (response.values().outputs(), response.values().inputs())
            }
        }
    }

    /// Returns the memory \[bytes\] taken by the matrices, or by the measured frequencies, values
    /// and coherence; delays and valid bands are not counted.
    pub fn bytes(&self) -> usize {
        const REAL: usize = size_of::<f64>();
        match self {
            Dynamics::StateSpace(model) => {
                let matrices = [model.a(), model.b(), model.c(), model.d()];
                REAL * matrices.iter().map(|matrix| matrix.len()).sum::<usize>()
            }
            Dynamics::Measured(response) => {
                let values = response.values();
                let responses = values.outputs() * values.inputs();
                let parts = match response.coherence() {
                    Some(_) => 3,
                    None => 2,
                };
                REAL * response.omega().len() * (1 + parts * responses)
            }
        }
    }
}
