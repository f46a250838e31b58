//! Order between typed text and focus changes: text reaches the intended field even if frames are
//! slow.

use egui::{Context, Event, Key, Plugin, RawInput};

/// Forwards keyboard and pointer events in their original order.
///
/// If a frame takes long, "3", Tab and "4" arrive in the same frame, in which a single field has
/// the focus. Therefore a key that moves the focus gets its own frame, clicks share a frame only
/// with clicks, and text typed after either goes to a later frame. After Tab another frame passes:
/// a widget that receives the focus by Shift+Tab is informed only in the next frame, and selects
/// its text, to be replaced, when that frame ends.
#[derive(Default)]
pub(super) struct KeyOrder {
    /// Events for later frames.
    later: Vec<Event>,
    /// Whether Tab moved the focus in the previous frame.
    has_moved: bool,
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
            count_of_frame(&self.later)
        };
        let rest = self.later.split_off(count);
        input.events = std::mem::replace(&mut self.later, rest);
        self.has_moved = input.events.iter().any(is_tab);
        if !self.later.is_empty() {
            ctx.request_repaint();
        }
    }
}

/// Kind of an event whose order matters.
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
    /// Returns an event's kind; `None` for events that may be handled in any frame.
    fn from_event(event: &Event) -> Option<Self> {
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

    /// Returns whether `next` may be in the same frame. Clicks may, because a double click is
    /// recognised by its event times.
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

/// Counts the leading events that belong in the same frame.
fn count_of_frame(events: &[Event]) -> usize {
    let mut before: Option<Kind> = None;
    for (count, event) in events.iter().enumerate() {
        let Some(kind) = Kind::from_event(event) else {
            continue;
        };
        if let Some(before) = before
            && !before.goes_with(kind)
        {
            return count;
        }
        before = Some(kind);
    }
    events.len()
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

    /// Splits events into frames and returns the number of events in each.
    fn frames(mut events: Vec<Event>) -> Vec<usize> {
        let mut counts = Vec::new();
        while !events.is_empty() {
            counts.push(count_of_frame(&events));
            events.drain(..count_of_frame(&events));
        }
        counts
    }

    #[test]
    fn an_event_that_moves_the_focus_has_its_own_frame() {
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
    fn the_clicks_of_a_double_click_and_movements_stay_together() {
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
