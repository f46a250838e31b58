//! Fourier transforms and convex programs from other crates, without type parameters.
//!
//! **Question answered:** how are generic algorithms compiled only once?
//!
//! Generic code is recompiled with every crate and test that uses it; in `gdcm-method` and
//! `gdcm-sysid` it made up a quarter of the instructions. This crate compiles it once.
//!
//! ```
//! use gdcm_numerics::FourierPlanner;
//!
//! // A constant signal has only line 0.
//! let transform = FourierPlanner::default().plan(4);
//! let lines = transform.transform(&mut [1.0; 4]).unwrap();
//! assert_eq!((lines[0].re, lines[1].norm()), (4.0, 0.0));
//! ```

use std::sync::Arc;

pub use clarabel::algebra::CscMatrix;
pub use clarabel::solver::DefaultSettings;
use clarabel::solver::{DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use nalgebra::Complex;
use realfft::{RealFftPlanner, RealToComplex};

/// Planner of Fourier transforms; transforms with equal lengths share their twiddle factors.
#[derive(Default)]
pub struct FourierPlanner(RealFftPlanner<f64>);

/// Fourier transform for real signals with a fixed length.
#[derive(Clone)]
pub struct FourierTransform(Arc<dyn RealToComplex<f64>>);

impl FourierPlanner {
    /// Plans a transform for signals with `length` samples.
    pub fn plan(&mut self, length: usize) -> FourierTransform {
        FourierTransform(self.0.plan_fft_forward(length))
    }
}

impl FourierTransform {
    /// Computes `X_k = sum_n x[n] e^(-2 pi j k n / N)` for k = 0 ... N / 2; `None` for a signal with
    /// another length. The samples are overwritten.
    pub fn transform(&self, samples: &mut [f64]) -> Option<Vec<Complex<f64>>> {
        let mut lines = self.0.make_output_vec();
        self.0.process(samples, &mut lines).ok()?;
        Some(lines)
    }
}

/// Computes `argmin x' P x / 2 + q' x` subject to `A x <= b`, with P given by its upper triangle: an
/// interior-point method (Goulart & Chen, "Clarabel", arXiv:2405.12762).
///
/// # Errors
/// The status of a solver that finds no solution.
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
    fn a_cosine_with_two_periods_has_only_line_two() {
        let mut samples: Vec<f64> = (0..12)
            .map(|n| (std::f64::consts::TAU * f64::from(n) / 6.0).cos())
            .collect();
        let transform = FourierPlanner::default().plan(12);
        let lines = transform.transform(&mut samples).unwrap();
        for (k, line) in lines.iter().enumerate() {
            let expected = Complex::from(if k == 2 { 6.0 } else { 0.0 });
            assert!((line - expected).norm() < 1e-14, "line {k}: {line}");
        }
        assert!(transform.transform(&mut [0.0; 5]).is_none());
    }

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
