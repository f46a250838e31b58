//! Keys: the shortcuts of the command table, and typed text, which reaches the intended field
//! however slow the frames are.

use std::cmp::Reverse;

use egui::{Context, Event, Key, KeyboardShortcut, Plugin, Popup, RawInput};

use crate::gui::commands::command::Command;
use crate::gui::commands::command_table::command_table;
use crate::gui::commands::entry::{Entry, Reach};
use crate::gui::state::window_state::State;
use crate::gui::widgets::focus::was_focused;

/// Returns the commands of the keys pressed since the last frame.
pub fn pressed(ctx: &Context, state: &State) -> Vec<Command> {
    let focused = ctx.memory(|memory| memory.focused().is_some());
    let is_key = |event: &Event| matches!(event, Event::Key { pressed: true, .. });
    if !ctx.input(|input| input.events.iter().any(is_key)) {
        return Vec::new();
    }
    let has_no_focus = !focused && !ctx.egui_wants_keyboard_input();
    let is_free = has_no_focus && state.forms.shown.is_none() && !Popup::is_any_open(ctx);
    // Escape has already removed the focus here: if a field had it, the key belonged to the field.
    let is_left_to_field =
        |keys: &KeyboardShortcut| was_focused(ctx) && keys.logical_key == Key::Escape;
    let is_given = |entry: &Entry| {
        let is_within_reach = entry.reach == Reach::Everywhere || is_free;
        entry.enabled && is_within_reach && !entry.shortcuts.iter().any(is_left_to_field)
    };
    let entries = command_table(state).into_iter().filter(is_given);
    let mut keys: Vec<(KeyboardShortcut, Command)> = entries
        .flat_map(|entry| {
            entry
                .shortcuts
                .into_iter()
                .map(move |shortcut| (shortcut, entry.command.clone()))
        })
        .collect();
    // A shortcut without Shift or Alt also matches the keys of one with them, so shortcuts with
    // more modifiers come first.
    keys.sort_by_key(|(shortcut, _)| {
        Reverse(u8::from(shortcut.modifiers.shift) + u8::from(shortcut.modifiers.alt))
    });
    let is_pressed =
        |shortcut: &KeyboardShortcut| ctx.input_mut(|input| input.consume_shortcut(shortcut));
    keys.into_iter()
        .filter(|(shortcut, _)| is_pressed(shortcut))
        .map(|(_, command)| command)
        .collect()
}

/// Forwards keyboard and pointer events in their original order.
///
/// If a frame takes long, "3", Tab and "4" arrive in one frame, in which only one field has the
/// focus. Events that move the focus therefore get a frame of their own, and text typed after them
/// goes to a later frame. After Tab another frame passes: a widget that receives the focus
/// backwards learns of it only in the next frame, and selects its text, to be replaced, at the end
/// of that frame.
#[derive(Default)]
pub(super) struct KeyOrder {
    /// Events for later frames.
    later: Vec<Event>,
    /// Whether Tab moved the focus in the previous frame.
    has_moved: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Text, and keys that do not move the focus.
    Typing,
    /// A key that may move the focus.
    Moving,
    /// A pointer button, which may also move the focus.
    Button,
}

impl Kind {
    fn of(event: &Event) -> Option<Self> {
        match event {
            Event::Key {
                key, pressed: true, ..
            } if moves_focus(*key) => Some(Self::Moving),
            Event::Key { pressed: true, .. } | Event::Text(_) | Event::Paste(_) | Event::Ime(_) => {
                Some(Self::Typing)
            }
            Event::PointerButton { .. } => Some(Self::Button),
            _ => None,
        }
    }

    /// Returns whether `next` may share the frame. Clicks may, since a double click is recognised
    /// by its times.
    fn goes_with(self, next: Self) -> bool {
        self == next && self != Self::Moving
    }
}

/// Returns whether a key may move the focus. The arrow keys move between cells but are excluded: a
/// pressed arrow key repeats faster than slow frames.
fn moves_focus(key: Key) -> bool {
    matches!(key, Key::Tab | Key::F6 | Key::Enter | Key::Escape)
}

fn is_tab(event: &Event) -> bool {
    matches!(
        event,
        Event::Key {
            key: Key::Tab,
            pressed: true,
            ..
        }
    )
}

/// Returns how many of the events belong to one frame.
fn of_one_frame(events: &[Event]) -> usize {
    let mut before = None;
    for (count, event) in events.iter().enumerate() {
        let Some(kind) = Kind::of(event) else {
            continue;
        };
        if before.is_some_and(|before: Kind| !before.goes_with(kind)) {
            return count;
        }
        before = Some(kind);
    }
    events.len()
}

impl Plugin for KeyOrder {
    fn debug_name(&self) -> &'static str {
        "key order"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        self.later.append(&mut input.events);
        let count = if std::mem::take(&mut self.has_moved) {
            0
        } else {
            of_one_frame(&self.later)
        };
        let rest = self.later.split_off(count);
        input.events = std::mem::replace(&mut self.later, rest);
        self.has_moved = input.events.iter().any(is_tab);
        if !self.later.is_empty() {
            ctx.request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::{Modifiers, PointerButton, Pos2};

    use super::*;

    fn key(key: Key) -> Event {
        Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        }
    }

    fn button(pressed: bool) -> Event {
        Event::PointerButton {
            pos: Pos2::ZERO,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        }
    }

    /// Returns the number of events in each frame.
    fn frames(mut events: Vec<Event>) -> Vec<usize> {
        let mut counts = Vec::new();
        while !events.is_empty() {
            counts.push(of_one_frame(&events));
            events.drain(..of_one_frame(&events));
        }
        counts
    }

    #[test]
    fn what_moves_the_focus_comes_in_a_frame_of_its_own() {
        let text = |text: &str| Event::Text(text.to_owned());
        assert_eq!(
            frames(vec![
                text("3"),
                text("0"),
                key(Key::Tab),
                text("4"),
                key(Key::Enter)
            ]),
            [2, 1, 1, 1]
        );
        assert_eq!(frames(vec![key(Key::Tab), key(Key::Tab)]), [1, 1]);
        assert_eq!(frames(vec![button(true), button(false), text("4")]), [2, 1]);
    }

    #[test]
    fn the_clicks_of_a_double_click_and_what_only_moves_stay_together() {
        let moved = || Event::PointerMoved(Pos2::ZERO);
        let clicks = vec![
            moved(),
            button(true),
            button(false),
            moved(),
            button(true),
            button(false),
        ];
        assert_eq!(frames(clicks), [6]);
        assert_eq!(frames(vec![moved(), moved()]), [2]);
    }
}
