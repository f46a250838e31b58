//! Confidence intervals for the parameter values, by jackknives over conditions, outputs, inputs
//! and thirds of the band (step 9 in `physics`, M18.3).
//!
//! ```text
//! V_kind = (n - 1) / n sum_i (z_(-i) - mean)^2   for each kind with n > 1 members
//! V = V_condition + V_output + V_input + V_band + diag(P^-1 P^-1),   P = F + I
//! half-width = t(n_c - 1) sqrt(V)
//! ```
//!
//! `z` is a parameter's value in plausible standard deviations. `z_(-i)` solves the stored normal
//! equations without member i, with `s^2` unchanged; `t` is Student's quantile, `n_c` the number of
//! conditions with data. `F` is the parameters' normal matrix after eliminating all channels. The
//! last term accounts for the prior: a parameter that the data do not determine gets a wide
//! interval, not a narrow one around zero.
//!
//! B. Efron, "The Jackknife, the Bootstrap and Other Resampling Plans", SIAM 1982, chapter 3.

use nalgebra::{DMatrix, DVector};

use super::condition_equations::Part;
use super::pair_blocks::THIRDS;
use super::pass_equations::{PassEquations, singular};
use super::problem::PhysicsError;
use super::shared_system::SharedSystem;
use crate::uncertainty::student_quantile;

/// Minimum number of conditions for intervals and named parameters.
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
        let mut counting = Vec::new();
        for (x, blocks) in by_condition.iter().zip(&equations.blocks) {
            if blocks.sums().weight > 0.0 {
                counting.push(x.clone());
            }
        }
        let by_output = solve_without(equations, equations.counts.outputs, Part::Output)?;
        let by_input = solve_without(equations, equations.counts.inputs, Part::Input)?;
        let by_third = solve_without(equations, THIRDS, Part::Third)?;
        let pull = inverse * inverse;
        let mut variances = Vec::with_capacity(equations.counts.parameters);
        for parameter in 0..equations.counts.parameters {
            variances.push(ValueVariance {
                condition: jackknife(&counting, parameter),
                output: jackknife(&by_output, parameter),
                input: jackknife(&by_input, parameter),
                band: jackknife(&by_third, parameter),
                prior: pull[(parameter, parameter)],
            });
        }
        let conditions = equations.counting_conditions();
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
    part: impl Fn(usize) -> Part,
) -> Result<Vec<DVector<f64>>, PhysicsError> {
    let mut solutions = Vec::with_capacity(count);
    for index in 0..count {
        if equations.has_data(part(index)) {
            solutions.push(solve(equations, equations.system_without(part(index)))?);
        }
    }
    Ok(solutions)
}

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
