//! Test whether the schedule needs a second variable besides airspeed (M13.7).
//!
//! ```text
//! 1  fit X and (X z): the schedule's columns without and with the variable, scaled to -1 <= z <= 1
//! 2  effect <- 2 gamma, gamma the coefficient of z;  p <- Student's test of gamma / se, se its
//!    standard error
//! 3  needed: p, after Holm's correction for several tests, is below 1 - level, and the rms
//!    leave-one-out error falls by 10 % or more
//! ```
//!
//! The second variable is altitude or mass; `level` is the confidence level.

use super::design::{Design, sum_of_squares};
use super::distributions::{student_quantile, student_two_sided};

/// Maximum ratio between the leave-one-out errors with and without a variable at which the variable
/// counts as needed: a significant effect that predicts omitted conditions hardly better is not
/// worth another variable in the schedule.
const NOTABLE_RATIO: f64 = 0.9;

/// Designs without and with a second variable.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondVariableDesign {
    without: Design,
    with: Design,
}

impl SecondVariableDesign {
    /// Step 1: appends the variable's value in each condition to `rows` as the last column.
    ///
    /// # Errors
    /// [`SecondVariableError`] if the effect cannot be estimated.
    pub fn new(rows: &[Vec<f64>], values: &[f64]) -> Result<Self, SecondVariableError> {
        let scaled = scaled(values).ok_or(SecondVariableError::NotVaried)?;
        let mut extended = rows.to_vec();
        for (row, value) in extended.iter_mut().zip(scaled) {
            row.push(value);
        }
        let without = Design::new(rows).ok_or(SecondVariableError::NotToldApart)?;
        if without.freedom() < 2 {
            return Err(SecondVariableError::TooFewConditions);
        }
        let with = Design::new(&extended).ok_or(SecondVariableError::NotToldApart)?;
        Ok(Self { without, with })
    }

    /// Step 2: estimates the effect on `values`, which has one value for each condition.
    pub fn effect(&self, values: &[f64], level: f64) -> SecondVariableEffect {
        let fit = self.with.fit(values);
        let freedom = self.with.freedom() as f64;
        let variance = sum_of_squares(&fit.residuals) / freedom;
        let error = (variance * self.with.last_variance()).sqrt();
        let coefficient = fit.coefficients.last().copied().unwrap_or_default();
        // An exact fit without effect would give 0/0.
        let ratio = if coefficient == 0.0 {
            0.0
        } else {
            coefficient / error
        };
        let left_out = self.left_out_errors(values);
        SecondVariableEffect {
            effect: 2.0 * coefficient,
            detectable: 2.0 * student_quantile(level, freedom) * error,
            p: student_two_sided(ratio, freedom),
            left_out_without: rms(&left_out.without),
            left_out_with: rms(&left_out.with),
        }
    }

    /// Returns the leave-one-out errors in both fits. A condition that either fit interpolates
    /// counts in neither list.
    fn left_out_errors(&self, values: &[f64]) -> LeftOutErrors {
        let mut found = LeftOutErrors::default();
        let errors = self
            .without
            .left_out_errors(values)
            .into_iter()
            .zip(self.with.left_out_errors(values));
        for pair in errors {
            if let (Some(without), Some(with)) = pair {
                found.without.push(without);
                found.with.push(with);
            }
        }
        found
    }
}

/// Leave-one-out errors by condition.
#[derive(Default)]
struct LeftOutErrors {
    without: Vec<f64>,
    with: Vec<f64>,
}

/// A second variable's effect on a value, in addition to the schedule with airspeed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondVariableEffect {
    /// Change between the variable's lowest and highest value, `2 gamma`.
    pub effect: f64,
    /// Half-width of the confidence interval for `effect`, `2 t se`; smaller effects are not
    /// detectable.
    pub detectable: f64,
    /// Probability that an effect this large arises without a true effect, before Holm's
    /// correction.
    pub p: f64,
    /// Rms leave-one-out error without the variable; `None` if no condition can be left out.
    pub left_out_without: Option<f64>,
    /// Rms leave-one-out error with the variable; `None` if no condition can be left out.
    pub left_out_with: Option<f64>,
}

impl SecondVariableEffect {
    /// Step 3: decides whether the schedule needs the variable: the effect is significant after
    /// Holm's correction, and the rms leave-one-out error falls by 10 % or more.
    pub fn is_needed(&self, p_holm: f64, level: f64) -> bool {
        match (self.left_out_without, self.left_out_with) {
            (Some(without), Some(with)) => p_holm < 1.0 - level && with <= NOTABLE_RATIO * without,
            _ => false,
        }
    }
}

/// Reason why a second variable's effect is unavailable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SecondVariableError {
    /// A condition lacks the variable, or all values are equal.
    #[error("at least two different values of the variable are needed in the conditions")]
    NotVaried,
    /// In these conditions the variable depends linearly on the columns for airspeed, or these
    /// columns alone determine no fit.
    #[error("the effect of the variable cannot be separated from the effect of airspeed")]
    NotToldApart,
    /// The schedule's fit has fewer than two degrees of freedom.
    #[error(
        "there are too few conditions to separate the effect of the variable from the effect of airspeed"
    )]
    TooFewConditions,
}

/// Scales values linearly to the range from -1 to 1; `None` if all are equal, or without values.
fn scaled(values: &[f64]) -> Option<Vec<f64>> {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let width = greatest - least;
    if width <= 0.0 || !width.is_finite() {
        return None;
    }
    let scaled = values
        .iter()
        .map(|value| (2.0 * value - least - greatest) / width)
        .collect();
    Some(scaled)
}

/// Returns the root mean square; `None` without values.
fn rms(values: &[f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    Some((sum_of_squares(values) / values.len() as f64).sqrt())
}
