//! The convex quadratic program of the delays.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use nalgebra::{DMatrix, DVector};

use super::problem::DelayError;
use crate::correction::scales::{Descent, Landscape, Shape};

/// Minimises a landscape of parabolas over its box: clarabel's interior point, then an active-set step from there.
///
/// The interior point ends about 1e-9 inside the bounds; the active-set step ends on them, and on the exact minimum of the face.
///
/// # Errors
/// [`DelayError::Program`] where clarabel does not report the problem as solved ("almost solved" is not).
pub(crate) fn solve_program(landscape: &Landscape) -> Result<Vec<f64>, DelayError> {
    let mut scales = landscape.lower.clone();
    let free: Vec<usize> =
        (0..landscape.nodes()).filter(|&node| landscape.lower[node] < landscape.upper[node]).collect();
    if !free.is_empty() {
        for (position, value) in interior_point(landscape, &free)?.into_iter().enumerate() {
            let node = free[position];
            scales[node] = value.clamp(landscape.lower[node], landscape.upper[node]);
        }
    }
    let bounds = (landscape.lower.as_slice(), landscape.upper.as_slice());
    Descent::new(landscape.nodes()).run(landscape, bounds, &mut scales, |_, _| false);
    Ok(scales)
}

/// `min s' P s / 2 + q' s` over `lower <= s <= upper` of the free nodes; the others stay where they are.
fn interior_point(landscape: &Landscape, free: &[usize]) -> Result<Vec<f64>, DelayError> {
    let size = free.len();
    let (curvature, slope) = quadratic(landscape, free);
    let quadratic = upper_triangle(&curvature);
    let columns = (0..=size).map(|column| 2 * column).collect();
    let rows = (0..size).flat_map(|column| [column, size + column]).collect();
    let signs = (0..size).flat_map(|_| [1.0, -1.0]).collect();
    let sides = CscMatrix::new(2 * size, size, columns, rows, signs);
    let ends = free.iter().map(|&node| landscape.upper[node]).chain(free.iter().map(|&node| -landscape.lower[node]));
    let ends: Vec<f64> = ends.collect();
    let settings = DefaultSettings { verbose: false, presolve_enable: false, ..DefaultSettings::default() };
    let failed = |reason: String| DelayError::Program { reason };
    let mut solver =
        DefaultSolver::new(&quadratic, slope.as_slice(), &sides, &ends, &[NonnegativeConeT(2 * size)], settings)
            .map_err(|error| failed(error.to_string()))?;
    solver.solve();
    match solver.solution.status {
        SolverStatus::Solved => Ok(solver.solution.x),
        status => Err(failed(format!("{status:?}"))),
    }
}

/// Curvature and slope at 0 of the landscape over the free nodes.
fn quadratic(landscape: &Landscape, free: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
    let mut curvature = DMatrix::zeros(free.len(), free.len());
    let mut slope = DVector::zeros(free.len());
    let place = |node: usize| free.iter().position(|&candidate| candidate == node);
    for link in &landscape.links {
        let Shape::Parabola { weight, centre, .. } = link.shape else {
            continue;
        };
        let ends = [(place(link.to), link.to, 1.0), (place(link.from), link.from, -1.0)];
        // What the ends that do not move leave to be met.
        let fixed: f64 = ends
            .iter()
            .filter(|(place, ..)| place.is_none())
            .map(|(_, node, sign)| sign * landscape.lower[*node])
            .sum();
        for (row, _, sign) in ends {
            let Some(row) = row else { continue };
            slope[row] += 2.0 * weight * sign * (fixed - centre);
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
