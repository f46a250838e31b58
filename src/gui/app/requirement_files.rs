//! Requirement tables: reads levels and tolerances into the study, and writes tolerances.
//!
//! *Levels* are boundaries over bandwidth and phase delay, as in ADS-33E-PRF; *tolerances* limit
//! the difference between simulated and flown time histories (M17: docs/requirements.md).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::FileError;
use gdcm_io::files::levels_and_tolerances::{add_tolerances, load_tolerances, read_levels};
use gdcm_model::message_text::sanitized_path;
use gdcm_study::Edit;
use gdcm_study::decisions::requirement_settings::{RequirementPart, RequirementSettings};

use super::GdcmApp;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::state::forms::{FormKind, RequirementTable};
use crate::message::Message;

impl GdcmApp {
    /// Reads a requirement table into the study.
    pub(super) fn read_requirement_table(&mut self, table: RequirementTable, path: PathBuf) {
        let path = self.files.at_home(path);
        let mut settings = RequirementSettings::clone(&self.state.study.requirements);
        let read = read_table_into(&mut settings, table, &path);
        let Some(cautions) = self.value_or_notify(read) else {
            return;
        };
        self.state.forms.shown = None;
        let part = match table {
            RequirementTable::Levels => RequirementPart::Levels,
            RequirementTable::Tolerances => RequirementPart::Tolerances,
        };
        self.decide(&Edit::SetRequirements(part, Arc::new(settings)));
        if !cautions.is_empty() {
            let text = format!(
                "tolerances read with cautions from {}: {}",
                sanitized_path(&path),
                cautions.join("; ")
            );
            self.notify_error(Message::new("tolerances-with-cautions", text));
        }
    }

    /// Asks where to write the tolerances.
    pub(super) fn ask_write_tolerances(&mut self) {
        let field = self.state.forms.typed_in(FormKind::WriteTolerances);
        if field.is_empty() {
            *field = self.files.proposed_path("", "tolerances.json");
        }
        self.state.forms.shown = Some(FormKind::WriteTolerances);
    }

    /// Writes the study's tolerances; asks before overwriting a file.
    pub(super) fn write_tolerances(&mut self, path: PathBuf) {
        let path = self.files.at_home(path);
        let tolerances = &self.state.study.requirements.tolerances;
        let written = self.write_all(&[], |outputs| add_tolerances(tolerances, &path, outputs));
        self.notify_saved(
            written,
            &path,
            FormKind::WriteTolerances,
            Command::File(FileCommand::WriteTolerances(path.clone())),
        );
    }
}

/// Reads levels or tolerances from a file into the settings; returns the cautions about the
/// tolerances.
fn read_table_into(
    settings: &mut RequirementSettings,
    table: RequirementTable,
    path: &Path,
) -> Result<Vec<String>, FileError> {
    match table {
        RequirementTable::Levels => {
            settings.levels = settings.levels.replaced_by(&read_levels(path)?);
            Ok(Vec::new())
        }
        RequirementTable::Tolerances => {
            let (tolerances, cautions) = load_tolerances(path)?;
            settings.tolerances = tolerances;
            Ok(cautions.iter().map(ToString::to_string).collect())
        }
    }
}
