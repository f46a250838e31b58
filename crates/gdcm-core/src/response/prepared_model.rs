//! A model made ready for its frequency response on any grid.

use nalgebra::Complex;
use pulp::Arch;

use crate::dataset::{Dynamics, MeasuredResponse, PairTable, StateSpace};

use super::discrete_form::DiscreteForm;
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
    /// Delay of each response \[s\], where there is any.
    delays_s: Option<PairTable<f64>>,
}

#[derive(Clone, Debug)]
enum Source {
    StateSpace {
        form: Box<HessenbergForm>,
        connected: PairTable<bool>,
    },
    Discrete {
        form: Box<DiscreteForm>,
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
            Dynamics::StateSpace(model) => match model.timing().sample_time_s {
                Some(sample_time_s) => Source::Discrete {
                    form: Box::new(DiscreteForm::of(model, sample_time_s)),
                    connected: connected(model),
                },
                None => Source::StateSpace {
                    form: Box::new(HessenbergForm::of(Arch::new(), model)),
                    connected: connected(model),
                },
            },
            Dynamics::Measured(response) => Source::Measured(response.clone()),
        };
        Self { source, delays_s: delays_of(dynamics) }
    }

    /// `H(j omega) = C (j omega I - A)^-1 B + D` on the grid, or measured data interpolated on it (M2); of a model of discrete
    /// time `C (zI - A)^-1 B + D` at `z = e^(j omega T)`, not a number from `pi / T` on; times `e^(-j omega (tau_o + tau_i))`
    /// where channels are delayed (M2a).
    ///
    /// A response that its input cannot reach is exactly zero; that of a model with a [`LargeEntry`] is not a number.
    pub fn response(&self, grid: &FrequencyGrid) -> FrequencyResponse {
        let mut response = self.undelayed(grid);
        for (pair, &delay_s) in self.delays_s.iter().flat_map(|delays_s| delays_s.iter()).filter(|(_, by)| **by > 0.0) {
            let turns: Vec<_> = grid.omega().iter().map(|omega| Complex::from_polar(1.0, -omega * delay_s)).collect();
            response.multiply(pair, &turns);
        }
        response
    }

    fn undelayed(&self, grid: &FrequencyGrid) -> FrequencyResponse {
        match &self.source {
            Source::StateSpace { form, connected } => {
                cleared(evaluate_reduced(Arch::new(), form, grid.omega()), connected)
            }
            Source::Discrete { form, connected } => cleared(form.response(grid.omega()), connected),
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

/// The response without the rounding errors that stand where the input does not reach the output.
fn cleared(mut response: FrequencyResponse, connected: &PairTable<bool>) -> FrequencyResponse {
    for (pair, _) in connected.iter().filter(|(_, connected)| !**connected) {
        response.clear(pair);
    }
    response
}

/// The delays of a model's responses, where there are any.
fn delays_of(dynamics: &Dynamics) -> Option<PairTable<f64>> {
    let Dynamics::StateSpace(model) = dynamics else { return None };
    let timing = model.timing();
    let is_delayed = timing.input_delays_s.is_some() || timing.output_delays_s.is_some();
    is_delayed
        .then(|| PairTable::from_fn(model.outputs(), model.inputs(), |pair| timing.delay_s(pair.output, pair.input)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::{Band, Pair, Timing};
    use nalgebra::{DMatrix, dmatrix};

    fn oscillator() -> StateSpace {
        StateSpace::new(dmatrix![0.0, 1.0; -9.0, -0.6], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0]).unwrap()
    }

    fn grid() -> FrequencyGrid {
        FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 100)
    }

    fn curve(model: StateSpace) -> Vec<Complex<f64>> {
        PreparedModel::of(&Dynamics::StateSpace(model)).response(&grid()).curve(Pair::new(0, 0))
    }

    /// `A_d = e^(A T)`, `B_d = integral of e^(A t) B`: a hold of the inputs between samples.
    fn held(model: &StateSpace, sample_time_s: f64) -> StateSpace {
        let (n, m) = (model.order(), model.inputs());
        let mut joined = DMatrix::zeros(n + m, n + m);
        joined.view_mut((0, 0), (n, n)).copy_from(model.a());
        joined.view_mut((0, n), (n, m)).copy_from(model.b());
        let powers = (joined * sample_time_s).exp();
        let (a, b) = (powers.view((0, 0), (n, n)).into_owned(), powers.view((0, n), (n, m)).into_owned());
        let timing = Timing { sample_time_s: Some(sample_time_s), ..Timing::default() };
        StateSpace::new(a, b, model.c().clone(), model.d().clone()).unwrap().timed(timing).unwrap()
    }

    #[test]
    fn a_model_sampled_fast_has_the_response_of_continuous_time_and_half_a_sample_of_lag() {
        let (sample_time_s, expected, grid) = (1e-5, curve(oscillator()), grid());
        let found = curve(held(&oscillator(), sample_time_s));
        for ((value, expected), omega) in found.iter().zip(&expected).zip(grid.omega()) {
            let lag = Complex::from_polar(1.0, -0.5 * omega * sample_time_s);
            // What is left of the hold is (omega T)^2 / 24 = 6e-10 and what it folds down; and rounding 1e-16 / (omega T).
            assert!((value - expected * lag).norm() < 1e-8 * expected.norm(), "{omega}");
        }
    }

    #[test]
    fn delays_of_channels_turn_the_phase_and_nothing_else() {
        let delays =
            Timing { sample_time_s: None, input_delays_s: Some(vec![0.03]), output_delays_s: Some(vec![0.02]) };
        let delayed = curve(oscillator().timed(delays).unwrap());
        for ((value, plain), omega) in delayed.iter().zip(curve(oscillator())).zip(grid().omega()) {
            let expected = plain * Complex::from_polar(1.0, -0.05 * omega);
            assert!((value - expected).norm() < 1e-15 * expected.norm(), "{omega}");
        }
        let zero = Timing { input_delays_s: Some(vec![0.0]), ..Timing::default() };
        assert_eq!(curve(oscillator().timed(zero).unwrap()), curve(oscillator()));
    }
}
