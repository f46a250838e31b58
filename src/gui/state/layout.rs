//! Visible views, panels and sheets.

use super::opens_with::OpensWith;
use super::sheet::Sheet;
use super::view_arrangement::Arrangement;

#[derive(Debug, Default)]
pub struct Layout {
    pub arrangement: Arrangement,
    /// Whether the window is wide enough for full names and texts.
    pub is_wide: bool,
    /// Content shown at the next start.
    pub opens_with: OpensWith,
    /// Whether the left panel is shown in full; `None` follows the window width.
    pub left_open: Option<bool>,
    /// Open sheet; `None` if all are closed.
    pub sheet: Option<Sheet>,
    /// Whether the settings are open; they then replace the models.
    pub settings_open: bool,
    /// Whether the rarely changed settings are unfolded.
    pub advanced_open: bool,
    pub identified_open: bool,
}

impl Layout {
    /// Returns whether the left panel is shown in full, not as a rail.
    pub fn has_left_panel(&self) -> bool {
        self.left_open.unwrap_or(self.is_wide)
    }

    /// Opens a sheet, or closes the open one. A sheet on the left closes the settings: beside the
    /// rail, only one of them has room.
    pub fn show_sheet(&mut self, sheet: Option<Sheet>) {
        self.sheet = sheet;
        if let Some(sheet) = sheet
            && !sheet.is_on_right()
        {
            self.settings_open = false;
        }
    }

    /// Opens the settings and closes a sheet on the left, or closes the settings.
    pub fn show_settings(&mut self, is_open: bool) {
        self.settings_open = is_open;
        if let Some(sheet) = self.sheet
            && is_open
            && !sheet.is_on_right()
        {
            self.sheet = None;
        }
    }
}
