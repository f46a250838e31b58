//! Save menu in a view's header: copies or saves the figure or the tables.

use egui::containers::menu::MenuButton;
use egui::{Button, Role, Ui};

use gdcm_plot::figure::FigureFormat;
use gdcm_words::Table;

use super::requirement_tables::requirement_tables;
use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::named;

/// Returns the tables that are saved as a view's values; `None` if its figure's values are saved,
/// or until the tables are available.
pub fn tables_of_view(state: &State, view: View) -> Option<Vec<Table>> {
    match view {
        View::Requirements => requirement_tables(state),
        _ => None,
    }
}

/// Draws the menu that copies a view's values, or saves them or its figure; nothing for a view
/// without a figure.
pub fn figure_button_ui(ui: &mut Ui, view: View, commands: &mut Vec<Command>) {
    if view.figure().is_none() {
        return;
    }
    let (button, _) = MenuButton::from_button(Button::new("Save").frame(false)).ui(ui, |ui| {
        if ui
            .button("Copy the values")
            .on_hover_text("As CSV, to the clipboard")
            .clicked()
        {
            commands.push(OutputCommand::CopyFigure(view).into());
            ui.close();
        }
        for format in FigureFormat::ALL {
            let text = format!("Save as {}…", format.extension().to_uppercase());
            if ui.button(text).on_hover_text(format.words()).clicked() {
                commands.push(OutputCommand::AskSaveFigure(view, format).into());
                ui.close();
            }
        }
    });
    let button = named(
        button,
        Role::Button,
        format!("Save or copy {}", view.name()),
    );
    button.on_hover_text("Plot as SVG, PNG or PDF, or its values as CSV");
}
