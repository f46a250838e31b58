//! Convex quadratic programs with linear inequalities.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};

/// Computes `argmin x' P x / 2 + q' x` subject to `A x <= b`, with P positive semidefinite and given
/// by its upper triangle: an interior-point method (Goulart & Chen, "Clarabel", arXiv:2405.12762).
///
/// # Errors
/// The solver's status if it is not `Solved`, or its message about invalid data.
pub fn convex_program(
    p: &CscMatrix<f64>,
    q: &[f64],
    a: &CscMatrix<f64>,
    b: &[f64],
    settings: DefaultSettings<f64>,
) -> Result<Vec<f64>, String> {
    let mut solver = DefaultSolver::new(p, q, a, b, &[NonnegativeConeT(b.len())], settings)
        .map_err(|error| error.to_string())?;
    solver.solve();
    match solver.solution.status {
        SolverStatus::Solved => Ok(solver.solution.x),
        status => Err(format!("{status:?}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_ends_at_its_bound_or_is_an_error() {
        // Minimum of (x - 3)^2 / 2 subject to x <= 1; then subject to x <= 1 and x >= 2
        // (infeasible).
        let settings = DefaultSettings {
            verbose: false,
            ..DefaultSettings::default()
        };
        let one = CscMatrix::new(1, 1, vec![0, 1], vec![0], vec![1.0]);
        let x = convex_program(&one, &[-3.0], &one, &[1.0], settings.clone()).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-6);
        let both = CscMatrix::new(2, 1, vec![0, 2], vec![0, 1], vec![1.0, -1.0]);
        assert!(convex_program(&one, &[-3.0], &both, &[1.0, -2.0], settings).is_err());
    }
}
