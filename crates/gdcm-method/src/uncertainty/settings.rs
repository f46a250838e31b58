//! Settings for the error bars (M13).

use serde::{Deserialize, Serialize};

use super::coherence_error::Measurement;

/// `C_epsilon^2` for windows that overlap by half. The random error of a response, from its
/// coherence, is proportional to `C_epsilon` ([`Measurement::deviation`]).
///
/// J. S. Bendat and A. G. Piersol, *Random Data*, 4th ed. 2010, chapter 9.
const HALF_OVERLAP_FACTOR_SQUARED: f64 = 0.55;

/// Settings for the error bars; no gain and no delay depends on them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct UncertaintySettings {
    /// Confidence level `L` for every bar, interval and test.
    pub level: f64,
    /// Maximum degrees of freedom that a condition borrows from the others: the weight with which
    /// the variance between identified models, pooled over all conditions, is averaged with the
    /// condition's own (`pooled` in `variance_component.rs`). 0 uses the condition's own only.
    ///
    /// A larger value reduces Student's quantile: at 90 % and for three identified models it is 2.9
    /// with 0, and 1.9 with 4. The trim part of a bar, which is due to the physics models, borrows
    /// nothing. In simulations without a trim part, bars are a quarter narrower with 4 than with 0
    /// (`docs/uncertainty.md`, measured coverage).
    pub prior_degrees: f64,
    /// Count of independent averages for measured responses whose files do not state it; `None`
    /// leaves their coherence unused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub averages: Option<f64>,
    /// Window length \[s\] for measured responses whose files do not state it. Errors at
    /// frequencies farther apart than two steps of the window are independent, which reduces the
    /// error of a median over frequency; without a window length it is not reduced.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// Whether the windows for measured responses overlap by half: `C_epsilon` is then `sqrt(0.55)`
    /// instead of 1.
    #[serde(default)]
    pub half_overlap: bool,
}

impl Default for UncertaintySettings {
    fn default() -> Self {
        Self {
            level: 0.9,
            prior_degrees: 4.0,
            averages: None,
            window_s: None,
            half_overlap: false,
        }
    }
}

impl UncertaintySettings {
    /// Combines a measured response's own data, where its file states them, with these defaults;
    /// `None` if the average count is unknown or not positive. A window length that is not positive
    /// counts as unknown. A number in the file that is not positive is not replaced by the default.
    pub fn measurement(&self, averages: Option<f64>, window_s: Option<f64>) -> Option<Measurement> {
        let averages = averages
            .or(self.averages)
            .filter(|averages| *averages > 0.0)?;
        let window_s = window_s
            .or(self.window_s)
            .filter(|window_s| *window_s > 0.0);
        let factor = if self.half_overlap {
            HALF_OVERLAP_FACTOR_SQUARED.sqrt()
        } else {
            1.0
        };
        Some(Measurement {
            averages,
            window_s,
            factor,
        })
    }
}
