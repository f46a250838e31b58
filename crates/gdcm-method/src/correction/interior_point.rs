//! Minimises a least-squares objective `F(s)` over its box `lower <= s <= upper` by Clarabel's
//! interior-point method. Its variables `s` are the scales of an [`Objective`].

use gdcm_numerics::{CscMatrix, DefaultSettings, convex_program};

use super::branch_and_bound::expansion::{Curvature, Differentiable, Expansion};
use super::branch_and_bound::objective::Objective;
use super::problem::ProblemError;

/// Returns the scales at the minimum over the box, accurate to about 1e-9.
///
/// # Errors
/// [`ProblemError::Program`] unless Clarabel reports the problem as solved ("almost solved" is an
/// error, too).
pub(crate) fn interior_point(objective: &Objective) -> Result<Vec<f64>, ProblemError> {
    let mut scales = objective.lower.clone();
    let free: Vec<usize> = (0..objective.scales())
        .filter(|&scale| objective.lower[scale] < objective.upper[scale])
        .collect();
    if free.is_empty() {
        return Ok(scales);
    }
    let values = solve_program(objective, &free)?;
    for (&scale, value) in free.iter().zip(values) {
        scales[scale] = value.clamp(objective.lower[scale], objective.upper[scale]);
    }
    Ok(scales)
}

/// Solves `min s' P s / 2 + q' s` subject to `lower <= s <= upper` in the free scales; the other
/// scales are fixed. The box is written as `[I; -I] s <= [upper; -lower]`.
fn solve_program(objective: &Objective, free: &[usize]) -> Result<Vec<f64>, ProblemError> {
    let scales = objective.scales();
    // Expand where the free scales are 0: the objective is quadratic, so that slope and Hessian
    // there are `q` and `P`.
    let mut origin = objective.lower.clone();
    for &scale in free {
        origin[scale] = 0.0;
    }
    let mut at = Expansion::zero(scales);
    objective.expand(&origin, Curvature::True, &mut at);
    let slope: Vec<f64> = free.iter().map(|&scale| at.gradient[scale]).collect();
    let hessian = &at.hessian;
    let rows = free.iter().map(|row| {
        free.iter()
            .map(move |column| &hessian[row * scales + column])
    });
    let quadratic = CscMatrix::from(rows).to_triu();
    let mut limits: Vec<f64> = free.iter().map(|&scale| objective.upper[scale]).collect();
    limits.extend(free.iter().map(|&scale| -objective.lower[scale]));
    let settings = DefaultSettings {
        verbose: false,
        presolve_enable: false,
        ..DefaultSettings::default()
    };
    convex_program(
        &quadratic,
        &slope,
        &box_matrix(free.len()),
        &limits,
        settings,
    )
    .map_err(|reason| ProblemError::Program { reason })
}

/// Returns the matrix of the box constraints, `[I; -I]`, 2 size x size.
fn box_matrix(size: usize) -> CscMatrix<f64> {
    let columns = (0..=size).map(|column| 2 * column).collect();
    let mut rows = Vec::with_capacity(2 * size);
    let mut signs = Vec::with_capacity(2 * size);
    for column in 0..size {
        rows.extend([column, size + column]);
        signs.extend([1.0, -1.0]);
    }
    CscMatrix::new(2 * size, size, columns, rows, signs)
}
