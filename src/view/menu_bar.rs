//! The bar on top: menus, undo and redo, what is open, the theme.

use egui::{Align, Button, Layout, MenuBar, RichText, ThemePreference, Ui};

use crate::study::Edit;

use super::arrangement::{Preset, View};
use super::command::{Command, FormKind};
use super::looks_menu::{curve_units_menu_ui, looks_menu_ui};
use super::palette::Palette;
use super::plot::FrequencyUnit;
use super::state::{RecentFile, State};

/// Menus and the state of the document.
pub fn menu_bar_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    MenuBar::new().ui(ui, |ui| {
        ui.label(RichText::new("gdcm").strong());
        ui.add_space(4.0);
        if ui.menu_button("File", |ui| file_menu_ui(ui, state, commands)).response.clicked() {
            commands.push(Command::LookForRecent);
        }
        ui.menu_button("Edit", |ui| edit_menu_ui(ui, state, commands));
        ui.menu_button("View", |ui| view_menu_ui(ui, state, commands));
        ui.menu_button("Help", |ui| help_menu_ui(ui, commands));
        ui.separator();
        history_ui(ui, state, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            theme_ui(ui, commands);
            title_ui(ui, state, palette);
        });
    });
}

fn entry(ui: &mut Ui, text: &str, keys: &str, command: Command, commands: &mut Vec<Command>) {
    if ui.add(Button::new(text).shortcut_text(keys)).clicked() {
        commands.push(command);
        ui.close();
    }
}

fn file_menu_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    entry(ui, "Open…", "Ctrl+O", Command::AskOpen, commands);
    entry(ui, "Open by path…", "Ctrl+Shift+O", Command::ShowForm(Some(FormKind::Open)), commands);
    if !state.recent.is_empty() {
        ui.menu_button("Open recent", |ui| recent_menu_ui(ui, state, commands));
    }
    entry(ui, "Open the example", "", Command::OpenExample, commands);
    ui.separator();
    entry(ui, "Save study", "Ctrl+S", Command::SaveStudy, commands);
    entry(ui, "Save study as…", "Ctrl+Shift+S", Command::AskSaveStudy, commands);
    ui.separator();
    if state.analysis().is_some() {
        entry(ui, "Export corrections …", "Ctrl+E", Command::ShowForm(Some(FormKind::Export)), commands);
        ui.separator();
    }
    entry(ui, "Quit", "Ctrl+Q", Command::Quit, commands);
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

fn edit_menu_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    if let Some(label) = state.history.undo_label() {
        entry(ui, &format!("Undo {label}"), "Ctrl+Z", Command::Undo, commands);
    }
    if let Some(label) = state.history.redo_label() {
        entry(ui, &format!("Redo {label}"), "Ctrl+Shift+Z", Command::Redo, commands);
    }
    entry(ui, "Hold exactly the on-axis responses", "", Edit::ConstrainOnAxis.into(), commands);
    let condition = state.condition().id();
    let scheduled = state.study.choice(condition).scheduled;
    let text =
        if scheduled { "Leave this condition out of the schedule" } else { "Take this condition into the schedule" };
    entry(ui, text, "", Edit::SetScheduled { condition, scheduled: !scheduled }.into(), commands);
}

fn view_menu_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    entry(ui, "Fit the plots", "F", Command::FitPlots, commands);
    let (text, unit) = match state.display.unit {
        FrequencyUnit::RadPerSecond => ("Frequencies in Hz", FrequencyUnit::Hertz),
        FrequencyUnit::Hertz => ("Frequencies in rad/s", FrequencyUnit::RadPerSecond),
    };
    entry(ui, text, "", Command::SetFrequencyUnit(unit), commands);
    ui.menu_button("Units of curves", |ui| curve_units_menu_ui(ui, &state.display.curves, commands));
    ui.menu_button("Looks of curves", |ui| looks_menu_ui(ui, state.display.looks, commands));
    ui.separator();
    for view in View::ALL {
        entry(ui, &format!("Show {}", view.name()), "", Command::ShowView(view), commands);
    }
    ui.separator();
    for preset in Preset::ALL {
        entry(ui, preset.name(), "", Command::Arrange(preset), commands);
    }
    ui.separator();
    entry(ui, "Theme of the desktop", "", Command::SetTheme(ThemePreference::System), commands);
    entry(ui, "Dark theme", "", Command::SetTheme(ThemePreference::Dark), commands);
    entry(ui, "Light theme", "", Command::SetTheme(ThemePreference::Light), commands);
}

fn help_menu_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    entry(ui, "Keys and gestures", "F1", Command::ShowForm(Some(FormKind::Shortcuts)), commands);
    entry(ui, "About gdcm", "", Command::ShowForm(Some(FormKind::About)), commands);
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
