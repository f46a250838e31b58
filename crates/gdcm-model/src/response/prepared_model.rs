//! A model prepared for evaluating its frequency response on any grid.
//!
//! A discrete-time model is evaluated in a form that loses no digits for fast sampling (M2a):
//!
//! ```text
//! H = C (sI - F)^-1 B + D,   F = A - I,   s = z - 1 = 2j sin(omega T / 2) e^(j omega T / 2)
//! ```

use std::f64::consts::PI;

use nalgebra::Complex;
use pulp::Arch;

use super::connection::connected;
use super::elimination::Elimination;
use super::frequency_grid::FrequencyGrid;
use super::frequency_response::FrequencyResponse;
use super::hessenberg_form::HessenbergForm;
use super::interpolation::interpolate;
use super::large_entry::LargeEntry;
use super::s_plane::SPlane;
use crate::dataset::measured_response::MeasuredResponse;
use crate::dataset::{Dynamics, PairTable, StateSpace};

/// The part of a frequency response that does not depend on the grid: computed once per model, and
/// reused for every band and plot.
///
/// For a state-space model with `n` states this is the Hessenberg form: `O(n^3)` operations to
/// compute and about `8 n (n + m + p)` bytes to store.
#[derive(Clone, Debug)]
pub struct PreparedModel {
    source: Source,
    /// Each response's delay \[s\]; `None` for a model without delays.
    delays_s: Option<PairTable<f64>>,
}

/// Where the response values come from.
#[derive(Clone, Debug)]
enum Source {
    StateSpace(PreparedStateSpace),
    Measured(MeasuredResponse),
    /// A model with a [`LargeEntry`], which is not evaluated.
    TooLarge {
        outputs: usize,
        inputs: usize,
    },
}

#[derive(Clone, Debug)]
struct PreparedStateSpace {
    form: Box<HessenbergForm>,
    /// Sample time T \[s\]; `None` in continuous time.
    sample_time_s: Option<f64>,
    /// For each response, whether the input can reach the output.
    connected: PairTable<bool>,
}

impl PreparedModel {
    /// Prepares a model; for a state-space model, this costs a Hessenberg reduction.
    pub fn new(dynamics: &Dynamics) -> Self {
        match dynamics {
            Dynamics::StateSpace(model) => {
                let source = if LargeEntry::find(model).is_some() {
                    Source::TooLarge {
                        outputs: model.outputs(),
                        inputs: model.inputs(),
                    }
                } else {
                    Source::StateSpace(PreparedStateSpace::new(model))
                };
                Self {
                    source,
                    delays_s: response_delays(model),
                }
            }
            Dynamics::Measured(response) => Self {
                source: Source::Measured(response.clone()),
                delays_s: None,
            },
        }
    }

    /// Computes the response on a grid (M2, M2a).
    ///
    /// | model | response |
    /// |---|---|
    /// | continuous time | `C (j omega I - A)^-1 B + D` |
    /// | discrete time | `C (zI - A)^-1 B + D`, `z = e^(j omega T)`; NaN at and above `pi / T` |
    /// | measured | interpolated; NaN outside the measured frequencies |
    ///
    /// Channel delays multiply it by `e^(-j omega (tau_o + tau_i))`, with the output's delay
    /// `tau_o` and the input's delay `tau_i`. A response whose input cannot reach its output is
    /// exactly zero; all responses of a model with a [`LargeEntry`] are NaN.
    pub fn response(&self, grid: &FrequencyGrid) -> FrequencyResponse {
        self.at(grid.omega())
    }

    /// Computes the response as [`PreparedModel::response`], at any frequencies `omega` \[rad/s\].
    pub fn at(&self, omega: &[f64]) -> FrequencyResponse {
        let mut response = self.undelayed(omega);
        if let Some(delays_s) = &self.delays_s {
            for (pair, &delay_s) in delays_s.iter() {
                if delay_s > 0.0 {
                    delay(&mut response.curves[pair], omega, delay_s);
                }
            }
        }
        response
    }

    /// Computes the response without the channel delays.
    fn undelayed(&self, omega: &[f64]) -> FrequencyResponse {
        match &self.source {
            Source::StateSpace(prepared) => prepared.response(omega),
            Source::TooLarge { outputs, inputs } => {
                let curve = vec![Complex::new(f64::NAN, f64::NAN); omega.len()];
                FrequencyResponse::new(PairTable::filled(*outputs, *inputs, curve))
            }
            Source::Measured(response) => FrequencyResponse::new(interpolate(response, omega)),
        }
    }
}

impl FrequencyResponse {
    /// Computes a model's response on a single grid. For several grids, use a [`PreparedModel`].
    pub fn from_dynamics(dynamics: &Dynamics, grid: &FrequencyGrid) -> Self {
        PreparedModel::new(dynamics).response(grid)
    }
}

impl PreparedStateSpace {
    fn new(model: &StateSpace) -> Self {
        let a = SPlane::new(model).matrix(model.a());
        Self {
            form: Box::new(HessenbergForm::new(Arch::new(), a, model)),
            sample_time_s: model.timing().sample_time_s,
            connected: connected(model),
        }
    }

    fn response(&self, omega: &[f64]) -> FrequencyResponse {
        let s: Vec<Complex<f64>> = omega
            .iter()
            .map(|omega| evaluation_point(*omega, self.sample_time_s))
            .collect();
        let form = &self.form;
        let mut response = Arch::new().dispatch(Elimination { form, s: &s });
        for (pair, is_connected) in self.connected.iter() {
            if !is_connected {
                // A response without a structural connection is zero; its computed values are
                // rounding errors.
                response.curves[pair].fill(Complex::new(0.0, 0.0));
            }
        }
        response
    }
}

/// Multiplies a curve by `e^(-j omega tau)`, where `tau` is `delay_s`.
fn delay(curve: &mut [Complex<f64>], omega: &[f64], delay_s: f64) {
    for (value, omega) in curve.iter_mut().zip(omega) {
        *value *= Complex::from_polar(1.0, -omega * delay_s);
    }
}

/// Returns `s = j omega`, or `s = e^(j omega T) - 1` in discrete time, which is NaN at and above
/// `omega = pi / T`.
pub fn evaluation_point(omega: f64, sample_time_s: Option<f64>) -> Complex<f64> {
    let Some(sample_time_s) = sample_time_s else {
        return Complex::new(0.0, omega);
    };
    let angle = omega * sample_time_s;
    if angle >= PI {
        return Complex::new(f64::NAN, f64::NAN);
    }
    Complex::from_polar(2.0 * (0.5 * angle).sin(), 0.5 * angle) * Complex::i()
}

/// Returns each response's delay \[s\]; `None` for a model without delays.
fn response_delays(model: &StateSpace) -> Option<PairTable<f64>> {
    let timing = model.timing();
    if timing.input_delays_s.is_none() && timing.output_delays_s.is_none() {
        return None;
    }
    Some(PairTable::from_fn(
        model.outputs(),
        model.inputs(),
        |pair| timing.delay_s(pair.output, pair.input),
    ))
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, dmatrix};

    use super::*;
    use crate::dataset::state_space::Timing;
    use crate::dataset::{Band, Pair};

    fn oscillator() -> StateSpace {
        StateSpace::new(
            dmatrix![0.0, 1.0; -9.0, -0.6],
            dmatrix![0.0; 1.0],
            dmatrix![1.0, 0.0],
            dmatrix![0.0],
        )
        .unwrap()
    }

    fn grid() -> FrequencyGrid {
        FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 100)
    }

    fn curve(model: StateSpace) -> Vec<Complex<f64>> {
        PreparedModel::new(&Dynamics::StateSpace(model))
            .response(&grid())
            .curve(Pair::new(0, 0))
            .to_vec()
    }

    /// Discretises a model with a zero-order hold: `A_d = e^(A T)`, `B_d = integral of e^(A t) B`.
    fn held(model: &StateSpace, sample_time_s: f64) -> StateSpace {
        let n = model.order();
        let m = model.inputs();
        let mut joined = DMatrix::zeros(n + m, n + m);
        joined.view_mut((0, 0), (n, n)).copy_from(model.a());
        joined.view_mut((0, n), (n, m)).copy_from(model.b());
        let powers = (joined * sample_time_s).exp();
        let a = powers.view((0, 0), (n, n)).into_owned();
        let b = powers.view((0, n), (n, m)).into_owned();
        let timing = Timing {
            sample_time_s: Some(sample_time_s),
            ..Timing::default()
        };
        StateSpace::new(a, b, model.c().clone(), model.d().clone())
            .unwrap()
            .timed(timing)
            .unwrap()
    }

    #[test]
    fn a_model_sampled_fast_has_the_response_of_continuous_time_and_half_a_sample_of_lag() {
        let sample_time_s = 1e-5;
        let expected = curve(oscillator());
        let grid = grid();
        let found = curve(held(&oscillator(), sample_time_s));
        for ((value, expected), omega) in found.iter().zip(&expected).zip(grid.omega()) {
            let lag = Complex::from_polar(1.0, -0.5 * omega * sample_time_s);
            // Tolerance: the zero-order hold, (omega T)^2 / 24 = 6e-10, with its aliasing; and
            // rounding, 1e-16 / (omega T).
            assert!(
                (value - expected * lag).norm() < 1e-8 * expected.norm(),
                "{omega}"
            );
        }
    }

    #[test]
    fn delays_of_channels_turn_the_phase_and_nothing_else() {
        let delays = Timing {
            sample_time_s: None,
            input_delays_s: Some(vec![0.03]),
            output_delays_s: Some(vec![0.02]),
        };
        let delayed = curve(oscillator().timed(delays).unwrap());
        for ((value, plain), omega) in delayed.iter().zip(curve(oscillator())).zip(grid().omega()) {
            let expected = plain * Complex::from_polar(1.0, -0.05 * omega);
            assert!(
                (value - expected).norm() < 1e-15 * expected.norm(),
                "{omega}"
            );
        }
        let zero = Timing {
            input_delays_s: Some(vec![0.0]),
            ..Timing::default()
        };
        assert_eq!(
            curve(oscillator().timed(zero).unwrap()),
            curve(oscillator())
        );
    }
}

#[cfg(test)]
mod discrete_form_tests {
    use nalgebra::{DMatrix, dmatrix};

    use super::*;
    use crate::dataset::Pair;

    fn noise(seed: f64) -> impl Fn(usize, usize) -> f64 {
        move |row, column| {
            (seed + 7.3 * row as f64 + 2.9 * column as f64 * (1.0 + row as f64)).sin()
        }
    }

    fn discrete(model: &StateSpace, sample_time_s: f64, omega: &[f64]) -> FrequencyResponse {
        let order = model.order();
        let form = HessenbergForm::new(
            Arch::new(),
            model.a() - DMatrix::identity(order, order),
            model,
        );
        let s: Vec<_> = omega
            .iter()
            .map(|omega| evaluation_point(*omega, Some(sample_time_s)))
            .collect();
        Arch::new().dispatch(Elimination { form: &form, s: &s })
    }

    #[test]
    fn a_first_order_recursion_has_its_known_response() {
        // y_k+1 = 0.5 y_k + u_k, T = 0.1 s: 1 / (z - 0.5) at z = e^(0.2j).
        let model =
            StateSpace::new(dmatrix![0.5], dmatrix![1.0], dmatrix![1.0], dmatrix![0.0]).unwrap();
        let response = discrete(&model, 0.1, &[2.0, 31.4, 31.5]);
        let values = response.curve(Pair::new(0, 0));
        let expected: Complex<f64> = (Complex::from_polar(1.0, 0.2) - 0.5).inv();
        let error: Complex<f64> = values[0] - expected;
        assert!(error.norm() < 1e-15 * expected.norm());
        assert!(
            values[1].is_finite() && !values[2].is_finite(),
            "there is no response from pi / T = 31.42 rad/s on"
        );
    }

    #[test]
    fn a_dense_solution_gives_the_same_to_1e_minus_9_of_the_largest() {
        for order in [1, 2, 7, 30] {
            let a = DMatrix::from_fn(order, order, noise(1.0)) * (0.9 / (order as f64).sqrt());
            let b = DMatrix::from_fn(order, 3, noise(2.0));
            let c = DMatrix::from_fn(2, order, noise(3.0));
            let d = DMatrix::from_fn(2, 3, noise(4.0));
            let model = StateSpace::new(a.clone(), b.clone(), c.clone(), d.clone()).unwrap();
            let omega: Vec<f64> = (0..50).map(|k| 0.01 * 1.15_f64.powi(k)).collect();
            let response = discrete(&model, 0.02, &omega);
            let complex = |matrix: &DMatrix<f64>| matrix.map(Complex::from);
            let mut largest = 0.0_f64;
            let mut error = 0.0_f64;
            for (k, omega) in omega.iter().enumerate() {
                let z = Complex::from_polar(1.0, 0.02 * omega);
                let resolvent = DMatrix::from_diagonal_element(order, order, z) - complex(&a);
                let expected =
                    complex(&c) * resolvent.lu().solve(&complex(&b)).unwrap() + complex(&d);
                for (pair, curve) in response.curves().iter() {
                    let value = expected[(pair.output, pair.input)];
                    largest = largest.max(value.norm());
                    error = error.max((curve[k] - value).norm());
                }
            }
            assert!(
                error <= 1e-11 * largest,
                "order {order}: {error:e} of {largest:e}"
            );
        }
    }

    #[test]
    fn a_model_without_states_is_its_feed_through() {
        let gain = StateSpace::new(
            DMatrix::zeros(0, 0),
            DMatrix::zeros(0, 2),
            DMatrix::zeros(1, 0),
            dmatrix![3.0, 4.0],
        );
        let response = discrete(&gain.unwrap(), 0.1, &[1.0]);
        assert_eq!(response.curve(Pair::new(0, 1)), [Complex::from(4.0)]);
    }

    #[test]
    fn a_pole_on_the_unit_circle_is_not_finite_there_only() {
        // z^2 + 1: poles at +-j, i.e. omega T = pi / 2.
        let model = StateSpace::new(
            dmatrix![0.0, 1.0; -1.0, 0.0],
            dmatrix![0.0; 1.0],
            dmatrix![1.0, 0.0],
            dmatrix![0.0],
        );
        let response = discrete(
            &model.unwrap(),
            1.0,
            &[1.0, std::f64::consts::FRAC_PI_2, 2.0],
        );
        let values = response.curve(Pair::new(0, 0));
        // `FRAC_PI_2` is not exactly pi / 2: next to the pole, the value is about 1 / rounding
        // error.
        assert!(!values[1].is_finite() || values[1].norm() > 1e15);
        for (omega, value) in [(1.0, values[0]), (2.0, values[2])] {
            let expected: Complex<f64> = (Complex::from_polar(1.0, 2.0 * omega) + 1.0).inv();
            let error: Complex<f64> = value - expected;
            assert!(error.norm() < 1e-14 * expected.norm(), "{omega}");
        }
    }
}
