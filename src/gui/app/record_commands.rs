//! Commands of the Records view. Edits are in `record_edits.rs` and `record_layout_edits.rs`.

use gdcm_model::dataset::ConditionId;
use gdcm_study::Edit;

use super::GdcmApp;
use super::file_dialogs::DialogPurpose;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::records_page::RecordsPage;

impl GdcmApp {
    /// Carries out a command about flight records.
    pub(super) fn carry_out_records(&mut self, command: RecordsCommand) {
        let condition = self.state.condition().id();
        let records = &mut self.state.records;
        match command {
            RecordsCommand::Add(paths) => self.add_records(paths),
            RecordsCommand::AskDataset => self.ask_record_dataset(),
            RecordsCommand::MakeDataset => self.make_record_dataset(),
            RecordsCommand::AskFiles => self.ask_path(DialogPurpose::RecordFolder, String::new()),
            RecordsCommand::Show(page) => records.page = page,
            RecordsCommand::ShowSpectrogram(input) => records.spectrogram = input,
            RecordsCommand::ShowTimeRole(role, true) => {
                records.hidden_roles.remove(&role);
            }
            RecordsCommand::ShowTimeRole(role, false) => {
                records.hidden_roles.insert(role);
            }
            RecordsCommand::ShowOutputs(outputs) => records.more_outputs = Some(outputs),
            RecordsCommand::Identify => self.identify_conditions(&[condition]),
            RecordsCommand::IdentifyAll => {
                let conditions = records.conditions_in_use();
                self.identify_conditions(&conditions);
            }
            RecordsCommand::Stop => self.stop_identifying(),
            RecordsCommand::Take(offered) => self.take_identified(&[condition], offered),
            RecordsCommand::TakeAll(offered) => {
                let conditions: Vec<ConditionId> = records.conditions.keys().copied().collect();
                self.take_identified(&conditions, offered);
            }
            RecordsCommand::Return => self.decide(&Edit::ReturnModels { condition }),
            RecordsCommand::ShowAdvanced(field) => records.advanced_field = Some(field),
            RecordsCommand::Choose(index) => {
                if let Some(records) = records.conditions.get_mut(&condition) {
                    records.choose(index);
                    records.is_chosen = true;
                }
            }
            RecordsCommand::SetLayout(index, layout) => self.set_layout(condition, index, layout),
            RecordsCommand::TakeDatasetUnits => self.take_dataset_units(),
            RecordsCommand::ShowUnclear => self.show_unclear(),
            // Every other command changes the records of the displayed condition; see `apply_edit`.
            edit => self.edit_records(condition, edit),
        }
    }

    /// Shows the first record with missing units, on the Columns page.
    fn show_unclear(&mut self) {
        let Some(id) = self.state.records.open_units().and_then(|open| open.first) else {
            return;
        };
        if let Some(records) = self.state.records.conditions.get_mut(&id) {
            let unclear = records.rows.iter().position(|row| !row.problems.is_empty());
            records.choose(unclear.unwrap_or(records.chosen));
        }
        self.state.records.page = RecordsPage::Columns;
        self.dispatch(SelectionCommand::SelectCondition(id));
    }
}
