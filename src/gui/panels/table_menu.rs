//! Table headings in the panels, with a menu that copies or saves the table.

use egui::{Align, Layout, RichText, Role, Sense, Ui};

use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::panel_tables::TableKind;
use crate::gui::widgets::controls::{entries_ui, named};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};

/// Heading over a table, with a value on the right.
pub struct TableHeading<'a> {
    pub title: &'a str,
    pub value: &'a str,
    pub kind: TableKind,
}

impl TableHeading<'_> {
    /// Draws the heading; a right-click opens the menu that copies or saves the table.
    pub fn ui(&self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        ui.add_space(4.0);
        let heading = ui.horizontal(|ui| {
            ui.label(RichText::new(self.title).font(medium(BODY_SIZE)));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.label(palette.small(self.value))
            });
        });
        table_menu_ui(ui, &heading.response, self.kind, commands);
    }
}

/// Draws the heading's context menu.
pub fn table_menu_ui(
    ui: &mut Ui,
    heading: &egui::Response,
    kind: TableKind,
    commands: &mut Vec<Command>,
) {
    // `Sense::CLICK` is not reachable by Tab: a heading has no primary action.
    let response = ui.interact(heading.rect, heading.id.with("table"), Sense::CLICK);
    let response = named(response, Role::Label, format!("Heading of {}", kind.name()));
    response.context_menu(|ui| {
        let choices = [
            (
                "Copy table",
                Command::Output(OutputCommand::CopyTable(kind)),
            ),
            (
                "Save table as CSV…",
                Command::Output(OutputCommand::AskSaveTable(kind)),
            ),
        ];
        entries_ui(ui, choices, commands);
    });
}
