//! Keys: those of the table of commands, and what is typed, which goes to the field that is meant however slow the frames are.

use std::cmp::Reverse;

use egui::{Context, Event, Key, KeyboardShortcut, Plugin, Popup, RawInput};

use crate::view::command_table::{Entry, Reach, command_table};
use crate::view::focus::was_focused;
use crate::view::{Command, State};

/// The commands of the keys pressed since the last frame.
pub fn pressed(ctx: &Context, state: &State) -> Vec<Command> {
    let focused = ctx.memory(|memory| memory.focused().is_some());
    let is_key = |event: &Event| matches!(event, Event::Key { pressed: true, .. });
    if !ctx.input(|input| input.events.iter().any(is_key)) {
        return Vec::new();
    }
    let has_no_focus = !focused && !ctx.egui_wants_keyboard_input();
    let is_free = has_no_focus && state.forms.shown.is_none() && !Popup::is_any_open(ctx);
    // Escape has taken the focus away by now: where there was one, the key was the field's.
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
    // The keys of a shortcut without Shift or Alt are also those of one with them: the one that asks for more goes first.
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

/// Hands on what was typed and clicked in the order in which it was.
///
/// Where a frame takes long, "3", Tab and "4" arrive with one frame, in which only one field has the focus. Whatever moves the
/// focus therefore comes in a frame of its own, and what was typed after it in a later one. After Tab one frame more goes by: what
/// gets the focus backwards knows of it in the next frame only, and chooses its text, to be replaced, at the end of that.
#[derive(Default)]
pub(super) struct KeyOrder {
    /// What comes with later frames.
    later: Vec<Event>,
    /// Whether the frame before moved the focus by Tab.
    has_moved: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Text, and keys that leave the focus where it is.
    Typing,
    /// A key that may move the focus.
    Moving,
    /// A button of the pointer, which may move the focus too.
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

    /// Whether `next` may come with the same frame. Clicks may: two of them are a double click by their times.
    fn goes_with(self, next: Self) -> bool {
        self == next && self != Self::Moving
    }
}

/// Not the arrows, though they go from one cell to the next: one that is held comes more often than slow frames do.
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

/// How many of the events come with one frame.
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

    /// How many events each frame gets.
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
