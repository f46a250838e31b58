//! Error bars of the values in the displayed condition.

use gdcm_method::uncertainty::{Bar as ErrorBar, Scalar};
use gdcm_model::dataset::ConditionId;
use gdcm_study::results::uncertainty::Uncertainty;

/// Uncertainty of the values in the displayed condition.
#[derive(Clone, Copy, Debug)]
pub struct ValueUncertainty<'a> {
    pub condition: ConditionId,
    /// `None` while it is not available; see `State::value_uncertainty`.
    pub uncertainty: Option<&'a Uncertainty>,
    /// Uncertainty for older settings, shown dimmed until the newer one is available.
    pub older: Option<&'a Uncertainty>,
}

/// Half-width of an error bar for display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownHalfWidth {
    /// A ratio, or \[s\] for delays.
    pub value: f64,
    /// Whether it belongs to older settings.
    pub is_older: bool,
}

impl ShownHalfWidth {
    /// Returns the half-width in another unit, `factor` of which are 1.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            ..self
        }
    }

    /// Returns "±12".
    pub fn text(self) -> String {
        format!("±{:.0}", self.value)
    }
}

impl<'a> ValueUncertainty<'a> {
    /// Returns the error bar of a value with its confidence level; `None` if it is not available.
    pub fn error_bar(&self, scalar: Scalar) -> Option<(&'a ErrorBar, f64)> {
        let uncertainty = self.uncertainty?;
        Some((uncertainty.bar(self.condition, scalar)?, uncertainty.level))
    }

    /// Returns the half-width of a value's error bar: a ratio, or \[s\] for delays.
    pub fn half_width(&self, scalar: Scalar) -> Option<f64> {
        let (bar, level) = self.error_bar(scalar)?;
        bar.half_width(level)
    }

    /// Returns the half-width of a value's error bar; until it is computed, that for older settings.
    pub fn shown_half_width(&self, scalar: Scalar) -> Option<ShownHalfWidth> {
        if self.uncertainty.is_some() {
            let value = self.half_width(scalar)?;
            return Some(ShownHalfWidth {
                value,
                is_older: false,
            });
        }
        let older = self.older?;
        let value = older.bar(self.condition, scalar)?.half_width(older.level)?;
        Some(ShownHalfWidth {
            value,
            is_older: true,
        })
    }

    /// Returns the confidence level, common to all error bars.
    pub fn level(&self) -> Option<f64> {
        self.uncertainty.map(|uncertainty| uncertainty.level)
    }
}
