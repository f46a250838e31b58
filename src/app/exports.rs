//! Writing corrections to files.

use gdcm_core::message_text::sanitized_path;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::view::command::{Command, FormKind};
use gdcm_core::study::{Analysis, ExportFormat, ExportRequest};
use gdcm_files::{Existing, ExportSource, FileError, OutputSet, write_export, write_results};

use super::window::GdcmApp;

impl GdcmApp {
    /// Writes the corrections of the conditions chosen in the form.
    pub(super) fn export(&mut self, existing: Existing) {
        let Some(analysis) = self.complete_results() else { return };
        let form = &self.state.forms.export;
        let chosen = form.chosen.clone();
        let folder = self.at_home(PathBuf::from(form.folder.trim()));
        let outputs = OutputSet::new(existing, self.inputs());
        match write_results(&analysis, &self.loaded.sha256, &chosen, &folder, outputs) {
            Ok(()) => {
                self.state.forms.shown = None;
                self.done(format!("exported {} conditions to {}", chosen.len(), sanitized_path(&folder)));
            }
            Err(FileError::Exists { paths }) => self.ask_to_overwrite(&paths, FormKind::Export, Command::Export),
            Err(error) => self.notify_error(error.to_string()),
        }
    }

    /// Shows the form that exports for other tools; a name is proposed where none was typed.
    pub(super) fn ask_export_as(&mut self) {
        let stem = self.loaded.path().and_then(Path::file_stem).map(|stem| stem.to_string_lossy().into_owned());
        let form = &mut self.state.forms.export_as;
        if form.path.is_empty() {
            let stem = stem.unwrap_or_else(|| "example".to_owned());
            form.path = format!("{}.{}", stem.trim_end_matches(".json"), form.format.extension());
        }
    }

    /// Writes all corrections in a format for other tools; asks before it overwrites a file.
    pub(super) fn export_as(&mut self, format: ExportFormat, path: PathBuf, existing: Existing) {
        let Some(analysis) = self.complete_results() else { return };
        let path = self.at_home(path);
        let outputs = OutputSet::new(existing, self.inputs());
        let source = ExportSource { name: self.state.study_name.clone(), sha256: self.loaded.sha256.clone() };
        match write_export(&analysis, &source, &ExportRequest::new(format), &path, outputs) {
            Ok(remarks) => {
                self.state.forms.shown = None;
                let remark = match remarks.as_slice() {
                    [] => String::new(),
                    [remark] => format!(" ({remark})"),
                    several => format!(" ({} remarks, in the file)", several.len()),
                };
                self.done(format!("exported {}{remark}", sanitized_path(&path)));
            }
            Err(FileError::Exists { paths }) => {
                self.ask_to_overwrite(&paths, FormKind::ExportAs, Command::ExportAs(format, path));
            }
            Err(error) => self.notify_error(error.to_string()),
        }
    }

    /// The analysis of what is shown, proven; where it is not there yet, that is said.
    fn complete_results(&mut self) -> Option<Arc<Analysis>> {
        let analysis = self.analysis_to_write("export").map_err(|why| self.notify_error(why)).ok()?;
        // With how sure its figures are, as far as that is computed.
        let of_this = |bars: &Analysis| bars.study == analysis.study;
        Some(self.state.analysis_with_bars().filter(of_this).map_or(analysis.clone(), Arc::new))
    }
}
