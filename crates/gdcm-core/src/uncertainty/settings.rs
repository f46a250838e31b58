//! How bars are made (M13).

use serde::{Deserialize, Serialize};

use super::coherence::Measurement;

/// How bars are made; no gain and no delay depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct UncertaintySettings {
    /// Level `L` of every bar, interval and test.
    pub level: f64,
    /// Degrees of freedom that a condition's identification part borrows from the other conditions at most; 0 trusts the
    /// condition alone.
    pub prior_degrees: f64,
    /// Number of independent averages of measured responses that do not say it; none: their coherence is not used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub averages: Option<f64>,
    /// Length of the windows \[s\] of measured responses that do not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// Whether those windows overlap by half, which makes `C_epsilon` the root of 0.55 in place of 1.
    #[serde(default)]
    pub half_overlap: bool,
}

impl Default for UncertaintySettings {
    fn default() -> Self {
        Self { level: 0.9, prior_degrees: 4.0, averages: None, window_s: None, half_overlap: false }
    }
}

impl UncertaintySettings {
    /// How a response was measured that says so much of it itself; none where nobody says the number of averages.
    pub fn measurement(&self, averages: Option<f64>, window_s: Option<f64>) -> Option<Measurement> {
        let averages = averages.or(self.averages).filter(|averages| *averages > 0.0)?;
        let window_s = window_s.or(self.window_s).filter(|window_s| *window_s > 0.0);
        let factor = if self.half_overlap { 0.55_f64.sqrt() } else { 1.0 };
        Some(Measurement { averages, window_s, factor })
    }
}
