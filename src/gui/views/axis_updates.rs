//! Decides when plot axes may follow the data.

use egui::Ui;

use crate::gui::plot::steady_range::AxisUpdate;
use crate::gui::state::window_state::State;

/// Returns how axes follow the displayed results: not while newer results are awaited, only to
/// larger ranges while a pointer button is down, else completely.
pub(super) fn axis_update(ui: &Ui, state: &State) -> AxisUpdate {
    if state.results.is_waiting() {
        AxisUpdate::Pending
    } else if ui.input(|input| input.pointer.any_down()) {
        AxisUpdate::Dragging
    } else {
        AxisUpdate::Complete
    }
}
