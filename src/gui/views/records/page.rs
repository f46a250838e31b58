//! Context for drawing a page of the Records view.

use egui::Ui;

use gdcm_sysid::identification::Identification;

use crate::gui::state::records::ConditionRecords;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Context for drawing a page: the records of the displayed condition.
#[derive(Clone, Copy)]
pub struct Page<'a> {
    pub state: &'a State,
    /// Records of the displayed condition.
    pub records: &'a ConditionRecords,
    /// Colours of the theme.
    pub palette: &'a Palette,
}

impl Page<'_> {
    /// Returns the identification; shows a message if there is none.
    pub fn identification_ui(&self, ui: &mut Ui) -> Option<&Identification> {
        let found = self.records.identification();
        if found.is_none() {
            ui.label(
                self.palette
                    .dim("Nothing was identified yet: choose Identify above."),
            );
        }
        found.map(AsRef::as_ref)
    }
}
