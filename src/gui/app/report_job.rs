//! Writes the report in a background job, after asking for its path.
//!
//! The report is *composed* first, which takes seconds, and then written. The export dialog
//! composes it while the engineer makes choices, and passes it on. Its *inputs* are the displayed
//! analysis (`shown`); a copy of it with the current requirements (`analysis`); the flight records;
//! the identified poles; the names of the open files (`source`).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::output_set::OutputSet;
use gdcm_io::report::{Report, ReportSource, save_report};
use gdcm_io::{Existing, FileError};
use gdcm_model::message_text::sanitized_path;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::jobs::job::Job;
use gdcm_study::{Analysis, Engine};

use super::GdcmApp;
use super::document_files::study_name;
use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::notices::Activity;
use crate::gui::state::report_contents::{ReportContentsJob, ReportInputs};
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

    /// Starts writing the report; asks before overwriting a file, unless the engineer has just
    /// confirmed that: the command is then repeated with `postponed.existing` set to replace.
    pub(super) fn write_report(&mut self, path: PathBuf) {
        let path = self.files.at_home(path);
        self.start_report(path, self.postponed.existing, None);
    }

    /// Starts writing the report to a path; `existing` is the treatment of an existing file, and
    /// `composed` the report if it is already composed.
    pub(super) fn start_report(
        &mut self,
        path: PathBuf,
        existing: Existing,
        composed: Option<Arc<Report>>,
    ) {
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
            contents: self.report_inputs(analysis),
            composed,
            path,
            existing,
            inputs: self.files.inputs(),
        });
    }

    /// Collects the inputs for a report on an analysis.
    fn report_inputs(&self, analysis: Arc<Analysis>) -> Arc<ReportInputs> {
        let source = self.report_source();
        Arc::new(ReportInputs {
            // The displayed analysis ignores the requirements and may contain older ones.
            analysis: Arc::new(analysis.with_requirements(&self.state.study.requirements)),
            shown: analysis,
            records: self.state.records.history_records(),
            known: self.state.records.identified_poles(),
            source,
        })
    }

    /// Returns the names of the open files, as the report states them.
    fn report_source(&self) -> ReportSource {
        ReportSource::from_files(&self.files.loaded, self.files.saved.path.as_deref())
    }

    /// Returns the job that composes the report which the export dialog describes; `None` if the
    /// dialog is closed or has no report, and while results are incomplete.
    ///
    /// The inputs are collected anew if the displayed analysis or the source has changed; the other
    /// inputs are not compared.
    pub(super) fn report_contents_job(&mut self) -> Option<ReportContentsJob> {
        let is_open = self.state.forms.shown == Some(FormKind::Export);
        if !(is_open && self.state.forms.export.has_report())
            || self.state.incomplete_results().is_some()
        {
            return None;
        }
        let analysis = self.state.results.analysis.clone()?;
        let former_inputs = self.state.forms.export.report_inputs.as_ref();
        let inputs = match former_inputs {
            // The source changes if the study is saved while the dialog is open.
            Some(inputs)
                if Arc::ptr_eq(&inputs.shown, &analysis)
                    && inputs.source == self.report_source() =>
            {
                Arc::clone(inputs)
            }
            _ => self.report_inputs(analysis),
        };
        self.state.forms.export.report_inputs = Some(Arc::clone(&inputs));
        Some(ReportContentsJob { inputs })
    }

    /// Stores the composed report, whose size and notes the export dialog shows.
    pub(super) fn take_report_contents(&mut self, job: ReportContentsJob, report: Arc<Report>) {
        let form = &mut self.state.forms.export;
        form.report = Some((job, report));
        form.join_report_notes();
    }

    /// Shows a notice with the path of the written report, or handles the error.
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

/// Job that composes and writes a report.
#[derive(Clone, Debug)]
pub struct ReportJob {
    /// Number of the report in the session, by which jobs are told apart.
    pub number: u64,
    pub contents: Arc<ReportInputs>,
    /// The report, if it is already composed.
    pub composed: Option<Arc<Report>>,
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
        let report = match &self.composed {
            Some(report) => Arc::clone(report),
            None => Arc::new(self.contents.compose(engine, progress)?),
        };
        // A stopped job must not write the file.
        if progress.cancelled() {
            return Err(Cancelled);
        }
        let outputs = OutputSet::new(self.existing, self.inputs.clone());
        Ok(save_report(&report.html, &self.path, outputs))
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
