//! Confidence intervals for the parameter values, by jackknives over conditions, outputs, inputs
//! and thirds of the band (step 9 in `physics`, M18.3).
//!
//! ```text
//! V_kind = (n - 1) / n sum_i (z_(-i) - mean)^2
//! V = V_condition + V_output + V_input + V_band + diag(P^-1 P^-1),   P = F + I
//! half-width = t(n_c - 1) sqrt(V)
//! ```
//!
//! `z` is a parameter's value in plausible standard deviations. The *kinds* are condition, output,
//! input and band; the *members* i of a kind are its n conditions, outputs, inputs or thirds of the
//! band, and a kind with a single member is left out. `z_(-i)` solves the stored normal equations
//! without member i, with the misfit `s^2` unchanged; `t` is Student's quantile, `n_c` the number
//! of conditions with data. `F` is the parameters' normal matrix after eliminating all channels.
//!
//! Conditions alone do not suffice: an error of model form is the same in all of them. The last
//! term accounts for the prior: a parameter that the data do not determine gets a wide interval,
//! not a narrow one around zero.
//!
//! B. Efron, "The Jackknife, the Bootstrap and Other Resampling Plans", SIAM 1982, chapter 3.

use nalgebra::{DMatrix, DVector};

use super::condition_equations::DataPart;
use super::pair_blocks::THIRDS;
use super::pass_equations::{PassEquations, singular};
use super::problem::PhysicsError;
use super::shared_system::SharedSystem;
use crate::uncertainty::student_quantile;

/// Minimum number of conditions for intervals and named parameters. Four leave three degrees of
/// freedom; with fewer, Student's quantile grows fast: at 90 % from 2.4 to 2.9 and 6.3.
pub const LEAST_CONDITIONS: usize = 4;

/// A value's variance, by source, in squared plausible standard deviations. `None` for a source
/// with fewer than two members.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ValueVariance {
    pub condition: Option<f64>,
    pub output: Option<f64>,
    pub input: Option<f64>,
    pub band: Option<f64>,
    pub prior: f64,
}

impl ValueVariance {
    /// Returns the sum over the sources.
    pub fn total(&self) -> f64 {
        [self.condition, self.output, self.input, self.band]
            .into_iter()
            .flatten()
            .sum::<f64>()
            + self.prior
    }
}

/// Intervals for the fitted parameters, in their order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Intervals {
    pub(super) variances: Vec<ValueVariance>,
    /// Half-widths at the problem's confidence level, in plausible standard deviations; empty with
    /// fewer than four conditions.
    pub(super) half_widths: Vec<f64>,
    /// For each condition left out, the fitted parameters' `z`.
    pub(super) without_condition: Vec<Vec<f64>>,
}

impl Intervals {
    /// Computes the intervals from the equations at the solution; `inverse` is `P^-1`.
    ///
    /// # Errors
    /// [`PhysicsError::SingularNormalMatrix`] if the equations without a member have no solution.
    pub(super) fn new(
        equations: &PassEquations,
        inverse: &DMatrix<f64>,
        level: f64,
    ) -> Result<Self, PhysicsError> {
        let mut by_condition = Vec::new();
        for reduced in &equations.reduced {
            by_condition.push(solve(equations, Some(equations.system.without(reduced)))?);
        }
        let mut by_condition_with_data = Vec::new();
        for (x, blocks) in by_condition.iter().zip(&equations.blocks) {
            if blocks.sums().weight > 0.0 {
                by_condition_with_data.push(x.clone());
            }
        }
        let by_output = solve_without(equations, equations.counts.outputs, DataPart::Output)?;
        let by_input = solve_without(equations, equations.counts.inputs, DataPart::Input)?;
        let by_third = solve_without(equations, THIRDS, DataPart::Third)?;
        let prior_variance = inverse * inverse;
        let mut variances = Vec::with_capacity(equations.counts.parameters);
        for parameter in 0..equations.counts.parameters {
            variances.push(ValueVariance {
                condition: jackknife(&by_condition_with_data, parameter),
                output: jackknife(&by_output, parameter),
                input: jackknife(&by_input, parameter),
                band: jackknife(&by_third, parameter),
                prior: prior_variance[(parameter, parameter)],
            });
        }
        let conditions = equations.count_conditions_with_data();
        let mut half_widths = Vec::new();
        if conditions >= LEAST_CONDITIONS {
            let quantile = student_quantile(level, conditions as f64 - 1.0);
            for variance in &variances {
                half_widths.push(quantile * variance.total().sqrt());
            }
        }
        let without_condition = by_condition
            .iter()
            .map(|x| x.as_slice()[..equations.counts.parameters].to_vec())
            .collect();
        Ok(Self {
            variances,
            half_widths,
            without_condition,
        })
    }
}

/// Solves the equations without each part that has data, one at a time; `part` creates the output,
/// input or third with an index below `count`.
fn solve_without(
    equations: &PassEquations,
    count: usize,
    part: impl Fn(usize) -> DataPart,
) -> Result<Vec<DVector<f64>>, PhysicsError> {
    let mut solutions = Vec::with_capacity(count);
    for index in 0..count {
        if equations.has_data(part(index)) {
            solutions.push(solve(equations, equations.system_without(part(index)))?);
        }
    }
    Ok(solutions)
}

/// Solves a system; an error if it is missing, or has no solution.
fn solve(
    equations: &PassEquations,
    system: Option<SharedSystem>,
) -> Result<DVector<f64>, PhysicsError> {
    system
        .and_then(|system| system.solve())
        .ok_or(singular(equations.counts))
}

/// Returns `(n - 1) / n sum (z_(-i) - mean)^2` for an unknown; `None` for fewer than two members.
fn jackknife(without: &[DVector<f64>], unknown: usize) -> Option<f64> {
    if without.len() < 2 {
        return None;
    }
    let count = without.len() as f64;
    let values = without.iter().map(|x| x[unknown]);
    let mean = values.clone().sum::<f64>() / count;
    let square: f64 = values.map(|value| (value - mean).powi(2)).sum();
    Some((count - 1.0) / count * square)
}
