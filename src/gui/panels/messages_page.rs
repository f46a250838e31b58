//! Messages since the start, newest first: readable and copyable after their toasts are gone.

use egui::{Label, RichText, ScrollArea};

use super::form_parts::Form;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::notices::{Notice, NoticeKind, Notices};
use crate::gui::widgets::palette::SMALL_SIZE;

/// Draws all messages since the start.
pub(super) fn messages_ui(form: &mut Form<'_, '_>, notices: &Notices) {
    form.title("Messages of this session");
    let messages = notices.kept();
    if messages.is_empty() {
        form.explain("No messages yet");
    }
    let palette = form.palette;
    ScrollArea::vertical()
        .max_height(420.0)
        .show(form.ui, |ui| {
            ui.set_width(ui.available_width());
            for notice in messages.iter().rev() {
                ui.horizontal_top(|ui| {
                    ui.label(palette.small(&notice.at));
                    let color = match notice.kind {
                        NoticeKind::Done => palette.good,
                        NoticeKind::Trouble => palette.warning,
                    };
                    ui.label(RichText::new("●").size(SMALL_SIZE).color(color));
                    ui.add(Label::new(&notice.text).wrap().selectable(true));
                });
            }
        });
    form.ui.add_space(8.0);
    form.line(|form| {
        form.button_ui("Close", true, FormCommand::ShowForm(None));
        if !messages.is_empty() {
            let lines: Vec<String> = messages.iter().map(message_line).collect();
            let copy = OutputCommand::CopyText(lines.join("\n"));
            form.button_ui("Copy all messages", false, copy);
        }
    });
}

/// Returns, for example, "14:32  saved example.json".
fn message_line(notice: &Notice) -> String {
    format!("{}  {}", notice.at, notice.text)
}
