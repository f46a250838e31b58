//! What the window writes to files: corrections, exports for other tools, figures and tables, the report, and the tables that requirements
//! are asked with, which are read here too. A file that is there is written over only where the engineer said so in a form.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::corrections_file::write_results;
use gdcm_io::exports::{ExportFormat, ExportRequest, ExportSource, export_contents, write_export};
use gdcm_io::figure_file::{csv_text, figure_format, save_tables, write_figure};
use gdcm_io::output_set::OutputSet;
use gdcm_io::report_file::{ReportSource, ReportSubject, report, save_report};
use gdcm_io::requirements_file::{add_tolerances, load_tolerances, read_levels};
use gdcm_io::{Existing, FileError};
use gdcm_model::message_text::sanitized_path;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_plot::figure::{ColumnWidth, Figure, FigureFormat, FigureKind};
use gdcm_study::study::job::Job;
use gdcm_study::study::required_modes::KnownPoles;
use gdcm_study::study::requirements::RequirementSettings;
use gdcm_study::study::time_histories::HistoryRecords;
use gdcm_study::study::{Analysis, Edit, Engine, Table};

use super::GdcmApp;
use super::files::study_name;
use crate::view::figures::{figure_name, figure_of, tables_in_place};
use crate::view::views::{all_records, known_poles};
use crate::view::{Command, FormKind, RequirementTable, View};

impl GdcmApp {
    /// Writes the corrections of the conditions chosen in the form.
    pub(super) fn export(&mut self) {
        let Some(analysis) = self.complete_results() else {
            return;
        };
        let chosen = self.state.forms.exported.clone();
        let folder = PathBuf::from(self.state.forms.typed_in(FormKind::Export).trim());
        let folder = self.at_home(folder);
        let written = write_results(
            &analysis,
            &self.loaded.sha256,
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
        self.written(written.map(words), FormKind::Export, Command::Export);
    }

    /// Proposes a name for an export for other tools, where none was typed.
    pub(super) fn propose_export_name(&mut self) {
        let stem = self.stem();
        let extension = self.state.forms.export_format.extension;
        let path = self.state.forms.typed_in(FormKind::ExportAs);
        if path.is_empty() {
            *path = format!("{stem}.{extension}");
        }
    }

    /// Writes all corrections in a format for other tools; asks before it overwrites a file.
    pub(super) fn export_as(&mut self, format: ExportFormat, path: PathBuf) {
        let Some(analysis) = self.complete_results() else {
            return;
        };
        let path = self.at_home(path);
        let source = ExportSource {
            name: self.state.study_name.clone(),
            sha256: self.loaded.sha256.clone(),
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
            Command::ExportAs(format, path.clone()),
        );
    }

    /// The analysis of what is shown, proven; where it is not there yet, that is said.
    fn complete_results(&mut self) -> Option<Arc<Analysis>> {
        let analysis = self.unless_error(self.analysis_to_write("export"))?;
        // With how sure its figures are, as far as that is computed.
        let of_this = |bars: &Analysis| bars.study == analysis.study;
        Some(
            self.state
                .analysis_with_bars()
                .filter(of_this)
                .map_or(analysis.clone(), Arc::new),
        )
    }

    /// What is said of a file that lacks the error bars it could have; nothing of one that has them.
    fn absent_bars(&self, are_there: bool) -> &'static str {
        let background = &self.state.results.background;
        // Something else may have been stopped while they go on.
        let were_stopped = background.stopped && background.bars.is_none();
        match (are_there, were_stopped) {
            (true, _) => "",
            (false, true) => "; without error bars, for computing them was stopped",
            (false, false) => "; without error bars, which are still being computed",
        }
    }

    /// The same of what a view shows: some have error bars as soon as they are computed.
    fn absent_bars_of(&self, view: View) -> &'static str {
        let shows_bars =
            view.figure().is_some_and(FigureKind::takes_bars) && !self.state.display.hide_bars;
        self.absent_bars(!shows_bars || self.state.uncertainty().is_some())
    }

    /// The analysis, where it is complete and of what is decided now; otherwise a sentence that says why not. `what` could be done
    /// again once it is.
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

    /// Puts the numbers of a view on the clipboard.
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

    /// Asks where to save a view; the folder of the last figure is proposed.
    pub(super) fn ask_save_figure(&mut self, view: View, format: FigureFormat) {
        // Tables are numbers, whatever a figure in their place would be saved as.
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

    /// Saves a view; asks before it overwrites a file.
    pub(super) fn save_figure(&mut self, view: View, width: ColumnWidth, path: PathBuf) {
        let path = self.at_home(path);
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
        let again = Command::SaveFigure(view, width, path.clone());
        self.written(written.map(words), FormKind::SaveFigure, again);
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
        let name: String = name
            .chars()
            .filter(|letter| letter.is_alphanumeric() || *letter == ' ')
            .collect();
        self.state.forms.table = Some(table);
        *self.state.forms.typed_in(FormKind::SaveTable) = format!("{}.csv", name.replace(' ', "-"));
        self.state.forms.shown = Some(FormKind::SaveTable);
    }

    /// Saves a table of the window as CSV; asks before it overwrites a file.
    pub(super) fn save_table(&mut self, table: Arc<Table>, path: PathBuf) {
        let path = self.at_home(path);
        let written = save_tables(std::slice::from_ref(&*table), &path, self.outputs());
        self.saved_to(
            written,
            &path,
            FormKind::SaveTable,
            Command::SaveTable(table, path.clone()),
        );
    }

    /// Where results go: never over what the program reads from, and over other files only where that was agreed to.
    pub(super) fn outputs(&self) -> OutputSet {
        OutputSet::new(self.existing, self.inputs())
    }

    /// Writes what `add` adds, all of it or nothing, once `paths` were found to be free.
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

    /// Says what was written, asks in a form whether `again` may write over files, or says why nothing was written.
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

    /// The same of one file.
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

    /// Asks in a form whether to overwrite files, which `command` would do.
    pub(super) fn ask_to_overwrite(&mut self, paths: &[PathBuf], form: FormKind, command: Command) {
        self.state.forms.existing = paths.iter().map(|path| sanitized_path(path)).collect();
        self.state.forms.shown = Some(form);
        self.overwriting = Some(command);
    }

    /// What the program reads from, which is never overwritten by results.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.saved
            .path
            .iter()
            .cloned()
            .chain(self.loaded.origin.file())
            .collect()
    }

    /// Asks where to write the report, unless there is nothing to report on yet.
    pub(super) fn ask_report(&mut self) {
        if self
            .unless_error(self.analysis_to_write("write the report"))
            .is_some()
        {
            let form = self.state.forms.typed_in(FormKind::Report);
            let name = report_name(self.saved.path.as_deref().or(self.loaded.path()));
            *form = Path::new(form.trim())
                .with_file_name(name)
                .display()
                .to_string();
            self.state.forms.shown = Some(FormKind::Report);
        }
    }

    /// Has the report written; asks before it overwrites a file.
    pub(super) fn write_report(&mut self, path: PathBuf) {
        let Some(analysis) = self.unless_error(self.analysis_to_write("write the report")) else {
            return;
        };
        let path = self.at_home(path);
        let inputs = self.inputs();
        let existing = self.existing;
        match self.outputs().check(&[&path]) {
            Ok(()) => {
                let source = ReportSource::of(&self.loaded, self.saved.path.as_deref());
                self.state.forms.shown = None;
                // What requirements are asked with has no part in the live answer, which may be older.
                let analysis = Arc::new(analysis.asked_with(&self.state.study.requirements));
                let records = all_records(&self.state);
                let known = known_poles(&self.state);
                self.reporting = Some(ReportJob {
                    analysis,
                    records,
                    known,
                    source,
                    path,
                    existing,
                    inputs,
                });
            }
            Err(error) => self.written(Err(error), FormKind::Report, Command::WriteReport(path)),
        }
    }

    /// Says what came of a report.
    pub(super) fn report_written(&mut self, job: ReportJob, outcome: Result<(), FileError>) {
        self.reporting = None;
        match outcome {
            Ok(()) => self.done(format!("wrote the report {}", sanitized_path(&job.path))),
            Err(error) => {
                self.written(Err(error), FormKind::Report, Command::WriteReport(job.path))
            }
        }
    }

    /// Says that a report under way was given up, by hand or by a fault.
    pub(super) fn give_up_report(&mut self) {
        if let Some(job) = self.reporting.take() {
            self.notify_error(format!(
                "{} was not written: it was stopped",
                sanitized_path(&job.path)
            ));
        }
    }

    /// Takes a table into the study.
    pub(super) fn read_requirement_table(&mut self, table: RequirementTable, path: PathBuf) {
        let path = self.at_home(path);
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

    /// Writes the tolerances of the study; asks before it overwrites a file.
    pub(super) fn write_tolerances(&mut self, path: PathBuf) {
        let path = self.at_home(path);
        let tolerances = &self.state.study.requirements.tolerances;
        let written = self.write_all(&[], |outputs| add_tolerances(tolerances, &path, outputs));
        self.saved_to(
            written,
            &path,
            FormKind::WriteTolerances,
            Command::WriteTolerances(path.clone()),
        );
    }
}

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
        let subject = ReportSubject {
            analysis: &self.analysis,
            histories: histories.as_ref(),
            known: &self.known,
        };
        let report = report(subject, &self.source, engine, progress)?;
        // Whoever stopped it does not want a file any more.
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
