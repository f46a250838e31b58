//! A model made ready for its frequency response on any grid.

use nalgebra::Complex;
use pulp::Arch;

use crate::dataset::{Dynamics, MeasuredResponse, PairTable, StateSpace};

use super::elimination::{HessenbergForm, evaluate_reduced};
use super::frequency_grid::FrequencyGrid;
use super::frequency_response::FrequencyResponse;
use super::interpolation::interpolate;
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
    StateSpace {
        form: Box<HessenbergForm>,
        connected: PairTable<bool>,
    },
    Measured(MeasuredResponse),
    /// No response can be computed.
    TooLarge {
        outputs: usize,
        inputs: usize,
    },
}

/// An entry of a model's matrices beyond `LARGEST_ENTRY`.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "its matrix {matrix} has {value:e} in row {row}, column {column}, and nothing beyond {LARGEST_ENTRY:e} can be computed with"
)]
pub struct LargeEntry {
    /// `A`, `B`, `C` or `D`.
    pub matrix: char,
    /// Row, counted from 1.
    pub row: usize,
    /// Column, counted from 1.
    pub column: usize,
    /// The entry.
    pub value: f64,
}

/// The largest entry that is computed with. Products of three matrices in any units of the states (to 2^100) then stay far from
/// the largest number of the machine, and no entry of a helicopter comes near.
pub const LARGEST_ENTRY: f64 = 1e75;

impl LargeEntry {
    /// The first entry of a model that is too large to compute with.
    pub fn of(model: &StateSpace) -> Option<Self> {
        [('A', model.a()), ('B', model.b()), ('C', model.c()), ('D', model.d())].into_iter().find_map(|(matrix, of)| {
            let at = of.iter().position(|value| value.abs() > LARGEST_ENTRY)?;
            let (row, column) = of.vector_to_matrix_index(at);
            Some(Self { matrix, row: row + 1, column: column + 1, value: of[at] })
        })
    }
}

impl PreparedModel {
    /// Prepares a model.
    pub fn of(dynamics: &Dynamics) -> Self {
        let source = match dynamics {
            Dynamics::StateSpace(model) if LargeEntry::of(model).is_some() => {
                Source::TooLarge { outputs: model.outputs(), inputs: model.inputs() }
            }
            Dynamics::StateSpace(model) => Source::StateSpace {
                form: Box::new(HessenbergForm::of(Arch::new(), model)),
                connected: connected(model),
            },
            Dynamics::Measured(response) => Source::Measured(response.clone()),
        };
        Self { source }
    }

    /// `H(j omega) = C (j omega I - A)^-1 B + D` on the grid, or measured data interpolated on it (M2). A response that its
    /// input cannot reach is exactly zero; that of a model with a [`LargeEntry`] is not a number.
    pub fn response(&self, grid: &FrequencyGrid) -> FrequencyResponse {
        match &self.source {
            Source::StateSpace { form, connected } => {
                let mut response = evaluate_reduced(Arch::new(), form, grid.omega());
                for (pair, _) in connected.iter().filter(|(_, connected)| !**connected) {
                    response.clear(pair);
                }
                response
            }
            Source::TooLarge { outputs, inputs } => {
                let curve = vec![Complex::new(f64::NAN, f64::NAN); grid.len()];
                FrequencyResponse::from_curves(grid.len(), &PairTable::filled(*outputs, *inputs, curve))
            }
            Source::Measured(response) => {
                let omega = grid.omega();
                FrequencyResponse::from_curves(omega.len(), &interpolate(response, omega))
            }
        }
    }
}
