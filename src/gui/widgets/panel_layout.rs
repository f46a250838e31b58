//! Layout within panels: content in a line, and restoring a panel's default size.

use egui::containers::panel::PanelState;
use egui::{Align, InnerResponse, Layout, Rect, Ui, UiBuilder};

/// Restores a named panel's default size after a double click on its edge; call it before the panel
/// is drawn.
pub fn restore_panel_size(ui: &Ui, name: &str) {
    let panel = ui.scope_id().with(name);
    if ui
        .read_response(panel.with("__resize"))
        .is_some_and(|edge| edge.double_clicked())
    {
        ui.ctx().data_mut(|data| data.remove::<PanelState>(panel));
    }
}

/// Lays out content within `place`, left to right or right to left, vertically centred.
pub fn in_line_ui<R>(
    ui: &mut Ui,
    place: Rect,
    from_right: bool,
    add: impl FnOnce(&mut Ui) -> R,
) -> InnerResponse<R> {
    let layout = if from_right {
        Layout::right_to_left(Align::Center)
    } else {
        Layout::left_to_right(Align::Center)
    };
    ui.scope_builder(UiBuilder::new().max_rect(place).layout(layout), add)
}
