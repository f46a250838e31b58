//! The desktop's file dialogs, each in a thread, and what follows the engineer's choice.

use std::path::{Path, PathBuf};

use gdcm_io::Existing;

use super::GdcmApp;
use super::document_files::with_study_extension;
use super::faults::caught;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::forms::{FormKind, RequirementTable};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DialogPurpose {
    Open,
    SaveStudy,
    ExportFolder,
    ModelFolder,
    RecordFiles,
    RecordFolder,
    RequirementTable(RequirementTable),
}

impl GdcmApp {
    /// Opens a desktop file dialog unless a dialog is open; a save dialog proposes `file_name`.
    pub(super) fn ask_path(&mut self, purpose: DialogPurpose, file_name: String) {
        if self.is_dialog_open {
            return;
        }
        self.is_dialog_open = true;
        let folder = match purpose {
            DialogPurpose::ExportFolder => Some(self.state.forms.export.folder_path()),
            _ => self.files.proposed_folder(),
        };
        // Without desktop dialogs, the call fails or panics; this counts as a dialog closed without
        // a choice.
        let ask = move || {
            caught(|| show_dialog(purpose, &file_name, folder.as_deref())).unwrap_or_default()
        };
        self.in_thread("the dialog", ask, move |app, chosen| {
            app.is_dialog_open = false;
            let mut chosen = chosen.unwrap_or_default();
            if purpose == DialogPurpose::RecordFiles && !chosen.is_empty() {
                app.carry_out_records(RecordsCommand::Add(chosen));
                return;
            }
            match chosen.pop() {
                Some(path) => app.path_chosen(purpose, path),
                None => app.nothing_chosen(purpose),
            }
        });
    }

    fn path_chosen(&mut self, purpose: DialogPurpose, path: PathBuf) {
        match purpose {
            DialogPurpose::Open => self.open(path, None),
            DialogPurpose::SaveStudy => {
                // The dialog has asked only about the chosen name, not about the name with the
                // extension that `save_as` adds.
                let existing = if with_study_extension(path.clone()) == path {
                    Existing::Replace
                } else {
                    Existing::Keep
                };
                self.save_as(path, existing);
            }
            DialogPurpose::ExportFolder => {
                self.state.forms.export.folder = path.display().to_string()
            }
            DialogPurpose::ModelFolder => {
                self.carry_out_assembling(AssemblingCommand::Add(vec![path]))
            }
            DialogPurpose::RecordFiles | DialogPurpose::RecordFolder => {
                self.carry_out_records(RecordsCommand::Add(vec![path]))
            }
            DialogPurpose::RequirementTable(table) => self.read_requirement_table(table, path),
        }
    }

    /// Handles a dialog without a choice. A cancelled dialog and a desktop without dialogs look
    /// alike, so a form opens in which the path can be typed, unless the dialog was opened beside
    /// such a field.
    fn nothing_chosen(&mut self, purpose: DialogPurpose) {
        match purpose {
            DialogPurpose::Open => self.state.forms.shown = Some(FormKind::Open),
            DialogPurpose::SaveStudy => {
                *self.state.forms.typed_in(FormKind::Save) = self.files.proposed_name();
                self.state.forms.shown = Some(FormKind::Save);
            }
            DialogPurpose::RequirementTable(table) => {
                self.state.forms.shown = Some(FormKind::ReadRequirementTable(table));
            }
            DialogPurpose::RecordFiles | DialogPurpose::RecordFolder => {
                self.state.forms.shown = Some(FormKind::AddRecords);
            }
            DialogPurpose::ExportFolder | DialogPurpose::ModelFolder => {}
        }
    }
}

/// Shows a desktop file dialog, which begins in `folder` if that exists; returns the chosen paths,
/// at most one except for record files.
fn show_dialog(purpose: DialogPurpose, file_name: &str, folder: Option<&Path>) -> Vec<PathBuf> {
    let mut dialog = rfd::FileDialog::new();
    if let Some(folder) = folder
        && folder.is_dir()
    {
        dialog = dialog.set_directory(folder);
    }
    // A save dialog takes the name alone; the folder is set above.
    let file_name = match Path::new(file_name).file_name() {
        Some(name) => name.to_string_lossy().into_owned(),
        None => file_name.to_owned(),
    };
    let chosen = match purpose {
        DialogPurpose::Open => dialog
            .set_title("Open a dataset or a study")
            .add_filter("datasets and studies", &["json", "gz"])
            .add_filter("all files", &["*"])
            .pick_file(),
        DialogPurpose::SaveStudy => dialog
            .set_title("Save the study")
            .add_filter("studies", &["json"])
            .set_file_name(file_name)
            .save_file(),
        DialogPurpose::ModelFolder => dialog
            .set_title("Choose a folder with model files")
            .pick_folder(),
        DialogPurpose::RecordFiles => {
            let files = dialog
                .set_title("Choose flight records: files and archives")
                .pick_files();
            return files.unwrap_or_default();
        }
        DialogPurpose::RecordFolder => dialog
            .set_title("Choose a folder with flight records")
            .pick_folder(),
        DialogPurpose::RequirementTable(table) => {
            let title = match table {
                RequirementTable::Levels => "Open levels of bandwidth and phase delay",
                RequirementTable::Tolerances => "Open tolerances of time histories",
            };
            dialog
                .set_title(title)
                .add_filter("tables", &["json"])
                .pick_file()
        }
        DialogPurpose::ExportFolder => dialog
            .set_title("Export corrections to a folder")
            .pick_folder(),
    };
    chosen.into_iter().collect()
}
