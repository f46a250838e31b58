//! A sheet over the middle of the window, at one of its sides: closed by Escape, by its cross, or by a click beside it.

use egui::{Align, Area, Frame, Id, Layout, Margin, Order, Rect, RichText, Role, ScrollArea, Stroke, Ui, vec2};

use super::explanation::QUESTION;
use super::palette::medium;
use super::{BODY_SIZE, Palette, named, take_escape};

/// What a sheet may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sheet {
    /// Why the result is as it is.
    Reasons,
    /// The physics models, beside the rail.
    Models,
    /// The identified models, beside the rail.
    Identified,
    /// How a value was computed.
    Derivation,
}

impl Sheet {
    /// Its heading, which is also its accessible name.
    pub fn title(self) -> &'static str {
        match self {
            Self::Reasons => "Why the result is so",
            Self::Models => "Physics models",
            Self::Identified => "Identified models",
            Self::Derivation => QUESTION,
        }
    }

    /// Whether it stands at the right side, and how wide it is \[pt\].
    fn place(self) -> (bool, f32) {
        match self {
            Self::Reasons => (true, 380.0),
            Self::Derivation => (true, 440.0),
            Self::Models | Self::Identified => (false, 272.0),
        }
    }
}

/// Draws a sheet over `centre`; gives whether it is to be closed.
pub fn sheet_ui(ui: &Ui, centre: Rect, sheet: Sheet, palette: &Palette, add: impl FnOnce(&mut Ui)) -> bool {
    let (is_right, width) = sheet.place();
    let width = width.min(centre.width());
    let place =
        if is_right { centre.with_min_x(centre.right() - width) } else { centre.with_max_x(centre.left() + width) };
    let id = Id::unique(("sheet", sheet.title()));
    let mut is_closed = false;
    let shown = Area::new(id).order(Order::Middle).fixed_pos(place.min).show(ui.ctx(), |ui| {
        let stroke = Stroke::new(1.0, palette.line);
        Frame::new().fill(palette.panel).stroke(stroke).inner_margin(Margin::same(12)).show(ui, |ui| {
            ui.set_min_size(place.size() - vec2(26.0, 26.0));
            ui.set_max_size(place.size() - vec2(26.0, 26.0));
            ui.horizontal(|ui| {
                ui.label(RichText::new(sheet.title()).font(medium(BODY_SIZE)));
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    is_closed = named(ui.small_button("×"), Role::Button, "Close the sheet").clicked();
                });
            });
            ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| add(ui));
        });
    });
    // A first frame that draws it is that of the click which asked for it.
    let is_new = ui.ctx().data_mut(|data| !std::mem::replace(data.get_temp_mut_or_default::<bool>(id), true));
    let beside = ui.input(|input| {
        let at = input.pointer.interact_pos().filter(|_| input.pointer.any_pressed());
        at.is_some_and(|at| !shown.response.rect.contains(at))
    });
    let is_over = egui::Popup::is_any_open(ui.ctx());
    is_closed |= take_escape(ui.ctx()) || (beside && !is_new && !is_over);
    if is_closed {
        ui.ctx().data_mut(|data| data.remove::<bool>(id));
    }
    is_closed
}
