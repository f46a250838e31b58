//! A condition linearised around the present pass, and its blocks (steps 4 and 5 in `physics`,
//! M18.2).
//!
//! ```text
//! l <- ln(R / H^), phase: principal value
//! d_k <- (dH/dz_k) / H
//! y <- l + sum_k d_k z_k - j omega (tau_o + tau_i) + (a_oc + b_ic)
//! v <- (d_k of the fitted parameters, -j omega, 1, y)
//! q^2 <- squared weight of the response at the frequency;  block += q^2 Re(conj(v) v^T)
//! ```
//!
//! `R` is the identified response, `H` the physics response, `H^` the same with the channels'
//! delays `tau` and ln gains `a`, `b`; `z_k` is the value of parameter k. `y` is the logarithm that
//! a linear function of all unknowns has to match. A *block* sums the products over a third of the
//! frequencies.
//!
//! A response or derivative that is missing or not finite has no weight.

use nalgebra::Complex;

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::response::{FrequencyResponse, wrap};

use super::family::FamilyResponse;
use super::pair_blocks::{Block, ConditionBlocks, THIRDS};
use super::point::ChannelPoint;
use super::problem::{PhysicsCondition, PhysicsProblem};
use super::weights::FixedWeight;

/// A condition's data that do not change between passes.
pub(super) struct WeightedCondition<'a> {
    condition: &'a PhysicsCondition,
    omega: &'a [f64],
    weights: PairTable<Vec<FixedWeight>>,
}

impl<'a> WeightedCondition<'a> {
    pub(super) fn new(problem: &'a PhysicsProblem, condition: &'a PhysicsCondition) -> Self {
        Self {
            condition,
            omega: &problem.omega,
            weights: PairTable::from_fn(problem.outputs(), problem.inputs(), |pair| {
                FixedWeight::for_response(problem, condition, pair)
            }),
        }
    }

    /// Computes the condition's blocks at the present pass's unknowns.
    pub(super) fn blocks(&self, point: &PassPoint<'_>) -> ConditionBlocks {
        let linearisation = Linearisation {
            condition: self,
            point,
            physics: self.condition.family.evaluate(point.z, self.omega),
        };
        let points = self.omega.len();
        let parameters = point.fitted.len();
        let mut squared_weights = self.weights.map(|_, _| vec![0.0; points]);
        let mut responses = self
            .weights
            .map(|_, _| [(); THIRDS].map(|()| Block::zeros(parameters)));
        let mut v = vec![Complex::new(0.0, 0.0); parameters + 3];
        for (pair, blocks) in responses.iter_mut() {
            for k in 0..points {
                let weight = self.weights[pair][k];
                if !weight.counts() {
                    continue;
                }
                let Some(error) = linearisation.fill(&mut v, pair, k) else {
                    continue;
                };
                let squared_weight = weight.squared(error);
                squared_weights[pair][k] = squared_weight;
                blocks[THIRDS * k / points].add(&v, squared_weight, error);
            }
        }
        ConditionBlocks {
            responses,
            other_squares: self.other_squares(&squared_weights),
        }
    }

    /// Returns, for each other identified model, the weighted mean square of its log difference
    /// from the flight response (M18.4). Models without a weighted frequency are left out.
    fn other_squares(&self, squared_weights: &PairTable<Vec<f64>>) -> Vec<f64> {
        let mut squares = Vec::new();
        for other in &self.condition.others {
            squares.extend(mean_square(&self.condition.flight, other, squared_weights));
        }
        squares
    }
}

/// The present pass's unknowns, reduced to those that one condition needs.
pub(super) struct PassPoint<'a> {
    /// All parameter values.
    pub(super) z: &'a [f64],
    /// Fitted parameters' indices.
    pub(super) fitted: &'a [usize],
    pub(super) channels: ChannelPoint<'a>,
}

/// A condition's residuals, linearised around the present pass.
struct Linearisation<'a> {
    condition: &'a WeightedCondition<'a>,
    point: &'a PassPoint<'a>,
    /// `H` and its derivatives at the point.
    physics: FamilyResponse,
}

impl Linearisation<'_> {
    /// Fills `v` for a response at frequency `k`, and returns `l = ln(R / H^)`; `None` if a value
    /// is missing or not finite.
    fn fill(&self, v: &mut [Complex<f64>], pair: Pair, k: usize) -> Option<Complex<f64>> {
        let WeightedCondition {
            condition,
            omega,
            weights,
        } = self.condition;
        let channels = &self.point.channels;
        let index = (pair.output * weights.inputs() + pair.input) * omega.len() + k;
        let response = self.physics.response[index];
        // ln(H^ / H).
        let channel = Complex::new(channels.ln_gain(pair), -omega[k] * channels.delay_s(pair));
        let error = log_ratio(condition.flight.curve(pair)[k], response) - channel;
        // Principal value of the phase error.
        let error = Complex::new(error.re, wrap(error.im));
        let [derivatives @ .., delay, gain, y] = v else {
            return None;
        };
        *delay = Complex::new(0.0, -omega[k]);
        *gain = Complex::new(1.0, 0.0);
        *y = error + channel;
        for (derivative, &parameter) in derivatives.iter_mut().zip(self.point.fitted) {
            *derivative = self.physics.derivatives[parameter][index] / response;
            *y += *derivative * self.point.z[parameter];
        }
        if v.iter().all(|value| value.is_finite()) {
            Some(error)
        } else {
            None
        }
    }
}

/// Returns `ln(a / b)` with the principal value of the phase.
fn log_ratio(a: Complex<f64>, b: Complex<f64>) -> Complex<f64> {
    Complex::new(
        0.5 * (a.norm_sqr() / b.norm_sqr()).ln(),
        (a * b.conj()).arg(),
    )
}

/// Returns `sum q^2 |ln(R_b / R)|^2 / (2 sum q^2)` over the weighted frequencies at which both
/// models have a response; `None` if there are none.
fn mean_square(
    flight: &FrequencyResponse,
    other: &FrequencyResponse,
    squared_weights: &PairTable<Vec<f64>>,
) -> Option<f64> {
    let mut square = 0.0;
    let mut weight = 0.0;
    for (pair, squared_weights) in squared_weights.iter() {
        for (k, squared_weight) in squared_weights.iter().enumerate() {
            let difference = log_ratio(other.curve(pair)[k], flight.curve(pair)[k]);
            if *squared_weight > 0.0 && difference.is_finite() {
                square += squared_weight * difference.norm_sqr();
                weight += squared_weight;
            }
        }
    }
    if weight > 0.0 {
        Some(square / (2.0 * weight))
    } else {
        None
    }
}
