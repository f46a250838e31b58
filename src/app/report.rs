//! The report, written beside what the window goes on with.

use gdcm_core::message_text::sanitized_path;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::view::views::{all_records, known_poles};
use crate::view::{Command, FormKind};
use gdcm_core::study::{Analysis, Cancelled, Engine, HistoryRecords, Job, KnownPoles, Progress};
use gdcm_files::{Existing, FileError, OutputSet, ReportSource, ReportSubject, report, save_report};

use super::{GdcmApp, study_name};

/// Making a report and writing it: seconds, for it has every plot.
#[derive(Clone, Debug)]
pub struct ReportJob {
    /// What it is about.
    pub analysis: Arc<Analysis>,
    /// The flight records that are open, which its models answer to.
    pub records: Vec<HistoryRecords>,
    /// The poles that were identified.
    pub known: KnownPoles,
    /// The files of the study.
    pub source: ReportSource,
    /// Where it goes.
    pub path: PathBuf,
    /// What becomes of a file that is there.
    pub existing: Existing,
    /// What the program reads from, which is never replaced.
    pub inputs: Vec<PathBuf>,
}

impl PartialEq for ReportJob {
    fn eq(&self, other: &Self) -> bool {
        let decided = |job: &Self| (job.source.clone(), job.path.clone(), job.existing);
        let same_analysis = Arc::ptr_eq(&self.analysis, &other.analysis);
        same_analysis
            && decided(self) == decided(other)
            && (&self.records, &self.known) == (&other.records, &other.known)
    }
}

impl Job for ReportJob {
    /// The engine that has the responses that are drawn.
    type Tools = Engine;
    type Output = Result<(), FileError>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let histories = match self.records.as_slice() {
            [] => None,
            records => Some(engine.time_histories(&self.analysis, records, progress)?),
        };
        let subject = ReportSubject { analysis: &self.analysis, histories: histories.as_ref(), known: &self.known };
        let report = report(subject, &self.source, engine, progress)?;
        // Whoever stopped it does not want a file any more.
        if progress.cancelled() {
            return Err(Cancelled);
        }
        Ok(save_report(&report, &self.path, OutputSet::new(self.existing, self.inputs.clone())))
    }
}

impl GdcmApp {
    /// Asks where to write the report, unless there is nothing to report on yet.
    pub(super) fn ask_report(&mut self) {
        match self.analysis_to_write("write the report") {
            Ok(_) => {
                let form = self.state.forms.typed_in(FormKind::Report);
                let name = report_name(self.saved.path.as_deref().or(self.loaded.path()));
                *form = Path::new(form.trim()).with_file_name(name).display().to_string();
                self.state.forms.shown = Some(FormKind::Report);
            }
            Err(why) => self.notify_error(why),
        }
    }

    /// Has the report written; asks before it overwrites a file.
    pub(super) fn write_report(&mut self, path: PathBuf) {
        let analysis = match self.analysis_to_write("write the report") {
            Ok(analysis) => analysis,
            Err(why) => return self.notify_error(why),
        };
        let (path, inputs, existing) = (self.at_home(path), self.inputs(), self.existing);
        match self.outputs().check(&[&path]) {
            Ok(()) => {
                let source = ReportSource::of(&self.loaded, self.saved.path.as_deref());
                self.state.forms.shown = None;
                // What requirements are asked with has no part in the live answer, which may be older.
                let analysis = Arc::new(analysis.asked_with(&self.state.study.requirements));
                let (records, known) = (all_records(&self.state), known_poles(&self.state));
                self.reporting = Some(ReportJob { analysis, records, known, source, path, existing, inputs });
            }
            Err(error) => self.written(Err(error), FormKind::Report, Command::WriteReport(path)),
        }
    }

    /// Says what came of a report.
    pub(super) fn report_written(&mut self, job: ReportJob, outcome: Result<(), FileError>) {
        self.reporting = None;
        match outcome {
            Ok(()) => self.done(format!("wrote the report {}", sanitized_path(&job.path))),
            Err(error) => self.written(Err(error), FormKind::Report, Command::WriteReport(job.path)),
        }
    }

    /// Says that a report under way was given up, by hand or by a fault.
    pub(super) fn give_up_report(&mut self) {
        if let Some(job) = self.reporting.take() {
            self.notify_error(format!("{} was not written: it was stopped", sanitized_path(&job.path)));
        }
    }
}

/// A name for the report of a study, or of a dataset: `flight-7-report.html`.
fn report_name(file: Option<&Path>) -> String {
    let name = file.map_or_else(|| "example".to_owned(), |file| study_name(Some(file)));
    let stem = name.split(".gdcm-study").next().unwrap_or(&name);
    let stem = stem.trim_end_matches(".gz").trim_end_matches(".json");
    format!("{stem}-report.html")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_named_for_its_study_or_else_for_its_dataset() {
        assert_eq!(report_name(None), "example-report.html");
        assert_eq!(report_name(Some(Path::new("/a/flight 7.gdcm-study.json"))), "flight 7-report.html");
        assert_eq!(report_name(Some(Path::new("data.json.gz"))), "data-report.html");
    }
}
