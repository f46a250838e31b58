//! A condition arranged by frequency, with a weight `q` for each response (step 5 in `couplings`,
//! M16.2).
//!
//! ```text
//! s = w_p / sqrt(1 + (sd / 0.06)^2)
//! q = s w_gamma / max(|R'|, |H_c| / 2) / (1 + (e s / 10)^2)^(1/4)
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | `R'` | flight response without its channels' delays and leads |
//! | `H`, `H_c` | physics response; the same with the couplings of the previous pass |
//! | `w_p` | 2 for an on-axis response, otherwise 1 |
//! | `sd` | standard deviation of the identified model's `ln H` |
//! | `w_gamma^2` | weight from the coherence (M4a) |
//! | `e^2` | summand of J: squared errors of `H_c` against `R'` in dB and deg (M4) |
//!
//! A *pass* is one of the successive least-squares problems in the fit. `s` and `w_gamma` are the
//! same in all passes; `|H_c|` and `e` change. The division by `max(|R'|, |H_c| / 2)` makes errors
//! relative; its second value keeps a zero of `R'` from dominating. The last factor of `q` is small
//! where the error is large, so that outliers do not dominate.
//!
//! The feedback `K` returns the *fed-back* outputs to the inputs. A residual therefore depends on
//! further responses: in flight, of the fed-back outputs to the same input; in the physics model,
//! of its own output and the fed-back outputs to all inputs. If one of them is missing, the
//! residual has no weight.

use nalgebra::Complex;

use gdcm_model::dataset::{ConditionId, Pair, PairTable};

use super::problem::{CouplingCondition, CouplingProblem};
use crate::fidelity::summand;

/// `w_p`: an on-axis response's weight relative to the others.
const ON_AXIS_WEIGHT: f64 = 2.0;
/// Standard deviation of `ln H` that halves a response's squared weight `s^2`: 0.5 dB in magnitude,
/// 3.4 deg in phase.
const HALVING_DEVIATION: f64 = 0.06;
/// `e s` that reduces a frequency's weight by the factor `2^(-1/4)`, as an outlier: for `s = 1`, an
/// error with J = 100, the limit for an acceptable model (M4).
const OUTLIER_ERROR: f64 = 10.0;

/// Weight factors that do not change between passes.
#[derive(Clone, Copy, Debug, Default)]
struct FixedWeight {
    /// `s = w_p / sqrt(1 + (sd / 0.06)^2)`; 0 for a response without weight.
    s: f64,
    /// Coherence weight `W = w_gamma^2` (M4a).
    coherence: f64,
}

/// A condition's data, frequency by frequency; within a frequency, input column by input column.
pub(super) struct WeightedCondition<'a> {
    pub(super) id: ConditionId,
    /// True airspeed \[kt\].
    pub(super) airspeed_kt: f64,
    /// The frequencies \[rad/s\].
    pub(super) omega: &'a [f64],
    outputs: usize,
    inputs: usize,
    /// `H`, ordered like [`columns_by_frequency`].
    physics: Vec<Complex<f64>>,
    /// `R'`, ordered like `physics`.
    flight: Vec<Complex<f64>>,
    /// Weight for each response, ordered like `physics`.
    weights: Vec<FixedWeight>,
}

impl<'a> WeightedCondition<'a> {
    /// Arranges a condition; `fed_back` are the fed-back outputs.
    ///
    /// A missing value is replaced by 0. At each frequency, these have weight 0, so that the value
    /// is never used:
    ///
    /// - a response that flight lacks; if its output is fed back, its whole input column;
    /// - all responses in an output for which the physics model lacks a response; if the output is
    ///   fed back, the whole frequency.
    pub(super) fn new(
        problem: &'a CouplingProblem,
        condition: &CouplingCondition,
        fed_back: &[usize],
    ) -> Self {
        let outputs = problem.outputs();
        let inputs = problem.inputs();
        let weights = fixed_weights(problem, condition, fed_back);
        let points = problem.omega.len();
        Self {
            id: condition.id,
            airspeed_kt: condition.airspeed_kt,
            omega: &problem.omega,
            outputs,
            inputs,
            physics: columns_by_frequency(condition.physics.curves(), points),
            flight: columns_by_frequency(condition.flight.curves(), points),
            weights,
        }
    }

    /// Returns the output count, `p`.
    pub(super) fn outputs(&self) -> usize {
        self.outputs
    }

    /// Returns whether any response has a nonzero weight.
    pub(super) fn has_weight(&self) -> bool {
        self.weights.iter().any(|weight| weight.s > 0.0)
    }

    /// Returns whether any response has a nonzero weight at frequency `k`.
    pub(super) fn has_weight_at(&self, k: usize) -> bool {
        let size = self.inputs * self.outputs;
        self.weights[k * size..][..size]
            .iter()
            .any(|weight| weight.s > 0.0)
    }

    /// Returns `H` at frequency `k`, p x m, column by column.
    pub(super) fn physics(&self, k: usize) -> &[Complex<f64>] {
        let size = self.inputs * self.outputs;
        &self.physics[k * size..][..size]
    }

    /// Returns an input column in `R'` at frequency `k`, p values.
    pub(super) fn flight(&self, k: usize, input: usize) -> &[Complex<f64>] {
        &self.flight[(k * self.inputs + input) * self.outputs..][..self.outputs]
    }

    /// Computes `q^2` for each output in an input column at frequency `k`, given `H_c = coupled`
    /// from the last pass; returns false if every weight is zero.
    pub(super) fn squared_weights(
        &self,
        k: usize,
        input: usize,
        coupled: &[Complex<f64>],
        squared: &mut [f64],
    ) -> bool {
        let fixed = &self.weights[(k * self.inputs + input) * self.outputs..][..self.outputs];
        let flight = self.flight(k, input);
        let mut has_weight = false;
        for (output, squared) in squared.iter_mut().enumerate() {
            let weight = fixed[output];
            *squared = if weight.s > 0.0 {
                weight.squared(coupled[output], flight[output])
            } else {
                0.0
            };
            has_weight |= *squared > 0.0;
        }
        has_weight
    }
}

impl FixedWeight {
    /// Returns `q^2`, or 0 where the formula yields no finite value.
    fn squared(self, coupled: Complex<f64>, flight: Complex<f64>) -> f64 {
        let coupled_square = coupled.norm_sqr();
        let flight_square = flight.norm_sqr();
        let error_db = 10.0 * (coupled_square / flight_square).log10();
        let error_deg = (coupled * flight.conj()).arg().to_degrees();
        let robust = (1.0 + summand(error_db, error_deg) * (self.s / OUTLIER_ERROR).powi(2)).sqrt();
        let scale = flight_square.max(0.25 * coupled_square);
        let squared = self.s * self.s * self.coherence / scale / robust;
        // Not finite if a response is zero, which has no value in dB, or if the scale overflows.
        if squared.is_finite() { squared } else { 0.0 }
    }
}

/// Returns the values frequency by frequency, each p x m stored column by column: the value of
/// `[output, input]` at frequency k is at `(k m + input) p + output`. Missing values are zero.
fn columns_by_frequency(curves: &PairTable<Vec<Complex<f64>>>, points: usize) -> Vec<Complex<f64>> {
    let inputs = curves.inputs();
    let outputs = curves.outputs();
    let mut values = Vec::with_capacity(points * inputs * outputs);
    for k in 0..points {
        for input in 0..inputs {
            for output in 0..outputs {
                let value = curves[Pair::new(output, input)][k];
                values.push(if value.is_finite() {
                    value
                } else {
                    Complex::new(0.0, 0.0)
                });
            }
        }
    }
    values
}

/// Returns the fixed weights, ordered like [`columns_by_frequency`], by the rules in
/// [`WeightedCondition::new`].
fn fixed_weights(
    problem: &CouplingProblem,
    condition: &CouplingCondition,
    fed_back: &[usize],
) -> Vec<FixedWeight> {
    let outputs = problem.outputs();
    let inputs = problem.inputs();
    let points = problem.omega.len();
    let coherence = condition
        .coherence
        .as_ref()
        .map(|table| table.map(|_, coherence| coherence.on_grid(&coherence.weights, points)));
    let mut weights = Vec::with_capacity(points * inputs * outputs);
    for k in 0..points {
        // By output: whether the physics model has its responses to all inputs.
        let has_row: Vec<bool> = (0..outputs)
            .map(|output| condition.has_physics_row(output, k))
            .collect();
        let has_loop = fed_back.iter().all(|&output| has_row[output]);
        for input in 0..inputs {
            let has_column = has_loop
                && fed_back
                    .iter()
                    .all(|&output| has_flight(condition, Pair::new(output, input), k));
            for (output, &has_row) in has_row.iter().enumerate() {
                let pair = Pair::new(output, input);
                let is_weighted = has_column
                    && condition.usable[pair]
                    && has_row
                    && has_flight(condition, pair, k);
                weights.push(if is_weighted {
                    FixedWeight {
                        s: deviation_weight(problem, condition, pair, k),
                        coherence: match &coherence {
                            Some(table) => table[pair][k].max(0.0),
                            None => 1.0,
                        },
                    }
                } else {
                    FixedWeight::default()
                });
            }
        }
    }
    weights
}

/// Returns `s = w_p / sqrt(1 + (sd / 0.06)^2)` at frequency `k`; 0 if it is NaN.
fn deviation_weight(
    problem: &CouplingProblem,
    condition: &CouplingCondition,
    pair: Pair,
    k: usize,
) -> f64 {
    let w_p = if problem.on_axis[pair] {
        ON_AXIS_WEIGHT
    } else {
        1.0
    };
    let deviation = match &condition.deviation {
        Some(table) => table[pair][k],
        None => 0.0,
    };
    let s = w_p / (1.0 + (deviation / HALVING_DEVIATION).powi(2)).sqrt();
    s.max(0.0)
}

/// Returns whether a flight response is available at frequency `k`.
fn has_flight(condition: &CouplingCondition, pair: Pair, k: usize) -> bool {
    condition.flight.curve(pair)[k].is_finite()
}
