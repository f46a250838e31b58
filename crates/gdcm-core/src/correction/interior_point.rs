//! The convex quadratic program of the delays.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use nalgebra::{DMatrix, DVector};

use super::branch_and_bound::{Function, Objective};
use super::problem::ProblemError;

/// A point within about 1e-9 of the minimum of a sum of squares over its box, by clarabel's interior point.
///
/// # Errors
/// [`ProblemError::Program`] where clarabel does not report the problem as solved ("almost solved" is not).
pub(crate) fn interior_point(objective: &Objective) -> Result<Vec<f64>, ProblemError> {
    let mut scales = objective.lower.clone();
    let free: Vec<usize> =
        (0..objective.scales()).filter(|&index| objective.lower[index] < objective.upper[index]).collect();
    if !free.is_empty() {
        for (position, value) in solve_program(objective, &free)?.into_iter().enumerate() {
            let index = free[position];
            scales[index] = value.clamp(objective.lower[index], objective.upper[index]);
        }
    }
    Ok(scales)
}

/// `min s' P s / 2 + q' s` over `lower <= s <= upper` of the free scales; the others stay where they are.
fn solve_program(objective: &Objective, free: &[usize]) -> Result<Vec<f64>, ProblemError> {
    let size = free.len();
    let (curvature, slope) = quadratic(objective, free);
    let quadratic = upper_triangle(&curvature);
    let columns = (0..=size).map(|column| 2 * column).collect();
    let rows = (0..size).flat_map(|column| [column, size + column]).collect();
    let signs = (0..size).flat_map(|_| [1.0, -1.0]).collect();
    let sides = CscMatrix::new(2 * size, size, columns, rows, signs);
    let ends =
        free.iter().map(|&index| objective.upper[index]).chain(free.iter().map(|&index| -objective.lower[index]));
    let ends: Vec<f64> = ends.collect();
    let settings = DefaultSettings { verbose: false, presolve_enable: false, ..DefaultSettings::default() };
    let failed = |reason: String| ProblemError::Program { reason };
    let mut solver =
        DefaultSolver::new(&quadratic, slope.as_slice(), &sides, &ends, &[NonnegativeConeT(2 * size)], settings)
            .map_err(|error| failed(error.to_string()))?;
    solver.solve();
    match solver.solution.status {
        SolverStatus::Solved => Ok(solver.solution.x),
        status => Err(failed(format!("{status:?}"))),
    }
}

/// Curvature and slope at 0 of the objective over the free scales.
fn quadratic(objective: &Objective, free: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
    let mut curvature = DMatrix::zeros(free.len(), free.len());
    let mut slope = DVector::zeros(free.len());
    let place = |index: usize| free.iter().position(|&candidate| candidate == index);
    for term in &objective.terms {
        let Function::Quadratic { weight, centre, .. } = term.function else {
            continue;
        };
        let ends = [(place(term.to), term.to, 1.0), (place(term.from), term.from, -1.0)];
        // What the ends that do not move leave to be met.
        let fixed: f64 = ends
            .iter()
            .filter(|(place, ..)| place.is_none())
            .map(|(_, index, sign)| sign * objective.lower[*index])
            .sum();
        for (row, _, sign) in ends {
            let Some(row) = row else { continue };
            slope[row] += 2.0 * weight * sign * (fixed - centre.value);
            for (column, _, other) in ends {
                if let Some(column) = column {
                    curvature[(row, column)] += 2.0 * weight * sign * other;
                }
            }
        }
    }
    (curvature, slope)
}

/// The upper triangle in compressed columns, as clarabel takes it.
fn upper_triangle(matrix: &DMatrix<f64>) -> CscMatrix<f64> {
    let size = matrix.ncols();
    let mut columns = vec![0];
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    for column in 0..size {
        for row in 0..=column {
            if matrix[(row, column)] != 0.0 {
                rows.push(row);
                values.push(matrix[(row, column)]);
            }
        }
        columns.push(rows.len());
    }
    CscMatrix::new(size, size, columns, rows, values)
}
