//! Exporting the corrections: the dialog's dry run, the written files and the report.
//!
//! A *dry run* is a background job that computes every file except the report without writing any;
//! its outcome is the *plan*, with the contents and notes that the dialog shows. The dialog
//! composes the report in a job of its own.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_io::Existing;
use gdcm_io::FileError;
use gdcm_io::export::ExportSource;
use gdcm_io::export::export_set::ExportPlan;
use gdcm_io::output_set::OutputSet;
use gdcm_io::report::Report;
use gdcm_method::schedule::DelayScheduling;
use gdcm_model::message_text::sanitized_path;
use gdcm_model::number_format::counted;
use gdcm_study::decisions::setting_table;
use gdcm_study::decisions::setting_value::Value;
use gdcm_study::results::export_note::ExportRemedy;

use super::GdcmApp;
use super::export_command_line::{CommandSource, export_command_line};
use crate::gui::state::export_form::{ExportForm, ExportPlanJob};
use crate::gui::state::forms::FormKind;
use crate::gui::state::notices::Activity;
use crate::message::Message;

/// Polynomial degree over airspeed with which the export remedy lets signed delays vary.
const SIGNED_DELAY_DEGREE: usize = 1;

impl GdcmApp {
    /// Fills the export dialog with the choices stored in the study.
    pub(super) fn open_export_form(&mut self) {
        let study = self.files.saved.path.as_deref();
        let file = study.or(self.files.loaded.path());
        let folder = match self.files.proposed_folder() {
            Some(folder) => folder.display().to_string(),
            None => String::new(),
        };
        let name = self.files.stem();
        let state = &self.state;
        let mut form = ExportForm::new(&state.study.exports, state.dataset(), &folder, &name);
        form.default_breakpoints_kt = state.scheduled_airspeeds_kt();
        form.home.clone_from(&self.files.home);
        form.source = Some(ExportSource::new(file, &self.files.loaded.sha256));
        self.state.forms.export = form;
    }

    /// Stores a dry run's outcome; writes the files if the engineer has chosen Export meanwhile, and
    /// has not closed the dialog since.
    pub(super) fn take_export_plan(&mut self, job: ExportPlanJob, plan: ExportPlan) {
        self.state.forms.export.plan = Some((job, plan));
        // If the report is composed already, the plan takes over its notes.
        self.state.forms.export.join_report_notes();
        let is_awaited = std::mem::take(&mut self.state.forms.export.is_awaited);
        if is_awaited && self.state.forms.shown == Some(FormKind::Export) {
            self.export();
        }
    }

    /// Writes the files that the export dialog lists. Errors are shown in the dialog:
    ///
    /// 1. if the form is incomplete, show what is missing;
    /// 2. if the results are incomplete, show why;
    /// 3. if the dry run has not ended, wait: [`Self::take_export_plan`] calls this function again;
    /// 4. write the files; if that fails, request a new dry run, which sees what is in the folder
    ///    now;
    /// 5. close the dialog, and start the report, which is written when its job ends.
    pub(super) fn export(&mut self) {
        // Step 1.
        let form = &mut self.state.forms.export;
        form.error = None;
        if let Err(message) = form.export_set() {
            form.error = Some(message);
            return;
        }
        // Step 2.
        if let Some(message) = self.state.incomplete_results() {
            self.state.forms.export.error = Some(message);
            return;
        }
        // Step 3.
        let Some(plan) = self.state.current_export_plan() else {
            self.state.forms.export.is_awaited = true;
            return;
        };
        // Step 4.
        let plan = plan.clone();
        let folder = self.state.forms.export.folder_path();
        let existing = if self.state.forms.export.choices.replaces {
            Existing::Replace
        } else {
            Existing::Keep
        };
        match self.write_export(&plan, existing) {
            Ok(paths) => self.exported(&plan, folder, paths.len(), existing),
            Err(error) => {
                let form = &mut self.state.forms.export;
                form.error = Some(error.into());
                form.revision += 1;
            }
        }
    }

    /// Writes the planned files. The report is written later (step 5), but its path is checked
    /// here, so that nothing is written if the report cannot be.
    fn write_export(
        &self,
        plan: &ExportPlan,
        existing: Existing,
    ) -> Result<Vec<PathBuf>, FileError> {
        let folder = self.state.forms.export.folder_path();
        let outputs = OutputSet::new(existing, self.files.inputs());
        if let Some(name) = &plan.report {
            outputs.check(&[folder.join(name)])?;
        }
        plan.write(&folder, outputs)
    }

    /// Step 5: closes the dialog after the files were written, reports them, stores the choices in
    /// the study if this was chosen, and starts the report if it is among the files.
    fn exported(&mut self, plan: &ExportPlan, folder: PathBuf, count: usize, existing: Existing) {
        self.state.forms.shown = None;
        // Before the dialog's contents are dropped.
        let report = self.current_report();
        let form = &self.state.forms.export;
        if form.remembers {
            self.state.study.exports = Arc::new(form.all_choices());
            self.study_changed();
        }
        self.state.forms.export.drop_contents();
        self.files.last_folder = Some(folder.clone());
        // If the report is the only file, its job reports it.
        if count > 0 {
            let text = format!(
                "exported {} to {}",
                counted(count, "file"),
                sanitized_path(&folder)
            );
            // The notice offers the folder that contains the given file, so any file name will do.
            let any_file = folder.join("file");
            self.notify_written_to(Activity::Export, Message::new("exported", text), &any_file);
        }
        if let Some(name) = &plan.report {
            self.start_report(folder.join(name), existing, report);
        }
    }

    /// Returns the report that the dialog has composed of the displayed analysis, if any.
    fn current_report(&self) -> Option<Arc<Report>> {
        let analysis = self.state.results.analysis.as_ref()?;
        self.state.forms.export.report_of(analysis).map(Arc::clone)
    }

    /// Carries out a remedy that the dialog offers; a change of the study starts a new analysis,
    /// followed by a new dry run.
    pub(super) fn apply_export_remedy(&mut self, remedy: ExportRemedy) {
        if self.state.forms.export.apply_remedy(remedy) {
            return;
        }
        match remedy {
            ExportRemedy::ScheduleDelays => {
                self.decide(&setting_table::SCHEDULE_DELAYS.to(DelayScheduling::Always));
            }
            ExportRemedy::SignedDelaysOverAirspeed => {
                self.decide(&setting_table::TAU_DEGREE.to(Value::Choice(SIGNED_DELAY_DEGREE)));
            }
            // The other remedies change the form: `ExportForm::apply_remedy` has carried them out.
            _ => {}
        }
    }

    /// Copies the command line from [`Self::export_command`]; an error is shown in the dialog.
    pub(super) fn copy_export_command(&mut self) {
        match self.export_command() {
            Ok(line) => {
                self.ctx.copy_text(line);
                let text = "copied the equivalent command line";
                self.notify_done(Message::new("command-line-copied", text));
            }
            Err(message) => self.state.forms.export.error = Some(message),
        }
    }

    /// Returns the command line that writes the files that the export dialog lists.
    ///
    /// # Errors
    /// A message if the form is incomplete, or if the study must be saved first because options
    /// cannot express its decisions.
    pub fn export_command(&self) -> Result<String, Message> {
        let source = CommandSource::from_files(&self.files);
        export_command_line(&self.state.study, &source, &self.state.forms.export)
    }
}
