//! Layout of views, panels and sheets.

use super::opens_with::OpensWith;
use super::sheet::Sheet;
use super::view_arrangement::Arrangement;

/// Visible views, panels and sheets.
#[derive(Debug, Default)]
pub struct Layout {
    pub arrangement: Arrangement,
    /// Whether the window is wide enough for full names and texts.
    pub is_wide: bool,
    /// Content shown at the next start.
    pub opens_with: OpensWith,
    /// Whether the left panel is shown in full; `None` follows the window width.
    pub left_open: Option<bool>,
    /// Open sheet, which covers part of the views; `None` if it is closed.
    pub sheet: Option<Sheet>,
    /// Whether the settings are open; they then replace the models.
    pub settings_open: bool,
    /// Whether the rarely changed settings are unfolded.
    pub advanced_open: bool,
    pub identified_open: bool,
}
