//! Building blocks of panels and forms: small texts, named controls, menu entries, list rows; also
//! re-exports the fields.

use egui::containers::panel::PanelState;
use egui::{
    Align, Align2, Button, Color32, FontId, InnerResponse, Layout, Pos2, Rect, Response, RichText,
    Role, Sense, Stroke, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

use super::elision::elided;
pub use super::fields::{
    Entered, NumberField, RefusedEntry, entry_ui, focus_field, is_entered, name_text_field,
    number_entry_ui, text_field_ui, typed_number,
};
use super::focus::begin_with;
use super::palette::{Palette, SMALL_SIZE};

impl Palette {
    /// Returns small dim text, for notes beside a value.
    pub fn small(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).size(SMALL_SIZE).color(self.dim_text)
    }

    /// Returns dim text in the usual size, for labels and explanations.
    pub fn dim(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).color(self.dim_text)
    }

    /// Returns small text in the warning colour.
    pub fn small_warning(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).size(SMALL_SIZE).color(self.warning)
    }
}

/// Names a control for screen readers and tests.
pub fn named(response: Response, role: Role, name: impl Into<String>) -> Response {
    let enabled = response.enabled();
    let name = name.into();
    response.widget_info(|| WidgetInfo::labeled(role, enabled, &name));
    response
}

/// Names an on/off control and reports its state for screen readers and tests.
pub fn named_switch(
    response: Response,
    role: Role,
    is_on: bool,
    name: impl Into<String>,
) -> Response {
    let enabled = response.enabled();
    let name = name.into();
    response.widget_info(|| WidgetInfo::selected(role, enabled, is_on, &name));
    response
}

/// Adds a tooltip unless `hint` is empty, because egui would draw an empty box.
pub fn hint_ui(response: Response, hint: impl Into<String>) -> Response {
    let hint = hint.into();
    if hint.is_empty() {
        response
    } else {
        response.on_hover_text(hint)
    }
}

/// Control that emits a command.
pub trait Asks {
    /// Emits the command on a click.
    fn asks<C>(&self, command: impl Into<C>, commands: &mut Vec<C>);
}

impl Asks for Response {
    fn asks<C>(&self, command: impl Into<C>, commands: &mut Vec<C>) {
        if self.clicked() {
            commands.push(command.into());
        }
    }
}

/// Draws a button that emits a command.
pub fn button_ui<C>(
    ui: &mut Ui,
    button: Button<'_>,
    hint: &str,
    command: impl Into<C>,
    commands: &mut Vec<C>,
) {
    hint_ui(ui.add(button), hint).asks(command, commands);
}

/// Draws menu entries, each with its command; a click closes the menu.
pub fn entries_ui<N: Into<String>, C>(
    ui: &mut Ui,
    entries: impl IntoIterator<Item = (N, C)>,
    commands: &mut Vec<C>,
) {
    for (text, command) in entries {
        if ui.button(text.into()).clicked() {
            commands.push(command);
            ui.close();
        }
    }
}

/// Usual height of a list row \[pt\].
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
    /// Allocates the row, paints its background, and names it for screen readers and tests.
    pub fn row_ui(&self, ui: &mut Ui, palette: &Palette, name: &str) -> (Rect, Response) {
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), self.height), Sense::click());
        response.widget_info(|| {
            WidgetInfo::selected(Role::Button, ui.is_enabled(), self.is_selected, name)
        });
        if self.is_selected {
            begin_with(ui.ctx(), response.id);
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

/// Restores the default size of a named panel after a double click on its edge; call it before the
/// panel is drawn.
pub fn restore_panel_size(ui: &Ui, name: &str) {
    let panel = ui.scope_id().with(name);
    if ui
        .read_response(panel.with("__resize"))
        .is_some_and(|edge| edge.double_clicked())
    {
        ui.ctx().data_mut(|data| data.remove::<PanelState>(panel));
    }
}

/// Horizontal room for text, measured from the left edge of the row \[pt\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    pub left: f32,
    pub right: f32,
}

/// Paints text into its room, with the middle elided if it is too long; paints nothing if not even
/// a letter fits.
pub fn row_text_within(ui: &Ui, row: Rect, room: Room, text: &str, size: f32, color: Color32) {
    let shown = elided(ui, text, room.right - room.left, size);
    if !shown.is_empty() {
        row_text(ui, row, room.left, &shown, size, color);
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

/// Position, for [`painted_text`], of text that ends at the right edge of its row: negative, so that
/// it counts from that edge, and too small to be seen.
pub const AT_RIGHT_END: f32 = -0.01;

/// Paints text at `x` points from the row's left edge (from its right edge if negative), vertically
/// centred; returns its rectangle.
pub fn painted_text(ui: &Ui, row: Rect, x: f32, text: &str, font: FontId, color: Color32) -> Rect {
    let (left, align) = if x < 0.0 {
        (row.right() + x, Align2::RIGHT_CENTER)
    } else {
        (row.left() + x, Align2::LEFT_CENTER)
    };
    ui.painter()
        .text(pos2(left, row.center().y), align, text, font, color)
}

/// Like [`painted_text`], in the proportional font.
pub fn row_text(ui: &Ui, row: Rect, x: f32, text: &str, size: f32, color: Color32) -> Rect {
    painted_text(ui, row, x, text, FontId::proportional(size), color)
}

/// Paints a small arrow: to the right if its section is folded, down if it is open.
pub fn chevron(ui: &Ui, center: Pos2, is_open: bool, palette: &Palette) {
    let corners = if is_open {
        [vec2(4.0, -2.0), vec2(0.0, 2.0), vec2(-4.0, -2.0)]
    } else {
        [vec2(-2.0, -4.0), vec2(2.0, 0.0), vec2(-2.0, 4.0)]
    };
    let points = corners.map(|corner| center + corner).to_vec();
    ui.painter()
        .line(points, Stroke::new(1.3, palette.dim_text));
}

/// Text of the menu entry that opens a derivation.
pub const QUESTION: &str = "How was this computed?";
