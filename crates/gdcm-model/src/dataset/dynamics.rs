//! Dynamics of a model.

use super::measured_response::MeasuredResponse;
use super::state_space::StateSpace;

/// Dynamics of a model: matrices or measured data.
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
}
