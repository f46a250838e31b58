//! Leave-one-out fits of mixing and feedback, and jackknife error bars derived from them (step 9 in
//! `couplings`, M16.4).
//!
//! ```text
//! sd^2 = (n - 1) / n sum_c (theta_(-c) - mean theta_(-c))^2,   half-width = t(n - 1) sd
//! ```
//!
//! `theta_(-c)` is an entry in `M~` or `K` fitted without condition c, n the condition count, and
//! `t(n - 1)` Student's quantile.
//!
//! B. Efron, "The Jackknife, the Bootstrap and Other Resampling Plans", SIAM 1982, chapter 3.

use nalgebra::DMatrix;

use gdcm_model::dataset::ConditionId;
use gdcm_model::executor::{Executor, Sequential, each};
use gdcm_model::progress::{Portion, Progress, Shares};

use super::error::CouplingError;
use super::fit::{CouplingFit, fit_couplings};
use super::problem::CouplingProblem;
use crate::uncertainty::student_quantile;

/// Minimum condition count for error bars: two conditions leave one degree of freedom, for which
/// Student's quantile is above 6 at the 90 % level, so that the bars would say nothing.
pub const LEAST_CONDITIONS: usize = 3;

/// A fit to all conditions but one.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOutFit {
    /// The omitted condition.
    pub condition: ConditionId,
    pub fit: CouplingFit,
}

/// Fits the couplings once for each condition, without it, in condition order. The fits run as
/// independent tasks.
///
/// # Errors
/// [`CouplingError::TooFewConditions`] for fewer than three conditions, and all errors from
/// [`fit_couplings`].
pub fn left_out_fits(
    problem: &CouplingProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<LeftOutFit>, CouplingError> {
    let count = problem.conditions.len();
    check_count(count)?;
    let shares = Shares::new(progress);
    let fits = each(executor, 0..count, |index| {
        let condition = problem.conditions[index].id;
        let portion = Portion::new(
            &shares,
            1.0 / count as f64,
            "leave-one-out fits of mixing and feedback",
        );
        let fit = fit_couplings(&problem.without(index), &Sequential, &portion)?;
        portion.finish()?;
        Ok(LeftOutFit { condition, fit })
    });
    fits.into_iter().collect()
}

fn check_count(found: usize) -> Result<(), CouplingError> {
    if found < LEAST_CONDITIONS {
        return Err(CouplingError::TooFewConditions {
            needed: LEAST_CONDITIONS,
            found,
        });
    }
    Ok(())
}

/// Error bar half-widths for mixing and feedback.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingBars {
    /// Half-widths for `M~` at an airspeed, m x m; 0 on the diagonal, where `M~` is 1.
    pub mixing: DMatrix<f64>,
    /// Half-widths for `K`, m x p.
    pub feedback: DMatrix<f64>,
    /// Student's quantile: half-width divided by standard deviation.
    pub quantile: f64,
}

impl CouplingBars {
    /// Computes the error bars at a confidence level: Student's quantile with `n - 1` degrees of
    /// freedom times the jackknife standard deviation. The mixing is evaluated at `airspeed_kt`.
    ///
    /// # Errors
    /// [`CouplingError::TooFewConditions`] for fewer than three fits.
    pub fn from_fits(
        fits: &[LeftOutFit],
        airspeed_kt: f64,
        level: f64,
    ) -> Result<Self, CouplingError> {
        check_count(fits.len())?;
        let quantile = student_quantile(level, fits.len() as f64 - 1.0);
        let mut mixing = Vec::with_capacity(fits.len());
        let mut feedback = Vec::with_capacity(fits.len());
        for LeftOutFit { fit, .. } in fits {
            mixing.push(fit.matrices.normalised_mixing(airspeed_kt));
            feedback.push(fit.matrices.feedback().clone());
        }
        Ok(Self {
            mixing: jackknife_deviation(&mixing) * quantile,
            feedback: jackknife_deviation(&feedback) * quantile,
            quantile,
        })
    }
}

/// Computes each matrix entry's jackknife standard deviation from the leave-one-out matrices; needs
/// at least one matrix.
fn jackknife_deviation(without: &[DMatrix<f64>]) -> DMatrix<f64> {
    let count = without.len() as f64;
    let (rows, columns) = without[0].shape();
    DMatrix::from_fn(rows, columns, |row, column| {
        let entries = without.iter().map(|matrix| matrix[(row, column)]);
        let mean = entries.clone().sum::<f64>() / count;
        let square: f64 = entries.map(|entry| (entry - mean).powi(2)).sum();
        ((count - 1.0) / count * square).sqrt()
    })
}
