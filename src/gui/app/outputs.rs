//! Files written by the window: corrections, exports for other tools, figures, tables, the report,
//! and the requirement tables, which are also read here. An existing file is overwritten only after
//! the engineer agrees in a form.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::csv_text::{csv_text, save_tables};
use gdcm_io::export::figure_file::{figure_format, write_figure};
use gdcm_io::export::{ExportFormat, ExportRequest, ExportSource, export_contents, write_export};
use gdcm_io::files::corrections_file::write_results;
use gdcm_io::files::requirements_file::{add_tolerances, load_tolerances, read_levels};
use gdcm_io::output_set::OutputSet;
use gdcm_io::report::{ReportSource, ReportSubject, report, save_report};
use gdcm_io::{Existing, FileError};
use gdcm_model::message_text::sanitized_path;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_plot::figure::{ColumnWidth, Figure, FigureFormat, FigureKind};
use gdcm_study::decisions::requirement_settings::RequirementSettings;
use gdcm_study::jobs::job::Job;
use gdcm_study::results::required_modes::KnownPoles;
use gdcm_study::results::time_histories::HistoryRecords;
use gdcm_study::{Analysis, Edit, Engine};
use gdcm_words::Table;

use super::GdcmApp;
use super::files::study_name;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::forms::{FormKind, RequirementTable};
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
        let words = |()| {
            format!(
                "exported {} conditions to {}{absent}",
                chosen.len(),
                sanitized_path(&folder)
            )
        };
        self.written(
            written.map(words),
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

    /// Writes all corrections in a format for other tools; asks before overwriting a file.
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
        let words = |remarks: Vec<String>| {
            let left_out = match left_out.as_slice() {
                [] => String::new(),
                parts => format!("; left out: {}", parts.join(", ")),
            };
            let remark = match remarks.as_slice() {
                [] => String::new(),
                [remark] => format!(" ({remark})"),
                several => format!(" ({} remarks, in the file)", several.len()),
            };
            format!(
                "exported {}: {}{left_out}{remark}{absent}",
                sanitized_path(&path),
                contents.words()
            )
        };
        self.written(
            written.map(words),
            FormKind::ExportAs,
            Command::Output(OutputCommand::ExportAs(format, path.clone())),
        );
    }

    /// Returns the proven analysis of the current study; reports an error if it is incomplete.
    fn complete_results(&mut self) -> Option<Arc<Analysis>> {
        let analysis = self.unless_error(self.analysis_to_write("export"))?;
        // Includes the error bars as far as they are computed.
        let of_this = |bars: &Analysis| bars.study == analysis.study;
        Some(
            self.state
                .analysis_with_bars()
                .filter(of_this)
                .map_or(analysis.clone(), Arc::new),
        )
    }

    /// Returns a suffix explaining missing error bars; empty if they are present.
    fn absent_bars(&self, are_there: bool) -> &'static str {
        let background = &self.state.results.background;
        // Other work may have been stopped while the error bars continue.
        let were_stopped = background.stopped && background.bars.is_none();
        match (are_there, were_stopped) {
            (true, _) => "",
            (false, true) => "; without error bars, for computing them was stopped",
            (false, false) => "; without error bars, which are still being computed",
        }
    }

    /// Returns the suffix of `absent_bars` for a view; figures show error bars as soon as they are
    /// computed.
    fn absent_bars_of(&self, view: View) -> &'static str {
        let shows_bars = view.figure().is_some_and(FigureKind::takes_bars)
            && !self.state.display.gains.hide_bars;
        self.absent_bars(!shows_bars || self.state.uncertainty().is_some())
    }

    /// Returns the complete analysis of the current decisions, or a sentence that explains why
    /// there is none. `what` names the action to repeat later.
    pub(super) fn analysis_to_write(&self, what: &str) -> Result<Arc<Analysis>, String> {
        let results = &self.state.results;
        if results.stopped {
            return Err(format!(
                "{}, for computing was stopped; compute first",
                self.state.after_stop()
            ));
        }
        if !results.background.proofs.is_empty() {
            return Err(format!(
                "the gains are still being proven; {what} again in a moment, or stop it"
            ));
        }
        let analysis = results.analysis.clone().filter(|_| !results.is_waiting());
        analysis.ok_or_else(|| {
            format!("the newest results are still being computed; {what} again in a moment")
        })
    }

    /// Copies the numbers of a view to the clipboard.
    pub(super) fn copy_figure(&mut self, view: View) {
        let tables = tables_in_place(&self.state, view);
        if let Some(tables) = tables.or_else(|| Some(self.figure_of(view)?.tables())) {
            self.ctx.copy_text(csv_text(&tables));
            self.done(format!(
                "copied the numbers of {}{}",
                view.name(),
                self.absent_bars_of(view)
            ));
        }
    }

    /// Asks where to save a view; proposes the folder of the last figure.
    pub(super) fn ask_save_figure(&mut self, view: View, format: FigureFormat) {
        // Tables are saved as numbers, whatever the figure format.
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

    /// Saves a view; asks before overwriting a file.
    pub(super) fn save_figure(&mut self, view: View, width: ColumnWidth, path: PathBuf) {
        let path = self.files.at_home(path);
        let written = match tables_in_place(&self.state, view) {
            Some(tables)
                if figure_format(&path).is_ok_and(|format| format == FigureFormat::Csv) =>
            {
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
        let words = |()| {
            format!(
                "saved {}{}",
                sanitized_path(&path),
                self.absent_bars_of(view)
            )
        };
        let again = Command::Output(OutputCommand::SaveFigure(view, width, path.clone()));
        self.written(written.map(words), FormKind::SaveFigure, again);
    }

    /// Returns the figure of a view; reports an error if there is none yet.
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

    /// Saves a table of the window as CSV; asks before overwriting a file.
    pub(super) fn save_table(&mut self, table: Arc<Table>, path: PathBuf) {
        let path = self.files.at_home(path);
        let written = save_tables(std::slice::from_ref(&*table), &path, self.outputs());
        self.saved_to(
            written,
            &path,
            FormKind::SaveTable,
            Command::Output(OutputCommand::SaveTable(table, path.clone())),
        );
    }

    /// Creates an output set that never overwrites input files, and other files only after
    /// confirmation.
    pub(super) fn outputs(&self) -> OutputSet {
        OutputSet::new(self.dialogs.existing, self.files.inputs())
    }

    /// Writes the files added by `add`, all or none, once `paths` are confirmed to be free.
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

    /// Reports the written files, asks whether `again` may overwrite files, or reports why nothing
    /// was written.
    pub(super) fn written(
        &mut self,
        written: Result<String, FileError>,
        form: FormKind,
        again: Command,
    ) {
        match written {
            Ok(words) => {
                self.state.forms.shown = None;
                self.done(words);
            }
            Err(FileError::Exists { paths }) => self.ask_to_overwrite(&paths, form, again),
            Err(error) => self.notify_error(error.to_string()),
        }
    }

    /// Does the same for a single file.
    pub(super) fn saved_to(
        &mut self,
        saved: Result<(), FileError>,
        path: &Path,
        form: FormKind,
        again: Command,
    ) {
        self.written(
            saved.map(|()| format!("saved {}", sanitized_path(path))),
            form,
            again,
        );
    }

    /// Asks in a form whether `command` may overwrite files.
    pub(super) fn ask_to_overwrite(&mut self, paths: &[PathBuf], form: FormKind, command: Command) {
        self.state.forms.existing = paths.iter().map(|path| sanitized_path(path)).collect();
        self.state.forms.shown = Some(form);
        self.dialogs.overwriting = Some(command);
    }

    /// Asks where to write the report, unless there are no results yet.
    pub(super) fn ask_report(&mut self) {
        if self
            .unless_error(self.analysis_to_write("write the report"))
            .is_some()
        {
            let form = self.state.forms.typed_in(FormKind::Report);
            let name = report_name(
                self.files
                    .saved
                    .path
                    .as_deref()
                    .or(self.files.loaded.path()),
            );
            *form = Path::new(form.trim())
                .with_file_name(name)
                .display()
                .to_string();
            self.state.forms.shown = Some(FormKind::Report);
        }
    }

    /// Starts writing the report; asks before overwriting a file.
    pub(super) fn write_report(&mut self, path: PathBuf) {
        let Some(analysis) = self.unless_error(self.analysis_to_write("write the report")) else {
            return;
        };
        let path = self.files.at_home(path);
        let inputs = self.files.inputs();
        let existing = self.dialogs.existing;
        match self.outputs().check(&[&path]) {
            Ok(()) => {
                let source = ReportSource::of(&self.files.loaded, self.files.saved.path.as_deref());
                self.state.forms.shown = None;
                // The live answer does not depend on the requirements and may have older ones.
                let analysis = Arc::new(analysis.asked_with(&self.state.study.requirements));
                let records = self.state.records.history_records();
                let known = self.state.records.known_poles();
                self.work.reporting = Some(ReportJob {
                    analysis,
                    records,
                    known,
                    source,
                    path,
                    existing,
                    inputs,
                });
            }
            Err(error) => self.written(
                Err(error),
                FormKind::Report,
                Command::Output(OutputCommand::WriteReport(path)),
            ),
        }
    }

    /// Reports the outcome of writing a report.
    pub(super) fn report_written(&mut self, job: ReportJob, outcome: Result<(), FileError>) {
        self.work.reporting = None;
        match outcome {
            Ok(()) => self.done(format!("wrote the report {}", sanitized_path(&job.path))),
            Err(error) => self.written(
                Err(error),
                FormKind::Report,
                Command::Output(OutputCommand::WriteReport(job.path)),
            ),
        }
    }

    /// Reports that a running report was stopped, by hand or by a fault.
    pub(super) fn give_up_report(&mut self) {
        if let Some(job) = self.work.reporting.take() {
            self.notify_error(format!(
                "{} was not written: it was stopped",
                sanitized_path(&job.path)
            ));
        }
    }

    /// Reads a requirement table into the study.
    pub(super) fn read_requirement_table(&mut self, table: RequirementTable, path: PathBuf) {
        let path = self.files.at_home(path);
        let mut settings = RequirementSettings::clone(&self.state.study.requirements);
        let (what, read) = match table {
            RequirementTable::Levels => (
                "levels",
                read_levels(&path).map(|levels| (settings.levels = levels, Vec::new()).1),
            ),
            RequirementTable::Tolerances => {
                let read = load_tolerances(&path);
                (
                    "tolerances",
                    read.map(|(tolerances, cautions)| {
                        (settings.tolerances = tolerances, cautions).1
                    }),
                )
            }
        };
        let Some(cautions) = self.unless_error(read) else {
            return;
        };
        self.state.forms.shown = None;
        self.decide(&Edit::SetRequirements(what, Arc::new(settings)));
        if !cautions.is_empty() {
            self.notify_error(format!(
                "taken, but {}: {}",
                sanitized_path(&path),
                cautions.join("; ")
            ));
        }
    }

    /// Asks where to write the tolerances.
    pub(super) fn ask_write_tolerances(&mut self) {
        let field = self.state.forms.typed_in(FormKind::WriteTolerances);
        if field.is_empty() {
            "tolerances.json".clone_into(field);
        }
        self.state.forms.shown = Some(FormKind::WriteTolerances);
    }

    /// Writes the study's tolerances; asks before overwriting a file.
    pub(super) fn write_tolerances(&mut self, path: PathBuf) {
        let path = self.files.at_home(path);
        let tolerances = &self.state.study.requirements.tolerances;
        let written = self.write_all(&[], |outputs| add_tolerances(tolerances, &path, outputs));
        self.saved_to(
            written,
            &path,
            FormKind::WriteTolerances,
            Command::File(FileCommand::WriteTolerances(path.clone())),
        );
    }
}

/// Job that builds and writes a report; takes seconds, because it draws every plot.
#[derive(Clone, Debug)]
pub struct ReportJob {
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
        let decided = |job: &Self| (job.source.clone(), job.path.clone(), job.existing);
        let same_analysis = Arc::ptr_eq(&self.analysis, &other.analysis);
        same_analysis
            && decided(self) == decided(other)
            && (&self.records, &self.known) == (&other.records, &other.known)
    }
}

impl Job for ReportJob {
    /// The engine that caches the responses to draw.
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
        // After a stop the file is no longer wanted.
        if progress.cancelled() {
            return Err(Cancelled);
        }
        Ok(save_report(
            &report,
            &self.path,
            OutputSet::new(self.existing, self.inputs.clone()),
        ))
    }
}

/// Returns a report name for a study or a dataset: `flight-7-report.html`.
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
        assert_eq!(
            report_name(Some(Path::new("/a/flight 7.gdcm-study.json"))),
            "flight 7-report.html"
        );
        assert_eq!(
            report_name(Some(Path::new("data.json.gz"))),
            "data-report.html"
        );
    }
}
