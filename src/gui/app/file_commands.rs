//! Carries out commands about files (studies and datasets, requirement tables, recovery files), and
//! quits.

use std::path::PathBuf;

use egui::ViewportCommand;

use gdcm_io::Existing;

use super::GdcmApp;
use super::file_dialogs::DialogPurpose;
use super::postponed_actions::PendingAction;
use crate::gui::commands::file::FileCommand;

impl GdcmApp {
    /// Carries out a file command.
    ///
    /// Closing and quitting ask here before unsaved decisions are lost. Opening asks by itself,
    /// once the file is read; reloading keeps the decisions that still apply.
    pub(super) fn carry_out_file(&mut self, command: FileCommand) {
        match command {
            FileCommand::ReadRequirementTable(table, path) => {
                self.read_requirement_table(table, path)
            }
            FileCommand::AskRequirementTable(table) => {
                self.ask_path(DialogPurpose::RequirementTable(table), String::new());
            }
            FileCommand::AskWriteTolerances => self.ask_write_tolerances(),
            FileCommand::WriteTolerances(path) => self.write_tolerances(path),
            FileCommand::AskOpen => self.ask_path(DialogPurpose::Open, String::new()),
            FileCommand::AskSaveStudy => {
                self.ask_path(DialogPurpose::SaveStudy, self.files.proposed_name())
            }
            FileCommand::Open(path) => self.open(path, None),
            FileCommand::OpenStudyOf(study, dataset) => self.open(study, Some(dataset)),
            FileCommand::OpenExample(example) => self.open_example(example),
            FileCommand::CloseStudy if self.state.unsaved => self.ask_to_lose(PendingAction::Close),
            FileCommand::CloseStudy => self.close_study(),
            FileCommand::RestoreRecovery(offer) => self.restore(offer),
            FileCommand::DiscardRecovery(offer) => self.discard(offer),
            FileCommand::Reload => self.reload(),
            FileCommand::KeepOpen => self.withdraw_reload_offer(),
            FileCommand::LookForRecent => self.refresh_recent_files(None),
            FileCommand::Quit if self.state.unsaved && !self.postponed.closing => {
                self.ask_to_lose(PendingAction::Quit)
            }
            FileCommand::Quit => self.quit(),
            FileCommand::SaveStudy => self.save(),
            FileCommand::SaveStudyAs(path) => {
                // `Replace` only if the engineer has confirmed that the file may be overwritten.
                self.save_as(path, self.postponed.existing)
            }
        }
    }

    /// Saves the study to a file, as the Save form does after a path was typed.
    pub fn save_study_as(&mut self, path: PathBuf) {
        self.save_as(path, Existing::Keep);
    }

    /// Closes the window and deletes the recovery file.
    pub(super) fn quit(&mut self) {
        self.postponed.closing = true;
        // The decisions are saved, or the engineer has agreed to lose them.
        self.recovery.autosave.clear();
        self.ctx.send_viewport_cmd(ViewportCommand::Close);
    }
}
