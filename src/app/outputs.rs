//! What the window writes to files: corrections, exports for other tools, figures and tables. A file that is there is written over
//! only where the engineer said so in a form.

use gdcm_core::message_text::sanitized_path;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::view::{Command, FormKind, View, figure_name, figure_of, tables_in_place};
use gdcm_core::study::{Analysis, Table};
use gdcm_files::figure::{ColumnWidth, Figure, FigureFormat};
use gdcm_files::{
    ExportFormat, ExportRequest, ExportSource, FileError, OutputSet, csv_text, figure_format, save_tables,
    write_export, write_figure, write_results,
};

use super::GdcmApp;

impl GdcmApp {
    /// Writes the corrections of the conditions chosen in the form.
    pub(super) fn export(&mut self) {
        let Some(analysis) = self.complete_results() else { return };
        let chosen = self.state.forms.exported.clone();
        let folder = PathBuf::from(self.state.forms.typed_in(FormKind::Export).trim());
        let folder = self.at_home(folder);
        let written = write_results(&analysis, &self.loaded.sha256, &chosen, &folder, self.outputs());
        let words = |()| format!("exported {} conditions to {}", chosen.len(), sanitized_path(&folder));
        self.written(written.map(words), FormKind::Export, Command::Export);
    }

    /// Shows the form that exports for other tools; a name is proposed where none was typed.
    pub(super) fn ask_export_as(&mut self) {
        let stem = self.loaded.path().and_then(Path::file_stem).map(|stem| stem.to_string_lossy().into_owned());
        let extension = self.state.forms.export_format.extension;
        let path = self.state.forms.typed_in(FormKind::ExportAs);
        if path.is_empty() {
            let stem = stem.unwrap_or_else(|| "example".to_owned());
            *path = format!("{}.{extension}", stem.trim_end_matches(".json"));
        }
    }

    /// Writes all corrections in a format for other tools; asks before it overwrites a file.
    pub(super) fn export_as(&mut self, format: ExportFormat, path: PathBuf) {
        let Some(analysis) = self.complete_results() else { return };
        let path = self.at_home(path);
        let source = ExportSource { name: self.state.study_name.clone(), sha256: self.loaded.sha256.clone() };
        let request = ExportRequest { format, ..ExportRequest::default() };
        let written = write_export(&analysis, &source, &request, &path, self.outputs());
        let words = |remarks: Vec<String>| {
            let remark = match remarks.as_slice() {
                [] => String::new(),
                [remark] => format!(" ({remark})"),
                several => format!(" ({} remarks, in the file)", several.len()),
            };
            format!("exported {}{remark}", sanitized_path(&path))
        };
        self.written(written.map(words), FormKind::ExportAs, Command::ExportAs(format, path.clone()));
    }

    /// The analysis of what is shown, proven; where it is not there yet, that is said.
    fn complete_results(&mut self) -> Option<Arc<Analysis>> {
        let analysis = self.analysis_to_write("export").map_err(|why| self.notify_error(why)).ok()?;
        // With how sure its figures are, as far as that is computed.
        let of_this = |bars: &Analysis| bars.study == analysis.study;
        Some(self.state.analysis_with_bars().filter(of_this).map_or(analysis.clone(), Arc::new))
    }

    /// The analysis, where it is complete and of what is decided now; otherwise a sentence that says why not. `what` could be done
    /// again once it is.
    pub(super) fn analysis_to_write(&self, what: &str) -> Result<Arc<Analysis>, String> {
        let results = &self.state.results;
        if results.stopped {
            return Err(format!("{}, for computing was stopped; compute first", self.state.after_stop()));
        }
        if !results.background.proofs.is_empty() {
            return Err(format!("the gains are still being proven; {what} again in a moment, or stop it"));
        }
        let analysis = results.analysis.clone().filter(|_| !results.is_waiting());
        analysis.ok_or_else(|| format!("the newest results are still being computed; {what} again in a moment"))
    }

    /// Puts the numbers of a view on the clipboard.
    pub(super) fn copy_figure(&mut self, view: View) {
        let tables = tables_in_place(&self.state, view);
        if let Some(tables) = tables.or_else(|| Some(self.figure_of(view)?.tables())) {
            self.ctx.copy_text(csv_text(&tables));
            self.done(format!("copied the numbers of {}", view.name()));
        }
    }

    /// Asks where to save a view; the folder of the last figure is proposed.
    pub(super) fn ask_save_figure(&mut self, view: View, format: FigureFormat) {
        // Tables are numbers, whatever a figure in their place would be saved as.
        let format = if tables_in_place(&self.state, view).is_some() { FigureFormat::Csv } else { format };
        let name = format!("{}.{}", figure_name(&self.state, view), format.extension());
        self.state.forms.figure = Some(view);
        let path = self.state.forms.typed_in(FormKind::SaveFigure);
        *path = Path::new(path.trim()).with_file_name(name).display().to_string();
        self.state.forms.shown = Some(FormKind::SaveFigure);
    }

    /// Saves a view; asks before it overwrites a file.
    pub(super) fn save_figure(&mut self, view: View, width: ColumnWidth, path: PathBuf) {
        let path = self.at_home(path);
        let written = match tables_in_place(&self.state, view) {
            Some(tables) if figure_format(&path).is_ok_and(|format| format == FigureFormat::Csv) => {
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
                let Some(figure) = self.figure_of(view) else { return };
                write_figure(&figure, width, &path, self.outputs())
            }
        };
        self.saved_to(written, &path, FormKind::SaveFigure, Command::SaveFigure(view, width, path.clone()));
    }

    /// The figure of a view; where there is none yet, that is said.
    fn figure_of(&mut self, view: View) -> Option<Figure> {
        let figure = figure_of(&self.state, view);
        if figure.is_none() {
            self.notify_error(format!(
                "{} has nothing to take away yet: {}",
                view.name(),
                self.state.results.absence()
            ));
        }
        figure
    }

    /// Asks where to save a table as it is now.
    pub(super) fn ask_save_table(&mut self, name: &str, table: Arc<Table>) {
        let name: String = name.chars().filter(|letter| letter.is_alphanumeric() || *letter == ' ').collect();
        self.state.forms.table = Some(table);
        *self.state.forms.typed_in(FormKind::SaveTable) = format!("{}.csv", name.replace(' ', "-"));
        self.state.forms.shown = Some(FormKind::SaveTable);
    }

    /// Saves a table of the window as CSV; asks before it overwrites a file.
    pub(super) fn save_table(&mut self, table: Arc<Table>, path: PathBuf) {
        let path = self.at_home(path);
        let written = save_tables(std::slice::from_ref(&*table), &path, self.outputs());
        self.saved_to(written, &path, FormKind::SaveTable, Command::SaveTable(table, path.clone()));
    }

    /// Where results go: never over what the program reads from, and over other files only where that was agreed to.
    pub(super) fn outputs(&self) -> OutputSet {
        OutputSet::new(self.existing, self.inputs())
    }

    /// Says what was written, asks in a form whether `again` may write over files, or says why nothing was written.
    pub(super) fn written(&mut self, written: Result<String, FileError>, form: FormKind, again: Command) {
        match written {
            Ok(words) => {
                self.state.forms.shown = None;
                self.done(words);
            }
            Err(FileError::Exists { paths }) => self.ask_to_overwrite(&paths, form, again),
            Err(error) => self.notify_error(error.to_string()),
        }
    }

    /// The same of one file.
    pub(super) fn saved_to(&mut self, saved: Result<(), FileError>, path: &Path, form: FormKind, again: Command) {
        self.written(saved.map(|()| format!("saved {}", sanitized_path(path))), form, again);
    }

    /// Asks in a form whether to overwrite files, which `command` would do.
    pub(super) fn ask_to_overwrite(&mut self, paths: &[PathBuf], form: FormKind, command: Command) {
        self.state.forms.existing = paths.iter().map(|path| sanitized_path(path)).collect();
        self.state.forms.shown = Some(form);
        self.overwriting = Some(command);
    }

    /// What the program reads from, which is never overwritten by results.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.saved.path.iter().cloned().chain(self.loaded.origin.file()).collect()
    }
}
