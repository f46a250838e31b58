//! Files written by the window: corrections, exports for other tools, figures and tables. An
//! existing file is overwritten only after the engineer agrees in a form.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::FileError;
use gdcm_io::csv_text::{csv_text, save_tables};
use gdcm_io::export::figure_file::{figure_format, write_figure};
use gdcm_io::export::{ExportFormat, ExportRequest, ExportSource, export_contents, write_export};
use gdcm_io::files::corrections_file::write_results;
use gdcm_io::output_set::OutputSet;
use gdcm_model::message_text::sanitized_path;
use gdcm_model::number_format::counted;
use gdcm_plot::figure::{ColumnWidth, Figure, FigureFormat, FigureKind};
use gdcm_study::Analysis;
use gdcm_words::Table;

use super::GdcmApp;
use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::view::View;
use crate::gui::views::figure_button::tables_in_place;
use crate::gui::views::figures::{figure_name, figure_of};

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
        let absent = self.absent_bars(analysis.uncertainty.is_some());
        let message = format!(
            "exported {} to {}{absent}",
            counted(chosen.len(), "condition"),
            sanitized_path(&folder)
        );
        self.notify_written(
            written.map(|()| message),
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
        let absent = self.absent_bars(analysis.uncertainty.is_some());
        let message = written.map(|remarks| {
            format!(
                "exported {}: {}{}{}{absent}",
                sanitized_path(&path),
                contents.words(),
                left_out_suffix(&left_out),
                remarks_suffix(&remarks)
            )
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

    /// Returns the end of a message, which explains missing error bars; empty if they are present.
    fn absent_bars(&self, are_present: bool) -> &'static str {
        let background = &self.state.results.background;
        // If the error bars are still being computed, only other work was stopped.
        let were_stopped = background.stopped && background.error_bars.is_none();
        if are_present {
            ""
        } else if were_stopped {
            "; without error bars: their computation was stopped"
        } else {
            "; without error bars, which are still being computed"
        }
    }

    /// Returns the end of a message about a view's figure, as [`Self::absent_bars`] does; empty if
    /// the view shows no error bars.
    fn absent_bars_of(&self, view: View) -> &'static str {
        let shows_bars = view.figure().is_some_and(FigureKind::takes_bars)
            && !self.state.display.gains.hide_bars;
        self.absent_bars(!shows_bars || self.state.uncertainty().is_some())
    }

    /// Returns the complete analysis for the current decisions, or a sentence that explains why
    /// there is none and asks the engineer to repeat `action` later.
    pub(super) fn analysis_to_write(&self, action: &str) -> Result<Arc<Analysis>, String> {
        let results = &self.state.results;
        if results.stopped {
            return Err(format!(
                "{}: the computation was stopped; choose Compute first",
                self.state.after_stop()
            ));
        }
        if !results.background.proofs.is_empty() {
            return Err(format!(
                "the gains are still being proven optimal; {action} again in a moment, or stop \
                the proof"
            ));
        }
        match &results.analysis {
            Some(analysis) if !results.is_waiting() => Ok(Arc::clone(analysis)),
            _ => Err(format!(
                "the newest results are still being computed; {action} again in a moment"
            )),
        }
    }

    /// Copies the values shown by a view to the clipboard.
    pub(super) fn copy_figure(&mut self, view: View) {
        let tables = match tables_in_place(&self.state, view) {
            Some(tables) => tables,
            None => match self.figure_of(view) {
                Some(figure) => figure.tables(),
                None => return,
            },
        };
        self.ctx.copy_text(csv_text(&tables));
        self.notify_done(format!(
            "copied the numbers of {}{}",
            view.name(),
            self.absent_bars_of(view)
        ));
    }

    /// Asks where to save a view; proposes the folder in which the previous figure was saved.
    pub(super) fn ask_save_figure(&mut self, view: View, format: FigureFormat) {
        // Tables are saved as CSV, whatever the figure format.
        let format = if tables_in_place(&self.state, view).is_some() {
            FigureFormat::Csv
        } else {
            format
        };
        let name = format!("{}.{}", figure_name(&self.state, view), format.extension());
        self.state.forms.figure = Some(view);
        let path = self.state.forms.typed_in(FormKind::SaveFigure);
        *path = Path::new(path.trim())
            .with_file_name(name)
            .display()
            .to_string();
        self.state.forms.shown = Some(FormKind::SaveFigure);
    }

    /// Saves a view; asks before overwriting.
    pub(super) fn save_figure(&mut self, view: View, width: ColumnWidth, path: PathBuf) {
        let path = self.files.at_home(path);
        let written = match tables_in_place(&self.state, view) {
            Some(tables) if matches!(figure_format(&path), Ok(FigureFormat::Csv)) => {
                save_tables(&tables, &path, self.outputs())
            }
            Some(_) => {
                let found = sanitized_path(&path);
                return self.notify_error(format!(
                    "{} shows tables here: expected a name that ends in .csv, found {found}",
                    view.name()
                ));
            }
            None => {
                let Some(figure) = self.figure_of(view) else {
                    return;
                };
                write_figure(&figure, width, &path, self.outputs())
            }
        };
        let message = format!(
            "saved {}{}",
            sanitized_path(&path),
            self.absent_bars_of(view)
        );
        let again = Command::Output(OutputCommand::SaveFigure(view, width, path.clone()));
        self.notify_written(written.map(|()| message), FormKind::SaveFigure, again);
    }

    /// Returns the figure of a view; reports an error if the view has none yet.
    fn figure_of(&mut self, view: View) -> Option<Figure> {
        let figure = figure_of(&self.state, view);
        if figure.is_none() {
            self.notify_error(format!(
                "{} has no figure yet: {}",
                view.name(),
                self.state.results.absence()
            ));
        }
        figure
    }

    /// Asks where to save a table in its current state.
    pub(super) fn ask_save_table(&mut self, name: &str, table: Arc<Table>) {
        let name: String = name
            .chars()
            .filter(|letter| letter.is_alphanumeric() || *letter == ' ')
            .collect();
        self.state.forms.table = Some(table);
        *self.state.forms.typed_in(FormKind::SaveTable) = format!("{}.csv", name.replace(' ', "-"));
        self.state.forms.shown = Some(FormKind::SaveTable);
    }

    /// Saves a table as CSV; asks before overwriting.
    pub(super) fn save_table(&mut self, table: Arc<Table>, path: PathBuf) {
        let path = self.files.at_home(path);
        let written = save_tables(std::slice::from_ref(&*table), &path, self.outputs());
        self.notify_saved(
            written,
            &path,
            FormKind::SaveTable,
            Command::Output(OutputCommand::SaveTable(table, path.clone())),
        );
    }

    /// Creates an output set that never overwrites input files, and overwrites other files only
    /// after confirmation.
    pub(super) fn outputs(&self) -> OutputSet {
        OutputSet::new(self.dialogs.existing, self.files.inputs())
    }

    /// Writes all files that `add` adds to the set, or none. First checks that none of `paths`
    /// would be overwritten without consent.
    pub(super) fn write_all(
        &self,
        paths: &[&Path],
        add: impl FnOnce(&mut OutputSet) -> Result<(), FileError>,
    ) -> Result<(), FileError> {
        let mut outputs = self.outputs();
        outputs.check(paths)?;
        add(&mut outputs)?;
        outputs.persist()
    }

    /// Reports the written files, or why none was written. If files exist, asks whether the command
    /// `again` may overwrite them.
    pub(super) fn notify_written(
        &mut self,
        written: Result<String, FileError>,
        form: FormKind,
        again: Command,
    ) {
        match written {
            Ok(message) => {
                self.state.forms.shown = None;
                self.notify_done(message);
            }
            Err(FileError::Exists { paths }) => self.ask_to_overwrite(&paths, form, again),
            Err(error) => self.notify_error(error.to_string()),
        }
    }

    /// Reports a single saved file, or the error. If the file exists, asks whether the command
    /// `again` may overwrite it.
    pub(super) fn notify_saved(
        &mut self,
        saved: Result<(), FileError>,
        path: &Path,
        form: FormKind,
        again: Command,
    ) {
        self.notify_written(
            saved.map(|()| format!("saved {}", sanitized_path(path))),
            form,
            again,
        );
    }

    /// Asks in a form whether `command` may overwrite the files at `paths`.
    pub(super) fn ask_to_overwrite(&mut self, paths: &[PathBuf], form: FormKind, command: Command) {
        self.state.forms.existing = paths.iter().map(|path| sanitized_path(path)).collect();
        self.state.forms.shown = Some(form);
        self.dialogs.overwriting = Some(command);
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
