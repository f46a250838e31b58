//! Error bars for the values in the displayed condition.

use gdcm_method::uncertainty::{Bar as ErrorBar, Scalar};
use gdcm_model::dataset::ConditionId;
use gdcm_study::results::uncertainty::Uncertainty;

/// Uncertainty in the displayed condition's values.
#[derive(Clone, Copy, Debug)]
pub struct ValueUncertainty<'a> {
    pub condition: ConditionId,
    /// `None` while it is not available; see `State::value_uncertainty`.
    pub uncertainty: Option<&'a Uncertainty>,
}

impl<'a> ValueUncertainty<'a> {
    /// Returns a value's error bar with its confidence level; `None` if it is not available.
    pub fn error_bar(&self, scalar: Scalar) -> Option<(&'a ErrorBar, f64)> {
        let uncertainty = self.uncertainty?;
        Some((uncertainty.bar(self.condition, scalar)?, uncertainty.level))
    }

    /// Returns the half-width of a value's error bar: a ratio, or \[s\] for delays.
    pub fn half_width(&self, scalar: Scalar) -> Option<f64> {
        let (bar, level) = self.error_bar(scalar)?;
        bar.half_width(level)
    }

    /// Returns the confidence level, common to all error bars.
    pub fn level(&self) -> Option<f64> {
        self.uncertainty.map(|uncertainty| uncertainty.level)
    }
}
