//! Messages in the middle of the top bar, over the name of the dataset, so that they cover no curve
//! and move nothing: toasts, and message bars that wait for an answer. The newest is shown; the
//! others are in a list below it.

use egui::{
    Area, Button, Color32, Frame, Id, Label, Margin, Order, Rect, RichText, Role, ScrollArea,
    Sense, Stroke, StrokeKind, Ui, UiBuilder, pos2, vec2,
};

use gdcm_model::number_format::counted;

use super::message_bars::{bar_buttons, bar_details, bar_line, bar_sentence};
use crate::gui::commands::command::Command;
use crate::gui::commands::computing::ComputingCommand;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::notices::{
    MessageBar, Notice, NoticeAction, NoticeKind, Notices, TopMessage,
};
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body};
use crate::gui::widgets::panel_layout::in_line_ui;

/// Width of a message in a wide and in a narrow window \[pt\].
const WIDTHS: [f32; 2] = [560.0, 400.0];
/// Height of a message \[pt\].
const HEIGHT: f32 = 28.0;
/// Width of the coloured edge \[pt\].
const EDGE: f32 = 3.0;
/// Space at the left and right of the list of messages \[pt\].
const LIST_PADDING: f32 = 12.0;
/// Maximum height of the list of messages \[pt\].
const LIST_HEIGHT: f32 = 280.0;

/// Place of the messages in the top bar, and what they show.
pub(super) struct ToastBar<'a> {
    /// The whole top bar.
    pub(super) bar: Rect,
    /// Area between the menus and the search field.
    pub(super) room: Rect,
    pub(super) is_wide: bool,
    pub(super) notices: &'a Notices,
    pub(super) palette: &'a Palette,
}

/// Content for the list below the newest message.
#[derive(Clone, Copy)]
struct MoreMessages {
    /// Number of messages below the newest.
    count: usize,
    /// Whether the newest has details, which are listed too.
    has_details: bool,
}

impl MoreMessages {
    fn is_listed(self) -> bool {
        self.count > 0 || self.has_details
    }
}

impl ToastBar<'_> {
    /// Returns whether a message covers the name of the dataset.
    pub(super) fn is_shown(&self) -> bool {
        !self.notices.shown().is_empty()
    }

    /// Draws the newest message in the middle of the bar and, if it is open, the list below it;
    /// while the pointer is on them, the timers pause.
    pub(super) fn ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let shown = self.notices.shown();
        let Some((newest, older)) = shown.split_first() else {
            return;
        };
        let more = MoreMessages {
            count: older.len(),
            has_details: matches!(newest, TopMessage::Bar(bar) if !bar_details(bar).is_empty()),
        };
        let place = self.place();
        match newest {
            TopMessage::Toast(toast) => self.toast_ui(ui, &toast.notice, more, commands),
            TopMessage::Bar(bar) => self.bar_ui(ui, bar, more, commands),
        }
        let mut is_held = ui.rect_contains_pointer(place);
        if self.notices.is_list_open && more.is_listed() {
            let details = match newest {
                TopMessage::Bar(bar) => bar_details(bar),
                TopMessage::Toast(_) => Vec::new(),
            };
            is_held |= self.list_ui(ui, &details, older, commands);
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

    /// Returns the place of sentence and buttons.
    fn inner(&self) -> Rect {
        let place = self.place();
        place
            .shrink2(vec2(8.0, 2.0))
            .with_min_x(place.left() + 12.0)
    }

    /// Draws the newest toast: the coloured edge, the sentence, the action, the count of the
    /// others, and the button that closes it.
    fn toast_ui(
        &self,
        ui: &mut Ui,
        notice: &Notice,
        more: MoreMessages,
        commands: &mut Vec<Command>,
    ) {
        let palette = self.palette;
        frame_ui(ui, self.place(), edge_color(notice.kind, palette), palette);
        let inner = self.inner();
        let buttons = in_line_ui(ui, inner, true, |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let close = ui.add(Button::new("×").frame(false));
            let close = named(close, Role::Button, "Dismiss");
            close.asks(FormCommand::DismissToast(notice.number), commands);
            let mut left = close.rect.left();
            if more.is_listed() {
                left = self.more_ui(ui, more, commands);
            }
            match &notice.action {
                Some(action) => action_ui(ui, action, palette, commands),
                None => left,
            }
        });
        let text_place = inner.with_max_x(buttons.inner - 8.0);
        let shown = elided(ui, &notice.text, text_place.width(), BODY_SIZE);
        let id = ui.scope_id().with(("toast", notice.number));
        sentence_ui(ui, text_place, id, &shown, &notice.text, palette);
    }

    /// Draws the newest message bar: the edge, the sentence, its buttons, and the count of the
    /// others.
    fn bar_ui(
        &self,
        ui: &mut Ui,
        bar: &MessageBar,
        more: MoreMessages,
        commands: &mut Vec<Command>,
    ) {
        let palette = self.palette;
        frame_ui(ui, self.place(), palette.warning, palette);
        let inner = self.inner();
        let buttons = in_line_ui(ui, inner, true, |ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            let left = bar_buttons_ui(ui, bar, palette, commands);
            if more.is_listed() {
                self.more_ui(ui, more, commands)
            } else {
                left
            }
        });
        let text_place = inner.with_max_x(buttons.inner - 8.0);
        let shown = bar_line(ui, bar, text_place.width());
        let id = ui.scope_id().with(("message bar", bar.code()));
        sentence_ui(ui, text_place, id, &shown, &bar_sentence(bar), palette);
    }

    /// Draws the button that opens or closes the list of the other messages; returns its left edge.
    fn more_ui(&self, ui: &mut Ui, more: MoreMessages, commands: &mut Vec<Command>) -> f32 {
        let (text, name) = if more.count > 0 {
            let name = counted(more.count, "more message");
            (format!("{} more", more.count), name)
        } else {
            ("Details".to_owned(), "Details of the message".to_owned())
        };
        let text = RichText::new(text)
            .size(SMALL_SIZE)
            .color(self.palette.accent);
        let list = ui.add(Button::new(text).frame(false));
        let is_opened = !self.notices.is_list_open;
        let list = named(list, Role::Button, name);
        list.asks(FormCommand::ListToasts(is_opened), commands);
        list.rect.left()
    }

    /// Draws the details of the newest message and the older messages with whole sentences below
    /// it; returns whether the pointer is on them.
    fn list_ui(
        &self,
        ui: &Ui,
        details: &[String],
        older: &[TopMessage<'_>],
        commands: &mut Vec<Command>,
    ) -> bool {
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
                        for fact in details {
                            fact_ui(ui, fact);
                        }
                        for message in older {
                            match message {
                                TopMessage::Toast(toast) => {
                                    listed_ui(ui, &toast.notice, palette, commands);
                                }
                                TopMessage::Bar(bar) => {
                                    listed_bar_ui(ui, bar, palette, commands);
                                }
                            }
                        }
                    });
            });
        });
        shown.response.contains_pointer()
    }
}

/// Draws a sentence on one line; the whole one is its accessible name, and its tooltip if it is
/// shortened.
fn sentence_ui(ui: &Ui, place: Rect, id: Id, shown: &str, whole: &str, palette: &Palette) {
    painted_text(ui, place, 0.0, shown, body(), palette.text);
    let label = ui.interact(place, id, Sense::hover());
    let label = named(label, Role::Label, whole);
    if shown != whole {
        label.on_hover_text(whole);
    }
}

/// Draws the buttons of a message bar from right to left; returns the left edge of the leftmost.
fn bar_buttons_ui(
    ui: &mut Ui,
    bar: &MessageBar,
    palette: &Palette,
    commands: &mut Vec<Command>,
) -> f32 {
    let mut left = ui.max_rect().right();
    for button in bar_buttons(bar).into_iter().rev() {
        let text = RichText::new(button.text);
        let text = if button.text == "×" {
            text
        } else {
            text.color(palette.accent)
        };
        let response = ui.add(Button::new(text).frame(false));
        let response = named(response, Role::Button, button.name);
        response.asks(button.command, commands);
        left = response.rect.left();
    }
    left
}

/// Returns the colour of the edge: green for a success, orange for a failure.
fn edge_color(kind: NoticeKind, palette: &Palette) -> Color32 {
    match kind {
        NoticeKind::Done => palette.good,
        NoticeKind::Trouble => palette.warning,
    }
}

/// Draws the background of a message with its coloured edge.
fn frame_ui(ui: &Ui, place: Rect, edge_color: Color32, palette: &Palette) {
    ui.painter().rect(
        place,
        6.0,
        palette.raised,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
    let edge = place.with_max_x(place.left() + EDGE);
    ui.painter().rect_filled(edge, 2.0, edge_color);
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
    let row = whole.shrink2(vec2(LIST_PADDING, 0.0));
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
    let edge = Rect::from_min_size(pos2(whole.left(), top), vec2(EDGE, height));
    ui.painter()
        .rect_filled(edge, 2.0, edge_color(notice.kind, palette));
    ui.advance_cursor_after_rect(Rect::from_min_size(
        pos2(whole.left(), top),
        vec2(whole.width(), height + 2.0),
    ));
}

/// Draws an older message bar: its sentence wrapped, its buttons in a line below it.
fn listed_bar_ui(ui: &mut Ui, bar: &MessageBar, palette: &Palette, commands: &mut Vec<Command>) {
    let whole = ui.available_rect_before_wrap();
    fact_ui(ui, &bar_sentence(bar));
    let row = Rect::from_min_size(ui.cursor().min, vec2(whole.width() - LIST_PADDING, 24.0));
    in_line_ui(ui, row, true, |ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        bar_buttons_ui(ui, bar, palette, commands);
    });
    let edge = Rect::from_min_max(whole.min, pos2(whole.left() + EDGE, row.bottom()));
    ui.painter().rect_filled(edge, 2.0, palette.warning);
    ui.advance_cursor_after_rect(row);
}

/// Draws a wrapped sentence in the list.
fn fact_ui(ui: &mut Ui, text: &str) {
    let row = ui.available_rect_before_wrap();
    let row = row.shrink2(vec2(LIST_PADDING, 0.0));
    ui.scope_builder(UiBuilder::new().max_rect(row), |ui| {
        ui.add(Label::new(text).wrap());
    });
}
