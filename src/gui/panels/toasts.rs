//! Toasts: messages in the middle of the top bar, over the dataset name, so that they cover no
//! curve and move nothing. The newest is shown; the others are in a list below it.

use egui::{
    Area, Button, Frame, Id, Label, Margin, Order, Rect, RichText, Role, ScrollArea, Sense, Stroke,
    StrokeKind, Ui, UiBuilder, pos2, vec2,
};

use gdcm_model::number_format::counted;

use crate::gui::commands::command::Command;
use crate::gui::commands::computing::ComputingCommand;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::notices::{Notice, NoticeAction, NoticeKind, Notices};
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body};
use crate::gui::widgets::panel_layout::in_line_ui;

/// Toast width in a wide and in a narrow window \[pt\].
const WIDTHS: [f32; 2] = [560.0, 400.0];
/// Toast height \[pt\].
const HEIGHT: f32 = 28.0;
/// Width of the coloured edge \[pt\].
const EDGE: f32 = 3.0;
/// Maximum height of the toast list \[pt\].
const LIST_HEIGHT: f32 = 280.0;

/// The toasts' area in the top bar, and the notices that they show.
pub(super) struct ToastBar<'a> {
    /// The whole top bar.
    pub(super) bar: Rect,
    /// Area between the menus and the search field.
    pub(super) room: Rect,
    pub(super) is_wide: bool,
    pub(super) notices: &'a Notices,
    pub(super) palette: &'a Palette,
}

impl ToastBar<'_> {
    /// Returns whether a toast covers the dataset name.
    pub(super) fn is_shown(&self) -> bool {
        self.notices.toasts().next().is_some()
    }

    /// Draws the newest toast in the middle of the bar.
    pub(super) fn ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let Some(newest) = self.notices.toasts().next() else {
            return;
        };
        let more = self.notices.toasts().count() - 1;
        let place = self.place();
        self.newest_ui(ui, &newest.notice, more, commands);
        let mut is_held = ui.rect_contains_pointer(place);
        if self.notices.is_list_open && more > 0 {
            is_held |= self.list_ui(ui, commands);
        }
        if is_held {
            commands.push(FormCommand::HoldToasts.into());
        }
    }

    fn place(&self) -> Rect {
        let width = if self.is_wide { WIDTHS[0] } else { WIDTHS[1] };
        let width = width.min(self.room.width());
        let left = (self.bar.center().x - 0.5 * width)
            .min(self.room.right() - width)
            .max(self.room.left());
        let top = self.bar.center().y - 0.5 * HEIGHT;
        Rect::from_min_size(pos2(left, top), vec2(width, HEIGHT))
    }

    /// Draws the newest toast: the coloured edge, the sentence, the action, the count of other
    /// toasts, and the button that closes it.
    fn newest_ui(&self, ui: &mut Ui, notice: &Notice, more: usize, commands: &mut Vec<Command>) {
        let palette = self.palette;
        let place = self.place();
        frame_ui(ui, place, notice, palette);
        let inner = place
            .shrink2(vec2(8.0, 2.0))
            .with_min_x(place.left() + 12.0);
        let buttons = in_line_ui(ui, inner, true, |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let close = ui.add(Button::new("×").frame(false));
            let close = named(close, Role::Button, "Dismiss");
            close.asks(FormCommand::DismissToast(notice.number), commands);
            let mut left = close.rect.left();
            if more > 0 {
                left = self.more_ui(ui, more, commands);
            }
            match &notice.action {
                Some(action) => action_ui(ui, action, palette, commands),
                None => left,
            }
        });
        let text_place = inner.with_max_x(buttons.inner - 8.0);
        let shown = elided(ui, &notice.text, text_place.width(), BODY_SIZE);
        painted_text(ui, text_place, 0.0, &shown, body(), palette.text);
        let id = ui.scope_id().with(("toast", notice.number));
        let label = ui.interact(text_place, id, Sense::hover());
        let label = named(label, Role::Label, &notice.text);
        if shown != notice.text {
            label.on_hover_text(&notice.text);
        }
    }

    /// Draws the button that opens the list of other toasts; returns its left edge.
    fn more_ui(&self, ui: &mut Ui, more: usize, commands: &mut Vec<Command>) -> f32 {
        let text = RichText::new(format!("{more} more"))
            .size(SMALL_SIZE)
            .color(self.palette.accent);
        let list = ui.add(Button::new(text).frame(false));
        let name = format!("{} more", counted(more, "message"));
        let is_opened = !self.notices.is_list_open;
        let list = named(list, Role::Button, name);
        list.asks(FormCommand::ListToasts(is_opened), commands);
        list.rect.left()
    }

    /// Draws the older toasts below the newest, with uncut sentences; returns whether the pointer
    /// is on them.
    fn list_ui(&self, ui: &Ui, commands: &mut Vec<Command>) -> bool {
        let newest = self.place();
        let palette = self.palette;
        let area = Area::new(Id::unique("older toasts"))
            .order(Order::Foreground)
            .fixed_pos(newest.left_bottom() + vec2(0.0, 4.0));
        let shown = area.show(ui.ctx(), |ui| {
            let frame = Frame::new()
                .fill(palette.raised)
                .stroke(Stroke::new(1.0, palette.line))
                .corner_radius(6.0)
                .inner_margin(Margin::symmetric(0, 6));
            frame.show(ui, |ui| {
                ui.set_width(newest.width() - 2.0);
                ScrollArea::vertical()
                    .max_height(LIST_HEIGHT)
                    .show(ui, |ui| {
                        for toast in self.notices.toasts().skip(1) {
                            listed_ui(ui, &toast.notice, palette, commands);
                        }
                    });
            });
        });
        shown.response.contains_pointer()
    }
}

/// Draws a toast's background and edge: green for a success, orange for a failure.
fn frame_ui(ui: &Ui, place: Rect, notice: &Notice, palette: &Palette) {
    let color = match notice.kind {
        NoticeKind::Done => palette.good,
        NoticeKind::Trouble => palette.warning,
    };
    ui.painter().rect(
        place,
        6.0,
        palette.raised,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
    let edge = place.with_max_x(place.left() + EDGE);
    ui.painter().rect_filled(edge, 2.0, color);
}

/// Draws an action's button; returns its left edge.
fn action_ui(
    ui: &mut Ui,
    action: &NoticeAction,
    palette: &Palette,
    commands: &mut Vec<Command>,
) -> f32 {
    let text = RichText::new(action_name(action)).color(palette.accent);
    let button = ui.add(Button::new(text).frame(false));
    button.asks(action_command(action), commands);
    button.rect.left()
}

fn action_name(action: &NoticeAction) -> &'static str {
    match action {
        NoticeAction::ShowFolder(_) => "Show folder",
        NoticeAction::Undo => "Undo",
        NoticeAction::SaveElsewhere => "Save elsewhere…",
        NoticeAction::OpenAnother => "Open another…",
        NoticeAction::Compute => "Compute",
    }
}

fn action_command(action: &NoticeAction) -> Command {
    match action {
        NoticeAction::ShowFolder(folder) => OutputCommand::ShowFolder(folder.clone()).into(),
        NoticeAction::Undo => StudyCommand::Undo.into(),
        NoticeAction::SaveElsewhere => FileCommand::AskSaveStudy.into(),
        NoticeAction::OpenAnother => FileCommand::AskOpen.into(),
        NoticeAction::Compute => ComputingCommand::Compute.into(),
    }
}

/// Draws an older toast: its sentence wrapped, with its buttons at the right.
fn listed_ui(ui: &mut Ui, notice: &Notice, palette: &Palette, commands: &mut Vec<Command>) {
    let top = ui.cursor().top();
    let whole = ui.available_rect_before_wrap();
    let row = whole.shrink2(vec2(12.0, 0.0));
    let buttons_width = if notice.action.is_some() { 140.0 } else { 28.0 };
    let words = row.with_max_x(row.right() - buttons_width);
    let text = ui.scope_builder(UiBuilder::new().max_rect(words), |ui| {
        ui.add(Label::new(&notice.text).wrap());
    });
    let height = text.response.rect.height().max(24.0);
    let buttons = Rect::from_min_size(pos2(words.right(), top), vec2(buttons_width, 24.0));
    in_line_ui(ui, buttons, true, |ui| {
        let close = named(
            ui.add(Button::new("×").frame(false)),
            Role::Button,
            format!("Close message: {}", notice.text),
        );
        close.asks(FormCommand::DismissToast(notice.number), commands);
        if let Some(action) = &notice.action {
            action_ui(ui, action, palette, commands);
        }
    });
    let color = match notice.kind {
        NoticeKind::Done => palette.good,
        NoticeKind::Trouble => palette.warning,
    };
    let edge = Rect::from_min_size(pos2(whole.left(), top), vec2(EDGE, height));
    ui.painter().rect_filled(edge, 2.0, color);
    ui.advance_cursor_after_rect(Rect::from_min_size(
        pos2(whole.left(), top),
        vec2(whole.width(), height + 2.0),
    ));
}
