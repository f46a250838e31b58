//! Context for drawing the record list and the pages: state, the displayed condition's records, and
//! palette.

use std::sync::Arc;

use egui::Ui;

use gdcm_sysid::identification::Identification;

use crate::gui::state::records::ConditionRecords;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

#[derive(Clone, Copy)]
pub struct Page<'a> {
    pub state: &'a State,
    pub records: &'a ConditionRecords,
    pub palette: &'a Palette,
}

impl<'a> Page<'a> {
    /// Returns the identification; shows a message if there is none.
    pub fn identification_ui(self, ui: &mut Ui) -> Option<&'a Identification> {
        let found = self.records.identification();
        if found.is_none() {
            ui.label(self.palette.dim("No identification yet: choose Identify"));
        }
        found.map(AsRef::as_ref)
    }

    /// Returns whether records or settings have changed since the identification.
    pub(super) fn is_outdated(self) -> bool {
        self.state.is_fit_outdated(self.state.condition().id())
    }

    /// Returns the identification; `None` if records or settings have changed since.
    pub(super) fn current_identification(self) -> Option<&'a Arc<Identification>> {
        if self.is_outdated() {
            return None;
        }
        self.records.identification()
    }
}
