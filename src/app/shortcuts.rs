//! The keys of the table of commands.

use std::cmp::Reverse;

use egui::{Context, Event, KeyboardShortcut};

use crate::view::command::Command;
use crate::view::command_table::{Reach, command_table};
use crate::view::state::State;

/// The commands of the keys pressed since the last frame.
pub fn pressed(ctx: &Context, state: &State) -> Vec<Command> {
    let is_key = |event: &Event| matches!(event, Event::Key { pressed: true, .. });
    if !ctx.input(|input| input.events.iter().any(is_key)) {
        return Vec::new();
    }
    let has_no_focus = ctx.memory(|memory| memory.focused().is_none()) && !ctx.egui_wants_keyboard_input();
    let is_free = has_no_focus && state.forms.shown.is_none();
    let entries = command_table(state).into_iter().filter(|entry| is_free || entry.reach == Reach::Everywhere);
    let mut keys: Vec<(KeyboardShortcut, Option<Command>)> = entries
        .flat_map(|entry| {
            let command = entry.enabled.then_some(entry.command);
            entry.shortcuts.into_iter().map(move |shortcut| (shortcut, command.clone()))
        })
        .collect();
    // The keys of a shortcut without Shift are also those of one with it.
    keys.sort_by_key(|(shortcut, _)| Reverse(shortcut.modifiers.shift));
    let is_pressed = |shortcut: &KeyboardShortcut| ctx.input_mut(|input| input.consume_shortcut(shortcut));
    keys.into_iter().filter(|(shortcut, _)| is_pressed(shortcut)).filter_map(|(_, command)| command).collect()
}
