//! Frame for a sheet over the middle of the window: position, heading, and closing.

use egui::{
    Align, Area, Frame, Id, Layout, Margin, Order, Rect, RichText, Role, ScrollArea, Stroke, Ui,
    vec2,
};

use crate::gui::state::sheet::Sheet;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::escape_key::take_escape;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};

/// Draws a sheet over `centre`; returns whether the engineer has closed it: with its button, with
/// Escape, or, unless a popup is open, by a press outside.
pub fn sheet_ui(
    ui: &Ui,
    centre: Rect,
    sheet: Sheet,
    palette: &Palette,
    add: impl FnOnce(&mut Ui),
) -> bool {
    let width = sheet.width().min(centre.width());
    let place = if sheet.is_on_right() {
        centre.with_min_x(centre.right() - width)
    } else {
        centre.with_max_x(centre.left() + width)
    };
    let id = Id::unique(("sheet", sheet.title()));
    let mut is_closed = false;
    let shown = Area::new(id)
        .order(Order::Middle)
        .fixed_pos(place.min)
        .show(ui.ctx(), |ui| {
            let stroke = Stroke::new(1.0, palette.line);
            Frame::new()
                .fill(palette.panel)
                .stroke(stroke)
                .inner_margin(Margin::same(12))
                .show(ui, |ui| {
                    ui.set_min_size(place.size() - vec2(26.0, 26.0));
                    ui.set_max_size(place.size() - vec2(26.0, 26.0));
                    ui.horizontal(|ui| {
                        ui.label(RichText::new(sheet.title()).font(medium(BODY_SIZE)));
                        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                            is_closed =
                                named(ui.small_button("×"), Role::Button, "Close the sheet")
                                    .clicked();
                        });
                    });
                    ScrollArea::vertical()
                        .auto_shrink([false, false])
                        .show(ui, |ui| add(ui));
                });
        });
    // `is_new`: in its first frame the sheet still receives the click that opened it, which must
    // not close it.
    let is_new = ui
        .ctx()
        .data_mut(|data| !std::mem::replace(data.get_temp_mut_or_default::<bool>(id), true));
    let is_pressed_beside = ui.input(|input| {
        let place = input.pointer.interact_pos();
        input.pointer.any_pressed()
            && place.is_some_and(|place| !shown.response.rect.contains(place))
    });
    let is_under_popup = egui::Popup::is_any_open(ui.ctx());
    is_closed |= take_escape(ui.ctx()) || (is_pressed_beside && !is_new && !is_under_popup);
    if is_closed {
        ui.ctx().data_mut(|data| data.remove::<bool>(id));
    }
    is_closed
}
