//! Commands that copy and write results; the methods are in `exports.rs`, `figure_saving.rs` and
//! `report_job.rs`.

use super::GdcmApp;
use super::file_dialogs::DialogPurpose;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::panel_tables::table_of;
use crate::message::Message;

impl GdcmApp {
    pub(super) fn carry_out_output(&mut self, command: OutputCommand) {
        match command {
            OutputCommand::CopyTable(kind) => {
                self.ctx.copy_text(table_of(&self.state, kind).text());
                let text = format!("copied the table of {}", kind.name());
                self.notify_done(Message::new("table-copied", text));
            }
            OutputCommand::AskSaveTable(kind) => {
                self.ask_save_table(kind.name(), table_of(&self.state, kind).into())
            }
            OutputCommand::AskSaveShownTable(table) => {
                self.ask_save_table(&table.title, table.clone())
            }
            OutputCommand::SaveTable(table, path) => self.save_table(table, path),
            OutputCommand::CopyFigure(view) => self.copy_figure(view),
            OutputCommand::AskSaveFigure(view, format) => self.ask_save_figure(view, format),
            OutputCommand::SaveFigure(view, width, path) => self.save_figure(view, width, path),
            OutputCommand::AskReport => self.ask_report(),
            OutputCommand::WriteReport(path) => self.write_report(path),
            OutputCommand::AskExportFolder => {
                self.ask_path(DialogPurpose::ExportFolder, String::new())
            }
            OutputCommand::ShowFolder(folder) => self.show_folder(folder),
            OutputCommand::ApplyExportRemedy(remedy) => self.apply_export_remedy(remedy),
            OutputCommand::CopyExportCommand => self.copy_export_command(),
            OutputCommand::CopyText(text) => self.ctx.copy_text(text),
            OutputCommand::Export => self.export(),
        }
    }
}
