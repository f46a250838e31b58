//! Commands from the Records view. Edits are in `record_edits.rs` and `record_layout_edits.rs`.
//!
//! A *row* is a record as it was read, with its layout: the columns assigned to the channels.

use gdcm_study::Edit;

use super::GdcmApp;
use super::file_dialogs::DialogPurpose;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::column_groups::RecordPlace;
use crate::gui::state::forms::FormKind;
use crate::gui::state::records::RecordsFold;
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
            RecordsCommand::AskFiles => self.ask_path(DialogPurpose::RecordFiles, String::new()),
            RecordsCommand::AskFolder => self.ask_path(DialogPurpose::RecordFolder, String::new()),
            RecordsCommand::AskPath => self.state.forms.shown = Some(FormKind::AddRecords),
            RecordsCommand::Assign(indices, id) => self.assign_records(&indices, id),
            RecordsCommand::Discard(index) => self.discard_record(index),
            RecordsCommand::ShowFold(fold) => records.open_fold = fold,
            RecordsCommand::ShowPage(page) => records.page = page,
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
                let conditions = self.state.conditions_to_identify();
                self.identify_conditions(&conditions);
            }
            RecordsCommand::StopIdentifying => self.stop_identifying(),
            RecordsCommand::Adopt(choice) => self.adopt_identified(&[condition], choice),
            RecordsCommand::AdoptAll(choice) => {
                let conditions = self.state.unused_fits();
                self.adopt_identified(&conditions, choice);
            }
            RecordsCommand::RestoreFileModels => {
                self.decide(&Edit::RestoreFileModels { condition })
            }
            RecordsCommand::ShowAdvanced(field) => {
                records.open_fold = Some(RecordsFold::Settings);
                records.advanced_field = Some(field);
            }
            RecordsCommand::AdvancedFocused => records.advanced_field = None,
            RecordsCommand::ChooseRecord(index) => {
                if let Some(records) = records.conditions.get_mut(&condition) {
                    records.choose(index);
                    // The input in focus no longer decides which record is displayed.
                    records.is_chosen = true;
                }
            }
            RecordsCommand::SetLayout(index, layout) => self.set_layout(condition, index, layout),
            RecordsCommand::ConfirmUnits => self.confirm_units(),
            RecordsCommand::CheckUnits => {
                if let Some(place) = records.assumed_units().and_then(|units| units.first) {
                    self.show_columns(place);
                }
            }
            RecordsCommand::ShowColumns(place) => self.show_columns(place),
            // Every other command changes the displayed condition's records; see `apply_edit`.
            edit => self.edit_records(condition, edit),
        }
    }

    /// Displays a record on the page with its column assignment.
    fn show_columns(&mut self, place: RecordPlace) {
        if let Some(records) = self.state.records.conditions.get_mut(&place.condition) {
            records.choose(place.row);
            records.is_chosen = true;
        }
        self.state.records.page = RecordsPage::Columns;
        self.dispatch(SelectionCommand::SelectCondition(place.condition));
    }
}
