//! Background work in progress, as the status bar shows it.

use std::sync::Arc;

use gdcm_method::correction::Problem;

/// Background work in progress, including the analysis of the current settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Background {
    /// Progress of the analysis of the current settings: steps done, total.
    pub analysis: Option<(usize, usize)>,
    /// Problems whose optimality proof is running or waiting.
    pub proofs: Vec<Arc<Problem>>,
    /// Whether the costs of constraining and releasing responses are being computed.
    pub toggles: bool,
    /// Progress of the response curves: models done, total.
    pub curves: Option<(usize, usize)>,
    /// Progress of the error bars: steps done, total. Each model contributes its response, and the
    /// analysis with this model as the representative.
    pub error_bars: Option<(usize, usize)>,
    /// Progress of the responses to all records: steps done, total.
    pub time_histories: Option<(usize, usize)>,
    /// Progress of the couplings: steps done, total.
    pub couplings: Option<(usize, usize)>,
    /// Number of jobs that the visible views wait for.
    pub views: usize,
    /// Progress of the report: conditions done, total.
    pub report: Option<(usize, usize)>,
    /// Progress of the identification: parts done, total.
    pub identification: Option<(usize, usize)>,
    /// Whether some work was stopped, by the engineer or by a fault.
    pub stopped: bool,
}

impl Background {
    /// Returns whether anything is in progress.
    pub fn is_busy(&self) -> bool {
        !self.proofs.is_empty()
            || self.toggles
            || self.curves.is_some()
            || self.error_bars.is_some()
            || self.time_histories.is_some()
            || self.couplings.is_some()
            || self.views > 0
            || self.report.is_some()
            || self.identification.is_some()
    }
}

/// Describes the progress of the error bars: completed steps, total.
pub fn error_bar_progress(progress: (usize, usize)) -> String {
    let (done, total) = progress;
    if total == 0 {
        "error bars …".to_owned()
    } else {
        format!("error bars, {done} of {total} steps …")
    }
}
