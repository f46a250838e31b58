//! Menu bar: menus, undo and redo, the document title or a toast over it, the search field and the
//! theme switch.

use egui::{
    Button, Key, KeyboardShortcut, MenuBar, Modifiers, Rect, RichText, Role, Sense, Stroke,
    StrokeKind, ThemePreference, Ui, pos2, vec2,
};

use gdcm_io::Example;

use super::toasts::ToastBar;
use crate::gui::commands::command::Command;
use crate::gui::commands::command_table::command_table;
use crate::gui::commands::entry::Menu;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::step_name::step_name;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, button_ui, named};
use crate::gui::widgets::elision::{elided, text_width};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};
use crate::gui::widgets::panel_layout::in_line_ui;

/// Draws the menus, undo and redo, the newest message or, without messages, the document title, the
/// search field for commands, and the theme switch.
pub fn menu_bar_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let bar = ui.available_rect_before_wrap();
    let left = in_line_ui(ui, bar, false, |ui| {
        let shown = MenuBar::new().ui(ui, |ui| {
            ui.label(RichText::new("gdcm").font(medium(BODY_SIZE)));
            ui.add_space(4.0);
            let file = ui.menu_button("File", |ui| menu_ui(ui, state, Menu::File, commands));
            file.response.asks(FileCommand::LookForRecent, commands);
            for (name, menu) in [
                ("Edit", Menu::Edit),
                ("View", Menu::View),
                ("Help", Menu::Help),
            ] {
                ui.menu_button(name, |ui| menu_ui(ui, state, menu, commands));
            }
            ui.separator();
            history_ui(ui, state, commands);
            ui.cursor().left()
        });
        shown.inner
    });
    let rest = bar.with_min_x(left.inner + 8.0);
    let right = in_line_ui(ui, rest, true, |ui| {
        theme_ui(ui, commands);
        search_ui(ui, palette, commands)
    });
    let room = rest.with_max_x(right.inner - 8.0);
    let toasts = ToastBar {
        bar,
        room,
        is_wide: state.display.layout.is_wide,
        notices: &state.notices,
        palette,
    };
    if toasts.is_shown() {
        toasts.ui(ui, commands);
    } else {
        title_ui(ui, bar, room, state, palette);
    }
    ui.advance_cursor_after_rect(bar);
}

/// Draws the field that opens the command palette; returns its left edge.
fn search_ui(ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) -> f32 {
    let (rect, response) = ui.allocate_exact_size(vec2(168.0, 24.0), Sense::click());
    let line = if response.hovered() {
        palette.dim_text
    } else {
        palette.line
    };
    ui.painter().rect(
        rect,
        6.0,
        palette.background,
        Stroke::new(1.0, line),
        StrokeKind::Inside,
    );
    let inner = rect.shrink2(vec2(9.0, 0.0));
    painted_text(ui, inner, 0.0, "Find a command", body(), palette.dim_text);
    let keys = KeyboardShortcut::new(Modifiers::COMMAND, Key::K);
    let keys = ui.ctx().format_shortcut(&keys);
    painted_text(ui, inner, AT_RIGHT_END, &keys, small(), palette.dim_text);
    named(response, Role::Button, "Find a command")
        .asks(FormCommand::ShowForm(Some(FormKind::Palette)), commands);
    rect.left()
}

/// Draws menu entries, in groups separated by lines. In the File menu, the recent files come before
/// the first example; at the end of the View menu is the submenu for curves.
fn menu_ui(ui: &mut Ui, state: &State, menu: Menu, commands: &mut Vec<Command>) {
    let mut last = None;
    let first_example = Command::File(FileCommand::OpenExample(Example::ALL[0]));
    for entry in command_table(state) {
        let Some((within, group)) = entry.menu else {
            continue;
        };
        if within != menu {
            continue;
        }
        if last.is_some_and(|last| last != group) {
            ui.separator();
        }
        last = Some(group);
        let is_recent_place = entry.command == first_example && !state.recent.is_empty();
        if is_recent_place {
            ui.menu_button("Open recent", |ui| recent_menu_ui(ui, state, commands));
        }
        let mut button = Button::new(entry.name.as_str());
        // Empty text would add a trailing space to the button's name.
        if let Some(shortcut) = entry.shortcuts.first() {
            button = button.shortcut_text(ui.ctx().format_shortcut(shortcut));
        }
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

/// Draws the recent files, newest first; missing files are disabled.
fn recent_menu_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    for file in &state.recent {
        let mark = if file.missing { "missing" } else { "" };
        let button = Button::new(file.name.as_str()).right_text(mark);
        let response = ui
            .add_enabled(!file.missing, button)
            .on_hover_text(&file.folder)
            .on_disabled_hover_text(format!("File not found in {}", file.folder));
        if response.clicked() {
            commands.push(FileCommand::Open(file.path.clone()).into());
            ui.close();
        }
    }
}

fn history_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let [undo_keys, redo_keys] = [
        Modifiers::COMMAND,
        Modifiers::COMMAND.plus(Modifiers::SHIFT),
    ]
    .map(|keys| {
        ui.ctx()
            .format_shortcut(&KeyboardShortcut::new(keys, Key::Z))
    });
    let undo = HistoryButton {
        verb: "↶ Undo",
        name: state.history.undo_step().map(step_name),
        hint: &undo_keys,
        command: StudyCommand::Undo,
    };
    undo.ui(ui, commands);
    let redo = HistoryButton {
        verb: "↷ Redo",
        name: state.history.redo_step().map(step_name),
        hint: &redo_keys,
        command: StudyCommand::Redo,
    };
    redo.ui(ui, commands);
}

/// Button that undoes or redoes a decision.
struct HistoryButton<'a> {
    verb: &'a str,
    /// Decision to undo or redo; `None` disables the button.
    name: Option<String>,
    hint: &'a str,
    command: StudyCommand,
}

impl HistoryButton<'_> {
    fn ui(self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let text = match &self.name {
            Some(name) => format!("{} {name}", self.verb),
            None => self.verb.to_owned(),
        };
        let button = Button::new(text).frame(false);
        ui.add_enabled_ui(self.name.is_some(), |ui| {
            button_ui(ui, button, self.hint, self.command, commands)
        });
    }
}

/// Draws the theme switch, a half-filled disc.
fn theme_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    let (name, other) = if ui.visuals().dark_mode {
        ("Change to the light theme", ThemePreference::Light)
    } else {
        ("Change to the dark theme", ThemePreference::Dark)
    };
    let button = named(ui.add(Button::new("◐").frame(false)), Role::Button, name);
    button
        .on_hover_text(name)
        .asks(LayoutCommand::SetTheme(other), commands);
}

/// Draws dataset and study name in the middle of the bar, if they fit.
fn title_ui(ui: &mut Ui, bar: Rect, room: Rect, state: &State, palette: &Palette) {
    let edited = if state.unsaved { " · edited" } else { "" };
    let study = format!("{}{edited}", state.study_name);
    let study_width = text_width(ui, &study, body());
    let name = elided(
        ui,
        state.dataset().name(),
        room.width() - study_width - 8.0,
        BODY_SIZE,
    );
    let whole = text_width(ui, &name, medium(BODY_SIZE)) + 8.0 + study_width;
    let left = (bar.center().x - 0.5 * whole)
        .min(room.right() - whole)
        .max(room.left());
    if whole > room.width() {
        return;
    }
    let place = Rect::from_min_size(pos2(left, bar.top()), vec2(whole, bar.height()));
    painted_text(ui, place, 0.0, &name, medium(BODY_SIZE), palette.text);
    painted_text(ui, place, AT_RIGHT_END, &study, body(), palette.dim_text);
    let response = ui.interact(place, ui.scope_id().with("document"), Sense::hover());
    let is_saved = if state.unsaved {
        "Unsaved decisions"
    } else {
        "All decisions saved"
    };
    let response = named(
        response,
        Role::Label,
        format!("{}, {study}", state.dataset().name()),
    );
    response.on_hover_text(format!("{}\n{is_saved}", state.dataset().description()));
}
