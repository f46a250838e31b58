//! Writes the report in a background job, after asking for its path.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::output_set::OutputSet;
use gdcm_io::report::{ReportSource, ReportSubject, report, save_report};
use gdcm_io::{Existing, FileError};
use gdcm_model::message_text::sanitized_path;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::jobs::job::Job;
use gdcm_study::results::required_modes::KnownPoles;
use gdcm_study::results::time_histories::HistoryRecords;
use gdcm_study::{Analysis, Engine};

use super::GdcmApp;
use super::document_files::study_name;
use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::notices::Activity;
use crate::message::Message;

impl GdcmApp {
    /// Asks where to write the report; shows an error if the newest results are not available.
    pub(super) fn ask_report(&mut self) {
        let analysis = self.analysis_to_write();
        if self.value_or_notify(analysis).is_none() {
            return;
        }
        let study = self.files.saved.path.as_deref();
        let name = report_name(study.or(self.files.loaded.path()), &self.files.stem());
        let path = self.state.forms.typed_in(FormKind::Report);
        *path = self.files.proposed_path(path, &name);
        self.state.forms.shown = Some(FormKind::Report);
    }

    /// Starts writing the report; asks before overwriting a file.
    pub(super) fn write_report(&mut self, path: PathBuf) {
        let path = self.files.at_home(path);
        self.start_report(path, self.postponed.existing);
    }

    /// Starts writing the report to a path; `existing` states how an existing file is treated.
    pub(super) fn start_report(&mut self, path: PathBuf, existing: Existing) {
        let Some(analysis) = self.value_or_notify(self.analysis_to_write()) else {
            return;
        };
        let outputs = OutputSet::new(existing, self.files.inputs());
        if let Err(error) = outputs.check(&[&path]) {
            return self.report_failed(error, path);
        }
        self.state.forms.shown = None;
        self.files.last_folder = path.parent().map(Path::to_owned);
        self.work.report_number += 1;
        self.work.report_job = Some(ReportJob {
            number: self.work.report_number,
            // `asked_with`: the live analysis ignores the requirements and may contain older ones.
            analysis: Arc::new(analysis.asked_with(&self.state.study.requirements)),
            records: self.state.records.history_records(),
            known: self.state.records.known_poles(),
            source: ReportSource::from_files(&self.files.loaded, self.files.saved.path.as_deref()),
            path,
            existing,
            inputs: self.files.inputs(),
        });
    }

    /// Shows a notice with the written report's path, or handles the error.
    pub(super) fn report_written(&mut self, job: ReportJob, outcome: Result<(), FileError>) {
        self.work.report_job = None;
        match outcome {
            Ok(()) => {
                let path = sanitized_path(&job.path);
                let text = format!("wrote the report {path}");
                let message = Message::new("report-written", text);
                self.notify_written_to(Activity::Report, message, &job.path);
            }
            Err(error) => self.report_failed(error, job.path),
        }
    }

    /// Asks whether to overwrite the file if it exists; shows any other error.
    fn report_failed(&mut self, error: FileError, path: PathBuf) {
        let again = Command::Output(OutputCommand::WriteReport(path));
        self.notify_not_written(error, FormKind::Report, again);
    }

    /// Shows an error if a running report was stopped, by the engineer or by a panic.
    pub(super) fn give_up_report(&mut self) {
        if let Some(job) = self.work.report_job.take() {
            let path = sanitized_path(&job.path);
            let text = format!("{path} was not written: the report was stopped");
            let message = Message::new("report-stopped", text);
            self.notify_error_of(Activity::Report, message, None);
        }
    }
}

/// Job that builds and writes a report; takes seconds, because it draws every plot.
#[derive(Clone, Debug)]
pub struct ReportJob {
    /// Report number in this session, which distinguishes jobs: records may contain NaN, and would
    /// then differ from themselves.
    pub number: u64,
    pub analysis: Arc<Analysis>,
    /// Open flight records for the time-history comparison.
    pub records: Vec<HistoryRecords>,
    pub known: KnownPoles,
    pub source: ReportSource,
    pub path: PathBuf,
    /// Treatment of an existing file.
    pub existing: Existing,
    /// Input files, which are never replaced.
    pub inputs: Vec<PathBuf>,
}

impl PartialEq for ReportJob {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl Job for ReportJob {
    /// Engine that caches the responses to draw.
    type Tools = Engine;
    type Output = Result<(), FileError>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let histories = match self.records.as_slice() {
            [] => None,
            records => Some(engine.time_histories(&self.analysis, records, progress)?),
        };
        let subject = ReportSubject {
            analysis: &self.analysis,
            histories: histories.as_ref(),
            known: &self.known,
        };
        let report = report(subject, &self.source, engine, progress)?;
        // A stopped job must not write the file.
        if progress.cancelled() {
            return Err(Cancelled);
        }
        let outputs = OutputSet::new(self.existing, self.inputs.clone());
        Ok(save_report(&report, &self.path, outputs))
    }
}

/// Returns a file name for the report about a study or a dataset, `flight-7-report.html`; without a
/// file, from `stem`.
fn report_name(file: Option<&Path>, stem: &str) -> String {
    let name = match file {
        Some(file) => study_name(Some(file)),
        None => stem.to_owned(),
    };
    let stem = name.split(".gdcm-study").next().unwrap_or(&name);
    let stem = stem.trim_end_matches(".gz").trim_end_matches(".json");
    format!("{stem}-report.html")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_named_after_its_study_or_else_after_its_dataset() {
        assert_eq!(report_name(None, "example"), "example-report.html");
        assert_eq!(
            report_name(Some(Path::new("/a/flight 7.gdcm-study.json")), ""),
            "flight 7-report.html"
        );
        assert_eq!(
            report_name(Some(Path::new("data.json.gz")), ""),
            "data-report.html"
        );
    }
}
