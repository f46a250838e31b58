//! Drawer at the bottom of a view: shows details about a selected item without covering the view.

use egui::{Button, Frame, Margin, Panel, Rect, Response, RichText, Role, Sense, Stroke, Ui, vec2};

use super::controls::named;
use super::escape_key::take_escape;
use super::palette::{BODY_SIZE, Palette, medium};
use super::panel_layout::{in_line_ui, restore_panel_size};

/// Name, title, verdict and height of a drawer.
#[derive(Clone, Copy, Debug)]
pub struct Drawer<'a> {
    /// Name under which the height is stored, such as "requirement details".
    pub name: &'static str,
    /// Item whose details are shown.
    pub title: &'a str,
    /// Result about the item in a few words; empty for none.
    pub verdict: &'a str,
    /// Whether the verdict is drawn in the warning colour; otherwise dim.
    pub is_warning: bool,
    /// Height when the drawer is opened for the first time \[pt\].
    pub default_height: f32,
    /// Minimum height \[pt\].
    pub min_height: f32,
}

/// Drawer bar height \[pt\].
pub const DRAWER_BAR_HEIGHT: f32 = 36.0;

/// Draws a drawer at the bottom of the remaining space; returns whether it was closed by its button
/// or by Escape. `tools` draws controls at the right of the bar, from right to left; `content`
/// draws below the bar.
///
/// Call it before the content above the drawer is drawn. The height is remembered; a double click
/// on the upper edge restores the default.
pub fn drawer_ui(
    ui: &mut Ui,
    drawer: Drawer<'_>,
    palette: &Palette,
    tools: impl FnOnce(&mut Ui),
    content: impl FnOnce(&mut Ui),
) -> bool {
    let available = ui.available_height();
    // The view above keeps the drawer's minimum height, but not more than 40 % of the space.
    let max_height = (available - drawer.min_height).max(0.6 * available);
    restore_panel_size(ui, drawer.name);
    let frame = Frame::new().fill(palette.panel);
    let panel = Panel::bottom(drawer.name)
        .frame(frame)
        .resizable(true)
        .default_size(drawer.default_height)
        .size_range(drawer.min_height.min(max_height)..=max_height);
    let mut is_closed = false;
    panel.show(ui, |ui| {
        let room = ui.available_rect_before_wrap();
        let bar = Rect::from_min_size(room.min, vec2(room.width(), DRAWER_BAR_HEIGHT));
        is_closed = bar_ui(ui, bar, drawer, palette, tools).clicked();
        ui.advance_cursor_after_rect(bar);
        Frame::new()
            .inner_margin(Margin::symmetric(12, 4))
            .show(ui, content);
        ui.advance_cursor_after_rect(room);
    });
    is_closed || take_escape(ui.ctx())
}

/// Draws the bar with title, verdict, tools and close button; returns the close button.
fn bar_ui(
    ui: &mut Ui,
    bar: Rect,
    drawer: Drawer<'_>,
    palette: &Palette,
    tools: impl FnOnce(&mut Ui),
) -> Response {
    ui.allocate_rect(bar, Sense::hover());
    let line = Stroke::new(1.0, palette.line);
    ui.painter().hline(bar.x_range(), bar.top(), line);
    ui.painter().hline(bar.x_range(), bar.bottom(), line);
    let inner = bar.shrink2(vec2(12.0, 0.0));
    let from_right = true;
    let right = in_line_ui(ui, inner, from_right, |ui| {
        let close = named(
            ui.add(Button::new("×").frame(false)),
            Role::Button,
            "Close the details",
        )
        .on_hover_text("Escape closes the details too");
        tools(ui);
        close
    });
    let rest = inner.with_max_x(right.response.rect.left() - 8.0);
    in_line_ui(ui, rest, !from_right, |ui| {
        ui.label(RichText::new(drawer.title).font(medium(BODY_SIZE)));
        let color = if drawer.is_warning {
            palette.warning
        } else {
            palette.dim_text
        };
        let verdict = RichText::new(drawer.verdict).color(color);
        ui.add(egui::Label::new(verdict).truncate());
    });
    right.inner
}
