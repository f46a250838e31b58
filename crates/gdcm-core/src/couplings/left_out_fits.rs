//! Couplings found without each condition in turn, and the error bars that they give (M16.4).
//!
//! ```text
//! sd^2 = (n - 1) / n sum_c (theta_(-c) - mean theta_(-c))^2,   half-width = t(n - 1) sd
//! ```
//!
//! B. Efron, "The Jackknife, the Bootstrap and Other Resampling Plans", SIAM 1982, chapter 3.

use nalgebra::DMatrix;

use super::{CouplingError, CouplingFit, CouplingProblem, fit_couplings};
use crate::dataset::ConditionId;
use crate::executor::{Executor, Sequential, each};
use crate::progress::{Progress, Shares, Untold};
use crate::uncertainty::student_quantile;

/// Conditions below which there are no error bars.
pub const LEAST_CONDITIONS: usize = 3;

/// The fit without one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOutFit {
    /// The condition that is left out.
    pub condition: ConditionId,
    /// The fit to all others.
    pub fit: CouplingFit,
}

/// The couplings without each condition in turn, in the order of the conditions; each is a piece of work of its own.
///
/// # Errors
/// [`CouplingError::TooFewConditions`] of fewer than three, and as [`fit_couplings`].
pub fn left_out_fits(
    problem: &CouplingProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<LeftOutFit>, CouplingError> {
    let count = problem.conditions.len();
    if count < LEAST_CONDITIONS {
        return Err(CouplingError::TooFewConditions { needed: LEAST_CONDITIONS, found: count });
    }
    let shares = Shares::new(progress);
    let fits = each(executor, 0..count, |place| {
        let condition = problem.conditions[place].id;
        let fit = fit_couplings(&problem.without(place), &Sequential, &Untold(progress))?;
        shares.advance(1.0 / count as f64, "mixing and feedback without each condition")?;
        Ok(LeftOutFit { condition, fit })
    });
    fits.into_iter().collect()
}

/// Half-widths of the error bars of mixing and feedback.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingBars {
    /// Of `M~` at one airspeed, m x m; 0 on its diagonal, which is 1.
    pub mixing: DMatrix<f64>,
    /// Of `K`, m x p.
    pub feedback: DMatrix<f64>,
    /// Student's quantile: a half-width over its standard deviation.
    pub quantile: f64,
}

impl CouplingBars {
    /// The bars of a level, Student's quantile of `n - 1` times the jackknife's standard deviation; those of the mixing at `airspeed_kt`.
    ///
    /// # Errors
    /// [`CouplingError::TooFewConditions`] of fewer than three.
    pub fn of(fits: &[LeftOutFit], airspeed_kt: f64, level: f64) -> Result<Self, CouplingError> {
        if fits.len() < LEAST_CONDITIONS {
            return Err(CouplingError::TooFewConditions { needed: LEAST_CONDITIONS, found: fits.len() });
        }
        let quantile = student_quantile(level, fits.len() as f64 - 1.0);
        let matrices = || fits.iter().map(|of| &of.fit.matrices);
        let mixing: Vec<_> = matrices().map(|of| of.normalised_mixing(airspeed_kt)).collect();
        let feedback: Vec<_> = matrices().map(|of| of.feedback().clone()).collect();
        Ok(Self { mixing: jackknife(&mixing) * quantile, feedback: jackknife(&feedback) * quantile, quantile })
    }
}

/// Standard deviation of each entry by the jackknife, of the matrices without each condition; at least one.
fn jackknife(without: &[DMatrix<f64>]) -> DMatrix<f64> {
    let count = without.len() as f64;
    let (rows, columns) = without[0].shape();
    DMatrix::from_fn(rows, columns, |row, column| {
        let mean = without.iter().map(|of| of[(row, column)]).sum::<f64>() / count;
        let square: f64 = without.iter().map(|of| (of[(row, column)] - mean).powi(2)).sum();
        ((count - 1.0) / count * square).sqrt()
    })
}
