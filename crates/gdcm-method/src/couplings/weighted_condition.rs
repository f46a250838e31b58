//! A condition of the fit arranged by frequency, with the weight of each response (M16.2).

use nalgebra::Complex;

use gdcm_model::dataset::{ConditionId, Pair, PairTable};

use super::problem::{CouplingCondition, CouplingProblem};
use crate::fidelity::summand;

/// Weight of an on-axis response relative to the others, `w_p`.
const ON_AXIS: f64 = 2.0;
/// Standard deviation of `ln H` from which the weight of a response drops clearly.
const DEVIATION: f64 = 0.06;
/// `e s` from which a frequency counts as an outlier.
const OUTLIER: f64 = 10.0;
/// The factors of a weight that stay the same in all passes.
#[derive(Clone, Copy, Debug, Default)]
struct FixedWeight {
    /// `s = w_p / sqrt(1 + (sd / 0.06)^2)`; 0 for a response without weight.
    s: f64,
    /// `W` of the coherence (M4a); `w_gamma` is its root, so the squares weigh `W`.
    coherence: f64,
}

/// One condition; at each frequency its values are stored input column by input column.
pub(super) struct WeightedCondition<'a> {
    pub(super) id: ConditionId,
    /// True airspeed \[kt\].
    pub(super) airspeed_kt: f64,
    /// The frequencies \[rad/s\].
    pub(super) omega: &'a [f64],
    outputs: usize,
    inputs: usize,
    physics: Vec<Complex<f64>>,
    flight: Vec<Complex<f64>>,
    weights: Vec<FixedWeight>,
}

impl<'a> WeightedCondition<'a> {
    /// Creates a condition of a problem with feedback of the outputs `fed_back`.
    ///
    /// A missing value has weight 0 and value 0. If flight lacks a response that is fed back, its
    /// input column has weight 0; if the physics model lacks one, the whole frequency has weight 0.
    /// The value 0 is then never used.
    pub(super) fn new(
        problem: &'a CouplingProblem,
        condition: &CouplingCondition,
        fed_back: &[usize],
    ) -> Self {
        let outputs = problem.outputs();
        let inputs = problem.inputs();
        let weights = fixed_weights(problem, condition, fed_back);
        let columns = |of: &PairTable<Vec<Complex<f64>>>| {
            let mut values = Vec::with_capacity(problem.omega.len() * inputs * outputs);
            for k in 0..problem.omega.len() {
                let entries = (0..inputs)
                    .flat_map(|input| (0..outputs).map(move |output| Pair::new(output, input)));
                let finite = |value: Complex<f64>| {
                    if value.is_finite() {
                        value
                    } else {
                        Complex::new(0.0, 0.0)
                    }
                };
                values.extend(entries.map(|pair| finite(of[pair][k])));
            }
            values
        };
        Self {
            id: condition.id,
            airspeed_kt: condition.airspeed_kt,
            omega: &problem.omega,
            outputs,
            inputs,
            physics: columns(condition.physics.curves()),
            flight: columns(condition.flight.curves()),
            weights,
        }
    }

    /// Returns the number of outputs, `p`.
    pub(super) fn outputs(&self) -> usize {
        self.outputs
    }

    /// Returns the number of inputs, `m`.
    pub(super) fn inputs(&self) -> usize {
        self.inputs
    }

    /// Whether any response has a weight.
    pub(super) fn counts(&self) -> bool {
        self.weights.iter().any(|weight| weight.s > 0.0)
    }

    /// Whether any response has a weight at a frequency.
    pub(super) fn counts_at(&self, k: usize) -> bool {
        let size = self.inputs * self.outputs;
        self.weights[k * size..][..size]
            .iter()
            .any(|weight| weight.s > 0.0)
    }

    /// Returns `H` at a frequency, p x m, column by column.
    pub(super) fn physics(&self, k: usize) -> &[Complex<f64>] {
        let size = self.inputs * self.outputs;
        &self.physics[k * size..][..size]
    }

    /// Returns the column of one input of `R'` at a frequency, p values.
    pub(super) fn flight(&self, k: usize, input: usize) -> &[Complex<f64>] {
        &self.flight[(k * self.inputs + input) * self.outputs..][..self.outputs]
    }

    /// Computes `q^2` of each output of an input column at a frequency, given `H_c = coupled` of
    /// the last pass; returns false if every weight is zero.
    ///
    /// ```text
    /// q^2 = s^2 W / max(|R'|, |H_c| / 2)^2 / (1 + (e s / 10)^2)^(1/2),   e^2: the summand of J (M4)
    /// ```
    pub(super) fn squared_weights(
        &self,
        (k, input): (usize, usize),
        coupled: &[Complex<f64>],
        squared: &mut [f64],
    ) -> bool {
        let fixed = &self.weights[(k * self.inputs + input) * self.outputs..][..self.outputs];
        let flight = self.flight(k, input);
        let mut counts = false;
        for (output, squared) in squared.iter_mut().enumerate() {
            let weight = fixed[output];
            *squared = if weight.s > 0.0 {
                weight.squared(coupled[output], flight[output])
            } else {
                0.0
            };
            counts |= *squared > 0.0;
        }
        counts
    }
}

impl FixedWeight {
    fn squared(self, coupled: Complex<f64>, flight: Complex<f64>) -> f64 {
        let of_coupled = coupled.norm_sqr();
        let of_flight = flight.norm_sqr();
        let db = 10.0 * (of_coupled / of_flight).log10();
        let deg = (coupled * flight.conj()).arg().to_degrees();
        let error = summand(db, deg);
        let robust = (1.0 + error * (self.s / OUTLIER).powi(2)).sqrt();
        let squared = self.s * self.s * self.coherence / of_flight.max(0.25 * of_coupled) / robust;
        // A zero value has no decibels, and an overflow cannot be compared.
        if squared.is_finite() { squared } else { 0.0 }
    }
}

fn fixed_weights(
    problem: &CouplingProblem,
    condition: &CouplingCondition,
    fed_back: &[usize],
) -> Vec<FixedWeight> {
    let outputs = problem.outputs();
    let inputs = problem.inputs();
    let points = problem.omega.len();
    let coherence = condition.coherence.as_ref();
    let coherence = coherence.map(|table| table.map(|_, of| of.spread(&of.weights, points)));
    let mut weights = Vec::with_capacity(points * inputs * outputs);
    for k in 0..points {
        let physics = |output, input| condition.physics.curve(Pair::new(output, input))[k];
        let flight = |output, input| condition.flight.curve(Pair::new(output, input))[k];
        let has_row = |output: usize| (0..inputs).all(|input| physics(output, input).is_finite());
        let has_loop = fed_back.iter().all(|&output| has_row(output));
        for input in 0..inputs {
            let has_column = has_loop
                && fed_back
                    .iter()
                    .all(|&output| flight(output, input).is_finite());
            weights.extend((0..outputs).map(|output| {
                let pair = Pair::new(output, input);
                let counts = has_column
                    && condition.usable[pair]
                    && has_row(output)
                    && flight(output, input).is_finite();
                if !counts {
                    return FixedWeight::default();
                }
                let axis = if problem.on_axis[pair] { ON_AXIS } else { 1.0 };
                let deviation = condition
                    .deviation
                    .as_ref()
                    .map_or(0.0, |table| table[pair][k]);
                let s = axis / (1.0 + (deviation / DEVIATION).powi(2)).sqrt();
                FixedWeight {
                    s: s.max(0.0),
                    coherence: coherence
                        .as_ref()
                        .map_or(1.0, |table| table[pair][k].max(0.0)),
                }
            }));
        }
    }
    weights
}
