//! The bar on top: menus, undo and redo, what is open, the theme.

use egui::{Align, Button, Layout, MenuBar, RichText, ThemePreference, Ui};

use super::command::Command;
use super::command_table::{Menu, command_table};
use super::palette::Palette;
use super::state::{RecentFile, State};

/// Menus and the state of the document.
pub fn menu_bar_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    MenuBar::new().ui(ui, |ui| {
        ui.label(RichText::new("gdcm").strong());
        ui.add_space(4.0);
        if ui.menu_button("File", |ui| menu_ui(ui, state, Menu::File, commands)).response.clicked() {
            commands.push(Command::LookForRecent);
        }
        ui.menu_button("Edit", |ui| menu_ui(ui, state, Menu::Edit, commands));
        ui.menu_button("View", |ui| menu_ui(ui, state, Menu::View, commands));
        ui.menu_button("Help", |ui| menu_ui(ui, state, Menu::Help, commands));
        ui.separator();
        history_ui(ui, state, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            theme_ui(ui, commands);
            title_ui(ui, state, palette);
        });
    });
}

/// The entries of one menu, in groups parted by lines.
fn menu_ui(ui: &mut Ui, state: &State, menu: Menu, commands: &mut Vec<Command>) {
    let entries = command_table(state).into_iter().filter_map(|entry| {
        let (within, group) = entry.menu?;
        (within == menu).then_some((group, entry))
    });
    let mut last = None;
    for (group, entry) in entries {
        if last.replace(group).is_some_and(|last| last != group) {
            ui.separator();
        }
        let is_recent_place = entry.command == Command::OpenExample && !state.recent.is_empty();
        if is_recent_place {
            ui.menu_button("Open recent", |ui| recent_menu_ui(ui, state, commands));
        }
        let keys = entry.shortcuts.first().map(|shortcut| ui.ctx().format_shortcut(shortcut));
        let button = Button::new(entry.name.as_str());
        // An empty text would end the button's name in a space.
        let button = if let Some(keys) = keys { button.shortcut_text(keys) } else { button };
        let response = ui.add_enabled(entry.enabled, button);
        if response.on_hover_text(entry.meaning).clicked() {
            commands.push(entry.command);
            ui.close();
        }
    }
    if menu == Menu::View {
        ui.separator();
        ui.menu_button("Curves", |ui| menu_ui(ui, state, Menu::Curves, commands));
    }
}

/// The newest first; what is not there any more cannot be chosen.
fn recent_menu_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    for RecentFile { path, name, folder, missing } in &state.recent {
        let button = Button::new(name.as_str()).right_text(if *missing { "missing" } else { "" });
        let response = ui.add_enabled(!missing, button).on_hover_text(folder);
        if response.on_disabled_hover_text(format!("It is not in {folder} any more")).clicked() {
            commands.push(Command::Open(path.clone()));
            ui.close();
        }
    }
}

fn history_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let undo = state.history.undo_label();
    let text = undo.map_or("↶ Undo".to_owned(), |label| format!("↶ Undo {label}"));
    let button = ui.add_enabled(undo.is_some(), Button::new(text).frame(false));
    if button.on_hover_text("Take the last decision back (Ctrl+Z)").clicked() {
        commands.push(Command::Undo);
    }
    let redo = state.history.redo_label();
    let text = redo.map_or("↷ Redo".to_owned(), |label| format!("↷ Redo {label}"));
    let button = ui.add_enabled(redo.is_some(), Button::new(text).frame(false));
    if button.on_hover_text("Bring it back again (Ctrl+Shift+Z)").clicked() {
        commands.push(Command::Redo);
    }
}

fn theme_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    let dark = ui.visuals().dark_mode;
    let (symbol, other, hint) = if dark {
        ("◐ Light", ThemePreference::Light, "Change to the light theme")
    } else {
        ("◐ Dark", ThemePreference::Dark, "Change to the dark theme")
    };
    if ui.add(Button::new(symbol).frame(false)).on_hover_text(hint).clicked() {
        commands.push(Command::SetTheme(other));
    }
}

fn title_ui(ui: &mut Ui, state: &State, palette: &Palette) {
    let mark = if state.unsaved { " •" } else { "" };
    let study = RichText::new(format!("· {}{mark}", state.study_name)).color(palette.dim_text);
    let hint = if state.unsaved { "There are decisions that are not saved" } else { "Every decision is saved" };
    ui.add(egui::Label::new(study).truncate()).on_hover_text(hint);
    let name = egui::Label::new(state.dataset().name()).truncate();
    ui.add(name).on_hover_text(state.dataset().description());
}
