//! Clickable list rows: size, background, accessible name.

use egui::{Color32, Rect, Response, Role, Sense, Ui, WidgetInfo, vec2};

use super::palette::Palette;
use super::window_regions::mark_selected_row;

/// Usual list row height \[pt\].
pub const ROW_HEIGHT: f32 = 20.0;

/// State and height of a clickable list row.
pub struct RowLook {
    pub is_selected: bool,
    /// Whether the pointer is over the same item elsewhere in the window.
    pub is_pointed: bool,
    /// Height \[pt\].
    pub height: f32,
}

impl RowLook {
    /// Allocates the row, paints its background, and names it for screen readers and tests; a
    /// selected row becomes the one at which F6 enters its region.
    pub fn row_ui(&self, ui: &mut Ui, palette: &Palette, name: &str) -> (Rect, Response) {
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), self.height), Sense::click());
        response.widget_info(|| {
            WidgetInfo::selected(Role::Button, ui.is_enabled(), self.is_selected, name)
        });
        if self.is_selected {
            mark_selected_row(ui.ctx(), response.id);
        }
        let fill = if self.is_selected {
            palette.selected
        } else if response.hovered() || self.is_pointed || response.has_focus() {
            palette.raised
        } else {
            Color32::TRANSPARENT
        };
        ui.painter().rect_filled(rect, 4.0, fill);
        (rect, response)
    }
}

/// Draws a row with the usual height.
pub fn row_ui(
    ui: &mut Ui,
    palette: &Palette,
    selected: bool,
    pointed: bool,
    name: &str,
) -> (Rect, Response) {
    let look = RowLook {
        is_selected: selected,
        is_pointed: pointed,
        height: ROW_HEIGHT,
    };
    look.row_ui(ui, palette, name)
}
