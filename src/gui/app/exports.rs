//! Exports of the corrections: as files of this program, and in formats for other tools.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_io::export::{ExportFormat, ExportRequest, ExportSource, export_contents, write_export};
use gdcm_io::files::corrections_file::write_results;
use gdcm_model::message_text::sanitized_path;
use gdcm_model::number_format::counted;
use gdcm_study::Analysis;

use super::GdcmApp;
use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::forms::FormKind;
use crate::message::Message;

impl GdcmApp {
    /// Writes the corrections of the conditions selected in the form.
    pub(super) fn export(&mut self) {
        let Some(analysis) = self.complete_results() else {
            return;
        };
        let chosen = self.state.forms.exported.clone();
        let folder = PathBuf::from(self.state.forms.typed_in(FormKind::Export).trim());
        let folder = self.files.at_home(folder);
        let written = write_results(
            &analysis,
            &self.files.loaded.sha256,
            &chosen,
            &folder,
            self.outputs(),
        );
        let absent = absent_bars_suffix(self.absent_bars(analysis.uncertainty.is_some()));
        let text = format!(
            "exported {} to {}{absent}",
            counted(chosen.len(), "condition"),
            sanitized_path(&folder)
        );
        self.notify_written(
            written.map(|()| Message::new("exported", text)),
            FormKind::Export,
            Command::Output(OutputCommand::Export),
        );
    }

    /// Proposes a name for an export to other tools if none was typed.
    pub(super) fn propose_export_name(&mut self) {
        let stem = self.files.stem();
        let extension = self.state.forms.export_format.extension;
        let path = self.state.forms.typed_in(FormKind::ExportAs);
        if path.is_empty() {
            *path = format!("{stem}.{extension}");
        }
    }

    /// Writes all corrections in a format for other tools; asks before overwriting.
    pub(super) fn export_as(&mut self, format: ExportFormat, path: PathBuf) {
        let Some(analysis) = self.complete_results() else {
            return;
        };
        let path = self.files.at_home(path);
        let source = ExportSource {
            name: self.state.study_name.clone(),
            sha256: self.files.loaded.sha256.clone(),
        };
        let request = ExportRequest {
            format,
            ..ExportRequest::default()
        };
        let contents = export_contents(&analysis, &request);
        let left_out = contents.left_out_words(&analysis.study.dataset);
        let written = write_export(&analysis, &source, &request, &path, self.outputs());
        let absent = absent_bars_suffix(self.absent_bars(analysis.uncertainty.is_some()));
        let message = written.map(|remarks| {
            let text = format!(
                "exported {}: {}{}{}{absent}",
                sanitized_path(&path),
                contents.words(),
                left_out_suffix(&left_out),
                remarks_suffix(&remarks)
            );
            Message::new("exported", text)
        });
        self.notify_written(
            message,
            FormKind::ExportAs,
            Command::Output(OutputCommand::ExportAs(format, path.clone())),
        );
    }

    /// Returns the complete analysis of the current study, with optimality proofs and the error
    /// bars computed so far. Reports an error if it is incomplete.
    fn complete_results(&mut self) -> Option<Arc<Analysis>> {
        let analysis = self.value_or_notify(self.analysis_to_write("export"))?;
        match self.state.analysis_with_error_bars() {
            Some(with_bars) if with_bars.study == analysis.study => Some(Arc::new(with_bars)),
            _ => Some(analysis),
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

    /// Returns the complete analysis for the current decisions, or a message that explains why
    /// there is none and asks the engineer to repeat `action` later.
    pub(super) fn analysis_to_write(&self, action: &str) -> Result<Arc<Analysis>, Message> {
        let results = &self.state.results;
        if results.stopped {
            let text = format!(
                "{}: the computation was stopped; choose Compute first",
                self.state.after_stop().text
            );
            return Err(Message::new("computation-stopped", text));
        }
        if !results.background.proofs.is_empty() {
            let text = format!(
                "the gains are still being proven optimal; {action} again in a moment, or stop \
                the proof"
            );
            return Err(Message::new("proof-running", text));
        }
        match &results.analysis {
            Some(analysis) if !results.is_waiting() => Ok(Arc::clone(analysis)),
            _ => {
                let text = format!(
                    "the newest results are still being computed; {action} again in a moment"
                );
                Err(Message::new("computation-running", text))
            }
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

fn left_out_suffix(parts: &[String]) -> String {
    if parts.is_empty() {
        return String::new();
    }
    format!("; left out: {}", parts.join(", "))
}

fn remarks_suffix(remarks: &[String]) -> String {
    match remarks {
        [] => String::new(),
        [remark] => format!(" ({remark})"),
        several => format!(" ({} remarks; see the file)", several.len()),
    }
}
