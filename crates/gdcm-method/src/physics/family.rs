//! A condition's physics responses for any parameter values, and their derivatives (step 3 in
//! `physics`, M18.2).
//!
//! ```text
//! H = C (j omega I - A)^-1 B + D   at  A(z), B(z), C(z), D(z)
//! dH/dz_k = Y A'_k X + Y B'_k + C'_k X + D'_k,   A'_k = L_k + 2 z_k Q_k,
//! X = (j omega I - A)^-1 B,   Y = C (j omega I - A)^-1
//! ```
//!
//! At `z = 0` these are the *representative*, the model that stands for the condition's physics
//! models. A *run* is a model linearised with parameter k moved, its *base* the model at the same
//! trim with the parameter nominal. `z_k` is the parameter's change divided by its plausible
//! standard deviation; `L_k` and `Q_k` are the linear and the quadratic change of A in `z_k`, found
//! from runs and base (`increments`), likewise of B, C and D. Channel delays multiply H and its
//! derivatives.
//!
//! In discrete time, `j omega` is `e^(j omega T)`; 1 is subtracted from it and I from A, which
//! leaves `j omega I - A` unchanged. A representative with other states than the base has no
//! increments for its matrices; its responses then change like the base's, `H = H_rep + sum_k (z_k
//! L_k + z_k^2 Q_k)`, with `L_k` and `Q_k` from the responses.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::{Dynamics, Model, StateSpace};
use gdcm_model::response::PreparedModel;
use gdcm_model::response::balancing::balance_square;
use gdcm_model::response::prepared_model::evaluation_point;

use super::increments::{ConditionIncrements, ParameterIncrement, RunStep};
use super::matrices::Matrices;
use super::resolvent::ResolventProducts;

/// Response and derivatives at N frequencies, each `[(output m + input) N + frequency]`.
#[derive(Clone, Debug, PartialEq)]
pub struct FamilyResponse {
    /// `H(z)`.
    pub response: Vec<Complex<f64>>,
    /// `dH/dz_k`, for each parameter.
    pub derivatives: Vec<Vec<Complex<f64>>>,
}

/// A condition's physics models for any parameter values.
#[derive(Clone, Debug)]
pub struct ModelFamily {
    kind: FamilyKind,
    outputs: usize,
    inputs: usize,
}

#[derive(Clone, Debug)]
enum FamilyKind {
    Matrices(Box<MatrixFamily>),
    Responses(ResponseFamily),
}

/// Family given by matrices, in balanced coordinates.
#[derive(Clone, Debug)]
struct MatrixFamily {
    /// In discrete time with `A - I` instead of A.
    representative: Matrices,
    increments: Vec<ParameterIncrement>,
    sample_time_s: Option<f64>,
    /// Delay in each response \[s\], `[output m + input]`.
    delays_s: Vec<f64>,
}

/// Family given by responses on a fixed grid; each list as in [`FamilyResponse`].
#[derive(Clone, Debug)]
struct ResponseFamily {
    /// `H_rep`.
    representative: Vec<Complex<f64>>,
    /// `L_k`.
    linear: Vec<Vec<Complex<f64>>>,
    /// `Q_k`; zero for a single run.
    quadratic: Vec<Vec<Complex<f64>>>,
}

impl ModelFamily {
    /// Creates the family for a representative that has the same states as the increments' base.
    /// `None` for other states (see [`ModelFamily::from_responses`]) and for a measured response.
    pub fn from_matrices(representative: &Model, increments: &ConditionIncrements) -> Option<Self> {
        let model = representative.state_space()?;
        if !increments.has_states_of(representative) {
            return None;
        }
        let mut matrices = Matrices::from_model(model);
        let sample_time_s = model.timing().sample_time_s;
        if sample_time_s.is_some() {
            matrices.a -= DMatrix::identity(model.order(), model.order());
        }
        // Only the scales are needed: `balanced` applies them to all matrices.
        let scales = balance_square(&mut matrices.a.clone());
        let mut delays_s = Vec::with_capacity(model.outputs() * model.inputs());
        for output in 0..model.outputs() {
            for input in 0..model.inputs() {
                delays_s.push(model.timing().delay_s(output, input));
            }
        }
        Some(Self {
            kind: FamilyKind::Matrices(Box::new(MatrixFamily {
                representative: matrices.balanced(&scales),
                increments: increments
                    .parameters
                    .iter()
                    .map(|increment| increment.balanced(&scales))
                    .collect(),
                sample_time_s,
                delays_s,
            })),
            outputs: model.outputs(),
            inputs: model.inputs(),
        })
    }

    /// Creates the family for a representative whose responses on the grid `omega` \[rad/s\] change
    /// like the runs' bases, with `L_k` and `Q_k` from the responses by the formulas in
    /// `increments`; `None` if a parameter has no run, two runs with the same step, or a run that
    /// does not fit its base or the representative's channels.
    pub fn from_responses(
        representative: &Model,
        runs: &[Vec<RunStep<'_>>],
        omega: &[f64],
    ) -> Option<Self> {
        let shape = representative.dynamics.shape();
        let mut linear = Vec::with_capacity(runs.len());
        let mut quadratic = Vec::with_capacity(runs.len());
        for steps in runs {
            let first = steps.first()?;
            for step in steps {
                if !step.is_valid() || (step.run.outputs(), step.run.inputs()) != shape {
                    return None;
                }
            }
            let mut slope = response_slope(first, omega);
            let mut curvature = vec![Complex::new(0.0, 0.0); slope.len()];
            if let Some(second) = steps.get(1) {
                if first.z == second.z {
                    return None;
                }
                let second_slope = response_slope(second, omega);
                for (k, curvature) in curvature.iter_mut().enumerate() {
                    *curvature = (slope[k] - second_slope[k]) / (first.z - second.z);
                    slope[k] -= *curvature * first.z;
                }
            }
            linear.push(slope);
            quadratic.push(curvature);
        }
        Some(Self {
            kind: FamilyKind::Responses(ResponseFamily {
                representative: response_values(&representative.dynamics, omega),
                linear,
                quadratic,
            }),
            outputs: shape.0,
            inputs: shape.1,
        })
    }

    /// Returns the output count, `p`.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Returns the input count, `m`.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Returns the parameter count.
    pub fn parameters(&self) -> usize {
        match &self.kind {
            FamilyKind::Matrices(family) => family.increments.len(),
            FamilyKind::Responses(family) => family.linear.len(),
        }
    }

    /// Returns the frequency count if the family is given by responses; `None` for matrices, which
    /// have a response at any frequency.
    pub fn points(&self) -> Option<usize> {
        match &self.kind {
            FamilyKind::Matrices(_) => None,
            FamilyKind::Responses(family) => {
                Some(family.representative.len() / (self.outputs * self.inputs).max(1))
            }
        }
    }

    /// Computes `H(z)` and its derivatives at `omega` \[rad/s\], which must be the family's grid if
    /// it is given by responses; `z` has a value for each parameter. Missing values are not finite.
    pub fn evaluate(&self, z: &[f64], omega: &[f64]) -> FamilyResponse {
        match &self.kind {
            FamilyKind::Matrices(family) => family.evaluate(z, omega),
            FamilyKind::Responses(family) => family.evaluate(z),
        }
    }
}

impl MatrixFamily {
    fn evaluate(&self, z: &[f64], omega: &[f64]) -> FamilyResponse {
        let mut system = self.representative.clone();
        for (increment, &z) in self.increments.iter().zip(z) {
            increment.add_to(&mut system, z);
        }
        let s: Vec<Complex<f64>> = omega
            .iter()
            .map(|&omega| evaluation_point(omega, self.sample_time_s))
            .collect();
        let products = ResolventProducts::new(&system, &s);
        let mut response = by_response(&products.response, self.delays_s.len(), omega.len());
        self.delay(&mut response, omega);
        let mut derivatives = Vec::with_capacity(self.increments.len());
        for (increment, &z) in self.increments.iter().zip(z) {
            let by_point = response_derivative(&increment.derivative(z), &products, omega.len());
            let mut derivative = by_response(&by_point, self.delays_s.len(), omega.len());
            self.delay(&mut derivative, omega);
            derivatives.push(derivative);
        }
        FamilyResponse {
            response,
            derivatives,
        }
    }

    /// Multiplies the values by `e^(-j omega (tau_o + tau_i))`.
    fn delay(&self, values: &mut [Complex<f64>], omega: &[f64]) {
        for (curve, &delay_s) in values
            .chunks_exact_mut(omega.len().max(1))
            .zip(&self.delays_s)
        {
            if delay_s > 0.0 {
                for (value, omega) in curve.iter_mut().zip(omega) {
                    *value *= Complex::from_polar(1.0, -omega * delay_s);
                }
            }
        }
    }
}

/// Computes `Y (A' X + B') + (C' X + D')` for a change in the matrices, point by point, ordered as
/// [`ResolventProducts::response`]. The real and imaginary parts of `X` and `Y` are separate
/// columns and rows, so that all products are real: `Y (A' X + B')` has four of them, of which two
/// make the real and two the imaginary part.
fn response_derivative(
    change: &Matrices,
    products: &ResolventProducts,
    points: usize,
) -> Vec<Complex<f64>> {
    let inputs = change.b.ncols();
    let outputs = change.c.nrows();
    // A' X + B', n x 2 m N; B' is real.
    let mut state_change = &change.a * &products.input_states;
    for point in 0..points {
        let mut real_columns = state_change.columns_mut(2 * inputs * point, inputs);
        real_columns += &change.b;
    }
    // C' X, p x 2 m N; D' is added below.
    let output_change = &change.c * &products.input_states;
    let mut values = Vec::with_capacity(points * outputs * inputs);
    for point in 0..points {
        let y = products
            .output_states
            .rows(2 * outputs * point, 2 * outputs);
        // Real and imaginary parts of Y, times those of A' X + B': 2 p x 2 m.
        let product = y * state_change.columns(2 * inputs * point, 2 * inputs);
        for output in 0..outputs {
            for input in 0..inputs {
                let column = 2 * inputs * point + input;
                let re = product[(output, input)] - product[(outputs + output, inputs + input)];
                let im = product[(output, inputs + input)] + product[(outputs + output, input)];
                values.push(Complex::new(
                    re + output_change[(output, column)] + change.d[(output, input)],
                    im + output_change[(output, column + inputs)],
                ));
            }
        }
    }
    values
}

/// Reorders values from point by point to response by response.
fn by_response(by_point: &[Complex<f64>], responses: usize, points: usize) -> Vec<Complex<f64>> {
    let mut values = Vec::with_capacity(by_point.len());
    for response in 0..responses {
        for point in 0..points {
            values.push(by_point[point * responses + response]);
        }
    }
    values
}

impl ResponseFamily {
    fn evaluate(&self, z: &[f64]) -> FamilyResponse {
        let mut response = self.representative.clone();
        let mut derivatives = Vec::with_capacity(z.len());
        for ((linear, quadratic), &z) in self.linear.iter().zip(&self.quadratic).zip(z) {
            let mut derivative = linear.clone();
            for (k, derivative) in derivative.iter_mut().enumerate() {
                response[k] += linear[k] * z + quadratic[k] * (z * z);
                *derivative += quadratic[k] * (2.0 * z);
            }
            derivatives.push(derivative);
        }
        FamilyResponse {
            response,
            derivatives,
        }
    }
}

/// Returns `(H_run - H_base) / z` on the grid.
fn response_slope(step: &RunStep<'_>, omega: &[f64]) -> Vec<Complex<f64>> {
    let run = state_space_values(step.run, omega);
    let base = state_space_values(step.base, omega);
    run.iter()
        .zip(&base)
        .map(|(run, base)| (run - base) / step.z)
        .collect()
}

fn state_space_values(model: &StateSpace, omega: &[f64]) -> Vec<Complex<f64>> {
    response_values(&Dynamics::StateSpace(model.clone()), omega)
}

/// Returns a model's responses, ordered as in [`FamilyResponse`].
fn response_values(dynamics: &Dynamics, omega: &[f64]) -> Vec<Complex<f64>> {
    let response = PreparedModel::new(dynamics).at(omega);
    response
        .curves()
        .iter()
        .flat_map(|(_, curve)| curve.iter().copied())
        .collect()
}
