//! A model made ready for its frequency response on any grid.

use pulp::Arch;

use crate::dataset::{Dynamics, MeasuredResponse, PairTable};

use super::frequency_grid::FrequencyGrid;
use super::frequency_response::FrequencyResponse;
use super::hessenberg_form::HessenbergForm;
use super::interpolation::interpolate;
use super::state_space_response::evaluate_reduced;
use super::structure::connected;

/// What of a response does not depend on the grid: made once for each model, it serves every band and every drawing.
///
/// For a state-space model of `n` states that is the Hessenberg form, `O(n^3)` operations to make and some
/// `8 n (n + m + p)` bytes to keep.
#[derive(Clone, Debug)]
pub struct PreparedModel {
    source: Source,
}

#[derive(Clone, Debug)]
enum Source {
    StateSpace { form: Box<HessenbergForm>, connected: PairTable<bool> },
    Measured(MeasuredResponse),
}

impl PreparedModel {
    /// Prepares a model.
    pub fn of(dynamics: &Dynamics) -> Self {
        let source = match dynamics {
            Dynamics::StateSpace(model) => Source::StateSpace {
                form: Box::new(HessenbergForm::of(Arch::new(), model)),
                connected: connected(model),
            },
            Dynamics::Measured(response) => Source::Measured(response.clone()),
        };
        Self { source }
    }

    /// `H(j omega) = C (j omega I - A)^-1 B + D` on the grid, or measured data interpolated on it (M2). A response that its
    /// input cannot reach is exactly zero.
    pub fn response(&self, grid: &FrequencyGrid) -> FrequencyResponse {
        match &self.source {
            Source::StateSpace { form, connected } => {
                let mut response = evaluate_reduced(Arch::new(), form, grid.omega());
                for (pair, _) in connected.iter().filter(|(_, connected)| !**connected) {
                    response.clear(pair);
                }
                response
            }
            Source::Measured(response) => {
                let omega = grid.omega();
                FrequencyResponse::from_curves(omega.len(), &interpolate(response, omega))
            }
        }
    }
}
