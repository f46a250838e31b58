//! Background work in progress, as the status bar shows it.

use std::sync::Arc;

use gdcm_method::correction::Problem;

/// A job's progress. The total is 0 until the job reports it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    pub done: usize,
    pub total: usize,
}

impl Steps {
    /// Returns the completed share as a whole percentage; 0 without a total.
    pub fn percent(self) -> usize {
        100 * self.done / self.total.max(1)
    }
}

/// Background work in progress, including the analysis with the current settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Background {
    /// Analysis with the current settings.
    pub analysis: Option<Steps>,
    /// Problems (each optimises the gains in a condition) whose optimality proof is running,
    /// waiting, or not yet part of the results.
    pub proofs: Vec<Arc<Problem>>,
    /// Whether the costs of constraining and releasing responses are being computed.
    pub toggles: bool,
    /// Response curves; a step for each model.
    pub curves: Option<Steps>,
    /// Error bars; a step for each model's response, and for each analysis with another model as
    /// the representative.
    pub error_bars: Option<Steps>,
    /// Simulated responses to the held-out records.
    pub time_histories: Option<Steps>,
    /// Assessment of the couplings.
    pub couplings: Option<Steps>,
    /// Fit of the physics parameters.
    pub physics: Option<Steps>,
    /// Number of running and waiting jobs of the visible views, apart from those with a field of
    /// their own.
    pub views: usize,
    /// Report that is being written; a step for each condition.
    pub report: Option<Steps>,
    /// Report that the export dialog describes; a step for each condition.
    pub report_contents: Option<Steps>,
    /// Progress of the identification.
    pub identification: Option<Steps>,
    /// Whether work that *Compute* resumes was stopped, by the engineer or by a fault.
    pub stopped: bool,
}

impl Background {
    /// Returns whether any work other than the live analysis is in progress.
    pub fn is_busy(&self) -> bool {
        !self.proofs.is_empty()
            || self.toggles
            || self.curves.is_some()
            || self.error_bars.is_some()
            || self.time_histories.is_some()
            || self.couplings.is_some()
            || self.physics.is_some()
            || self.views > 0
            || self.report.is_some()
            || self.report_contents.is_some()
            || self.identification.is_some()
    }
}

/// Describes how far the error bars have come.
pub fn error_bar_progress(steps: Steps) -> String {
    if steps.total == 0 {
        "computing error bars …".to_owned()
    } else {
        format!(
            "computing error bars, {} of {} steps …",
            steps.done, steps.total
        )
    }
}
