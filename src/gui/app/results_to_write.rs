//! Checks for the commands that write results: whether the results are complete
//! (`analysis_to_write`), and whether error bars are missing (`absent_bars`).

use std::sync::Arc;

use gdcm_study::Analysis;

use super::GdcmApp;
use crate::message::Message;

impl GdcmApp {
    /// Returns the complete analysis for the current decisions, or a message that explains why
    /// there is none.
    pub(super) fn analysis_to_write(&self) -> Result<Arc<Analysis>, Message> {
        if let Some(message) = self.state.incomplete_results() {
            return Err(message);
        }
        match &self.state.results.analysis {
            Some(analysis) => Ok(Arc::clone(analysis)),
            None => Err(self.state.after_stop()),
        }
    }

    /// Returns why error bars are missing; `None` if they are present.
    pub(super) fn absent_bars(&self, are_present: bool) -> Option<AbsentBars> {
        let background = &self.state.results.background;
        // If the error bars are still being computed, only other work was stopped.
        let were_stopped = background.stopped && background.error_bars.is_none();
        if are_present {
            None
        } else if were_stopped {
            Some(AbsentBars::Stopped)
        } else {
            Some(AbsentBars::StillComputed)
        }
    }
}

/// Why error bars are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AbsentBars {
    Stopped,
    StillComputed,
}

/// Returns the end of a message, which explains missing error bars; empty if they are present.
pub(super) fn absent_bars_suffix(absent: Option<AbsentBars>) -> &'static str {
    match absent {
        None => "",
        Some(AbsentBars::Stopped) => "; without error bars: their computation was stopped",
        Some(AbsentBars::StillComputed) => "; without error bars, which are still being computed",
    }
}
