//! Commands that arrange views, panels and sheets.

use egui::ThemePreference;

use crate::gui::state::opens_with::OpensWith;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::view::{View, ViewGroup};

/// Shows, hides or moves a part of the window, or moves the focus.
#[derive(Clone, Debug, PartialEq)]
pub enum LayoutCommand {
    /// Brings a view to the front.
    ShowView(View),
    /// Shows the next or the previous page in the view in front.
    TurnPage { forward: bool },
    /// Brings a view group to the front and shows the view that was last open in it.
    ShowGroup(ViewGroup),
    /// Shows a second view beside the view in front; `None` shows the view in front alone.
    ShowBeside(Option<View>),
    /// Shows a page in the dock, and unfolds the dock.
    ShowInDock(View),
    /// Unfolds (`true`) or folds the dock.
    OpenDock(bool),
    /// Doubles the dock's height (`true`), or restores its usual height.
    EnlargeDock(bool),
    /// Restores the default layout for panels and views.
    ResetLayout,
    /// Shows the left panel in full (`true`) or as a narrow rail.
    ShowLeft(bool),
    /// Shows a sheet; `None` closes the open one.
    ShowSheet(Option<Sheet>),
    /// Opens (`true`) or closes the settings.
    ShowSettings(bool),
    /// Unfolds (`true`) or folds the rarely changed settings.
    ShowAdvanced(bool),
    /// Unfolds (`true`) or folds the identified models.
    ShowIdentified(bool),
    /// Selects a theme, or follows the desktop's.
    SetTheme(ThemePreference),
    /// Shows the start page (`true`), or the study behind it.
    ShowStart(bool),
    /// Sets what the program opens at the next start.
    BeginWith(OpensWith),
    /// Opens the settings with the advanced ones, and focuses the field with this accessible name.
    FocusField(&'static str),
    /// Shows the variants, with the focus in the field for the name of a new one.
    NameVariant,
    /// Moves the focus to the next or to the previous window region.
    LeaveRegion { forward: bool },
    /// Shows the first step in the guided tour.
    StartTour,
    /// Shows a step in the guided tour, counted from 0; `None` ends the tour.
    ShowTourStep(Option<usize>),
}
