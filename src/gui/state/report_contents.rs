//! Inputs of a report, and the job that composes it without writing it: the export dialog shows its
//! size and its notes.

use std::sync::Arc;

use gdcm_io::report::{Report, ReportSource, ReportSubject, compose_report};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::jobs::job::Job;
use gdcm_study::results::required_modes::IdentifiedPoles;
use gdcm_study::results::time_histories::HistoryRecords;
use gdcm_study::{Analysis, Engine};

/// Results, records and names from which a report is made.
#[derive(Debug)]
pub struct ReportInputs {
    /// Displayed analysis, from which `analysis` was made.
    pub shown: Arc<Analysis>,
    /// The same results with the study's present requirements; the displayed analysis does not
    /// depend on the requirements and may have older ones.
    pub analysis: Arc<Analysis>,
    /// Flight records in use, for the time-history comparison.
    pub records: Vec<HistoryRecords>,
    /// Poles identified from flight records in this session.
    pub known: IdentifiedPoles,
    pub source: ReportSource,
}

impl ReportInputs {
    /// Composes the report; takes seconds, because it draws every plot.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn compose(
        &self,
        engine: &mut Engine,
        progress: &dyn Progress,
    ) -> Result<Report, Cancelled> {
        let histories = match self.records.as_slice() {
            [] => None,
            records => Some(engine.time_histories(&self.analysis, records, progress)?),
        };
        let subject = ReportSubject {
            analysis: &self.analysis,
            histories: histories.as_ref(),
            known: &self.known,
        };
        compose_report(subject, &self.source, engine, progress)
    }
}

/// Job that composes a report. Jobs are equal if they share their inputs in memory: compared by
/// value, records that contain NaN would differ from themselves.
#[derive(Clone, Debug)]
pub struct ReportContentsJob {
    pub inputs: Arc<ReportInputs>,
}

impl PartialEq for ReportContentsJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.inputs, &other.inputs)
    }
}

impl Job for ReportContentsJob {
    /// Engine that caches the responses to draw.
    type Tools = Engine;
    type Output = Arc<Report>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Arc<Report>, Cancelled> {
        self.inputs.compose(engine, progress).map(Arc::new)
    }
}
