//! The products of a pass, for each response and third of the grid (step 5 of `physics`, M18.2).
//!
//! The residual of a response at a frequency is linear in the values `z` of the parameters, the sum
//! `tau_o + tau_i` of two delays and the sum `a_oc + b_ic` of two ln gains:
//!
//! ```text
//! y - sum_k d_k z_k + j omega (tau_o + tau_i) - (a_oc + b_ic),   d_k = (dH/dz_k) / H
//! y = ln(R / H^) + sum_k d_k z_k - j omega (tau_o + tau_i) + (a_oc + b_ic)
//! ```
//!
//! with the values of the present pass in `y`. With `v = (d_1, ..., d_K, -j omega, 1, y)`, a block is
//! `sum q^2 Re(conj(v) v')` over the frequencies of a third: all later sums, with or without a
//! condition, output, input or third, are sums of blocks.

use nalgebra::Complex;

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::response::{FrequencyResponse, wrap};

use super::family::FamilyResponse;
use super::point::ChannelPoint;
use super::problem::{PhysicsCondition, PhysicsProblem};
use super::weights::FixedWeight;

/// Number of parts of the grid that are left out one by one.
pub(super) const THIRDS: usize = 3;

/// The products of one response in one third of the grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Block {
    /// Number of fitted parameters, K.
    parameters: usize,
    /// `sum q^2 Re(conj(v) v')`, (K + 3) x (K + 3), row by row.
    products: Vec<f64>,
    /// `sum q^2 |ln(R / H^)|^2`.
    pub(super) squared_error: f64,
    /// `sum q^2`.
    pub(super) weight: f64,
}

impl Block {
    fn zeros(parameters: usize) -> Self {
        let size = parameters + 3;
        Self {
            parameters,
            products: vec![0.0; size * size],
            squared_error: 0.0,
            weight: 0.0,
        }
    }

    /// Returns the product of two entries of `v`.
    pub(super) fn product(&self, row: usize, column: usize) -> f64 {
        self.products[row * (self.parameters + 3) + column]
    }

    /// Returns the index of `-j omega` in `v`.
    pub(super) fn delay(&self) -> usize {
        self.parameters
    }

    /// Returns the index of 1 in `v`.
    pub(super) fn gain(&self) -> usize {
        self.parameters + 1
    }

    /// Returns the index of `y` in `v`.
    pub(super) fn target(&self) -> usize {
        self.parameters + 2
    }

    /// Adds a frequency with the weight `q^2`.
    fn add(&mut self, v: &[Complex<f64>], squared_weight: f64, error: Complex<f64>) {
        let size = self.parameters + 3;
        for (row, left) in v.iter().enumerate() {
            let re = left.re * squared_weight;
            let im = left.im * squared_weight;
            let products = &mut self.products[row * size..][..size];
            for (product, right) in products.iter_mut().zip(v) {
                *product += re * right.re + im * right.im;
            }
        }
        self.squared_error += squared_weight * error.norm_sqr();
        self.weight += squared_weight;
    }
}

/// The blocks of a condition.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ConditionBlocks {
    /// For each response, one block for each third of the grid.
    pub(super) responses: PairTable<[Block; THIRDS]>,
    /// `sum q^2 |ln(R_b / R)|^2 / (2 sum q^2)` for each other identified model b with a response.
    pub(super) other_squares: Vec<f64>,
}

/// Sums over the blocks of a condition, or over some of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BlockSums {
    /// `sum q^2 |ln(R / H^)|^2`.
    pub(super) squared_error: f64,
    /// `sum q^2`.
    pub(super) weight: f64,
}

impl BlockSums {
    /// Returns the misfit, ln units; `None` without any weight.
    pub(super) fn misfit(&self) -> Option<f64> {
        if self.weight > 0.0 {
            Some((self.squared_error / (2.0 * self.weight)).sqrt())
        } else {
            None
        }
    }
}

impl ConditionBlocks {
    /// Returns the sums over all blocks.
    pub(super) fn sums(&self) -> BlockSums {
        let mut sums = BlockSums::default();
        for (_, thirds) in self.responses.iter() {
            for block in thirds {
                sums.squared_error += block.squared_error;
                sums.weight += block.weight;
            }
        }
        sums
    }
}

/// Data of a condition that do not change between passes.
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

    /// Computes the blocks of the condition at the unknowns of the present pass.
    pub(super) fn blocks(&self, pass: &PassPoint<'_>) -> ConditionBlocks {
        let linearisation = Linearisation {
            condition: self,
            pass,
            physics: self.condition.family.evaluate(pass.z, self.omega),
        };
        let points = self.omega.len();
        let parameters = pass.fitted.len();
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
                let Some(error) = linearisation.set(&mut v, pair, k) else {
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

    /// Returns the weighted mean squares of the other identified models (M18.4).
    fn other_squares(&self, squared_weights: &PairTable<Vec<f64>>) -> Vec<f64> {
        let mut squares = Vec::new();
        for other in &self.condition.others {
            squares.extend(mean_square(&self.condition.flight, other, squared_weights));
        }
        squares
    }
}

/// The unknowns of the present pass, as one condition sees them.
pub(super) struct PassPoint<'a> {
    /// Values of all parameters.
    pub(super) z: &'a [f64],
    /// Indices of the fitted parameters.
    pub(super) fitted: &'a [usize],
    pub(super) channels: ChannelPoint<'a>,
}

/// The residuals of a condition, linear around the present pass.
struct Linearisation<'a> {
    condition: &'a WeightedCondition<'a>,
    pass: &'a PassPoint<'a>,
    physics: FamilyResponse,
}

impl Linearisation<'_> {
    /// Sets `v` for a response at frequency `k`, and returns `ln(R / H^)`; `None` if a value is
    /// missing.
    fn set(&self, v: &mut [Complex<f64>], pair: Pair, k: usize) -> Option<Complex<f64>> {
        let WeightedCondition {
            condition,
            omega,
            weights,
        } = self.condition;
        let channels = &self.pass.channels;
        let place = (pair.output * weights.inputs() + pair.input) * omega.len() + k;
        let response = self.physics.response[place];
        let channel = Complex::new(channels.ln_gain(pair), -omega[k] * channels.delay_s(pair));
        let error = log_ratio(condition.flight.curve(pair)[k], response) - channel;
        // The principal value of the phase error.
        let error = Complex::new(error.re, wrap(error.im));
        let [derivatives @ .., delay, gain, target] = v else {
            return None;
        };
        *delay = Complex::new(0.0, -omega[k]);
        *gain = Complex::new(1.0, 0.0);
        *target = error + channel;
        for (derivative, &parameter) in derivatives.iter_mut().zip(self.pass.fitted) {
            *derivative = self.physics.derivatives[parameter][place] / response;
            *target += *derivative * self.pass.z[parameter];
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

/// Returns `sum q^2 |ln(R_b / R)|^2 / (2 sum q^2)` over the frequencies at which both models have a
/// response; `None` if there are none.
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
