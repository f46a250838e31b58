//! Keyboard shortcuts: finds the entries in the command table whose keys were pressed.

use std::cmp::Reverse;

use egui::{Context, Event, Key, KeyboardShortcut, Popup};

use crate::gui::commands::command::Command;
use crate::gui::commands::command_table::command_table;
use crate::gui::commands::entry::Reach;
use crate::gui::state::window_state::State;
use crate::gui::widgets::escape_key::was_focused;

/// Returns the commands whose shortcuts were pressed since the last frame, and consumes these key
/// events.
pub fn pressed(ctx: &Context, state: &State) -> Vec<Command> {
    if !is_any_key_pressed(ctx) {
        return Vec::new();
    }
    let mut shortcuts = active_shortcuts(ctx, state);
    // A shortcut without Shift or Alt also matches the keys for a shortcut with them, so shortcuts
    // with more modifiers come first.
    shortcuts.sort_by_key(|active| {
        let modifiers = active.keys.modifiers;
        Reverse(u8::from(modifiers.shift) + u8::from(modifiers.alt))
    });
    let mut commands = Vec::new();
    for active in shortcuts {
        if ctx.input_mut(|input| input.consume_shortcut(&active.keys)) {
            commands.push(active.command);
        }
    }
    commands
}

fn is_any_key_pressed(ctx: &Context) -> bool {
    ctx.input(|input| {
        input
            .events
            .iter()
            .any(|event| matches!(event, Event::Key { pressed: true, .. }))
    })
}

/// A shortcut that works now, with its command.
struct ActiveShortcut {
    keys: KeyboardShortcut,
    command: Command,
}

/// Returns the shortcuts of enabled entries that the focus, forms and popups allow.
fn active_shortcuts(ctx: &Context, state: &State) -> Vec<ActiveShortcut> {
    let is_focused = ctx.memory(|memory| memory.focused().is_some());
    let is_free = !is_focused
        && !ctx.egui_wants_keyboard_input()
        && state.forms.shown.is_none()
        && !Popup::is_any_open(ctx);
    // Escape has already removed the focus here: if a field had the focus, Escape was meant for
    // that field.
    let is_escape_taken = was_focused(ctx);
    let mut active = Vec::new();
    for entry in command_table(state) {
        let is_within_reach = entry.reach == Reach::Everywhere || is_free;
        let has_escape = entry
            .shortcuts
            .iter()
            .any(|keys| keys.logical_key == Key::Escape);
        if !entry.enabled || !is_within_reach || has_escape && is_escape_taken {
            continue;
        }
        for keys in entry.shortcuts {
            let command = entry.command.clone();
            active.push(ActiveShortcut { keys, command });
        }
    }
    active
}
