//! The tables that requirements are asked with, read from files of their own and written to them.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_core::message_text::sanitized_path;
use gdcm_core::study::{Edit, RequirementSettings};
use gdcm_files::{FileError, add_tolerances, load_tolerances, read_levels};

use super::GdcmApp;
use crate::view::{Command, FormKind, RequirementTable};

impl GdcmApp {
    /// Takes a table into the study.
    pub(super) fn read_requirement_table(&mut self, table: RequirementTable, path: PathBuf) {
        let path = self.at_home(path);
        let mut settings = RequirementSettings::clone(&self.state.study.requirements);
        let (what, read) = match table {
            RequirementTable::Levels => {
                ("levels", read_levels(&path).map(|levels| (settings.levels = levels, Vec::new()).1))
            }
            RequirementTable::Tolerances => {
                let read = load_tolerances(&path);
                ("tolerances", read.map(|(tolerances, cautions)| (settings.tolerances = tolerances, cautions).1))
            }
        };
        match read {
            Err(error) => self.notify_error(error.to_string()),
            Ok(cautions) => {
                self.state.forms.shown = None;
                self.decide(&Edit::SetRequirements(what, Arc::new(settings)));
                if !cautions.is_empty() {
                    self.notify_error(format!("taken, but {}: {}", sanitized_path(&path), cautions.join("; ")));
                }
            }
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
        let mut outputs = self.outputs();
        let mut write = || -> Result<(), FileError> {
            add_tolerances(&self.state.study.requirements.tolerances, &path, &mut outputs)
        };
        let written = write().and_then(|()| outputs.persist());
        self.saved_to(written, &path, FormKind::WriteTolerances, Command::WriteTolerances(path.clone()));
    }
}
