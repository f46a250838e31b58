//! The keys of the table of commands.

use std::cmp::Reverse;

use egui::{Context, Event, Id, Key, KeyboardShortcut, Popup};

use crate::view::command::Command;
use crate::view::command_table::{Entry, Reach, command_table};
use crate::view::state::State;

/// The commands of the keys pressed since the last frame.
pub fn pressed(ctx: &Context, state: &State) -> Vec<Command> {
    let focused = ctx.memory(|memory| memory.focused().is_some());
    let before = Id::unique("was anything focused");
    let was_focused = ctx.data_mut(|data| std::mem::replace(data.get_temp_mut_or_default::<bool>(before), focused));
    let is_key = |event: &Event| matches!(event, Event::Key { pressed: true, .. });
    if !ctx.input(|input| input.events.iter().any(is_key)) {
        return Vec::new();
    }
    let has_no_focus = !focused && !ctx.egui_wants_keyboard_input();
    let is_free = has_no_focus && state.forms.shown.is_none() && !Popup::is_any_open(ctx);
    // Escape has taken the focus away by now: where there was one, the key was the field's.
    let is_left_to_field = |keys: &KeyboardShortcut| was_focused && keys.logical_key == Key::Escape;
    let is_given = |entry: &Entry| {
        let is_within_reach = entry.reach == Reach::Everywhere || is_free;
        entry.enabled && is_within_reach && !entry.shortcuts.iter().any(is_left_to_field)
    };
    let entries = command_table(state).into_iter().filter(is_given);
    let mut keys: Vec<(KeyboardShortcut, Command)> = entries
        .flat_map(|entry| entry.shortcuts.into_iter().map(move |shortcut| (shortcut, entry.command.clone())))
        .collect();
    // The keys of a shortcut without Shift are also those of one with it.
    keys.sort_by_key(|(shortcut, _)| Reverse(shortcut.modifiers.shift));
    let is_pressed = |shortcut: &KeyboardShortcut| ctx.input_mut(|input| input.consume_shortcut(shortcut));
    keys.into_iter().filter(|(shortcut, _)| is_pressed(shortcut)).map(|(_, command)| command).collect()
}
