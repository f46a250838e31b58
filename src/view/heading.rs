//! The heading of a part of a panel.

use egui::{Align, Layout, RichText, Role, Sense, Ui, WidgetInfo};

use super::command::Command;
use super::palette::{Palette, SMALL_SIZE};
use super::tables::TableKind;

/// A dim heading on the left, a figure on the right.
pub fn heading_ui(ui: &mut Ui, palette: &Palette, title: &str, figure: &str) -> egui::Response {
    ui.add_space(4.0);
    let shown = ui.horizontal(|ui| {
        ui.label(RichText::new(title).size(SMALL_SIZE).strong().color(palette.dim_text));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(RichText::new(figure).size(SMALL_SIZE).color(palette.dim_text));
        });
    });
    shown.response
}

/// The same over a table: the secondary button copies it or saves it, as the palette does.
pub fn table_heading_ui(
    ui: &mut Ui,
    palette: &Palette,
    (title, figure): (&str, &str),
    kind: TableKind,
    commands: &mut Vec<Command>,
) {
    let heading = heading_ui(ui, palette, title, figure);
    table_menu_ui(ui, &heading, kind, commands);
}

/// What the secondary button offers on the heading of a table.
pub fn table_menu_ui(ui: &mut Ui, heading: &egui::Response, kind: TableKind, commands: &mut Vec<Command>) {
    // No stop of the Tab key: nothing on it can be pressed.
    let response = ui.interact(heading.rect, heading.id.with("table"), Sense::CLICK);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Heading of {}", kind.name())));
    response.context_menu(|ui| {
        let choices = [("Copy table", Command::CopyTable(kind)), ("Save table as CSV…", Command::AskSaveTable(kind))];
        for (text, command) in choices {
            if ui.button(text).clicked() {
                commands.push(command);
                ui.close();
            }
        }
    });
}
