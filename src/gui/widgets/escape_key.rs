//! Escape closes what is in front, such as a drawer, unless a focused control has used the key.
//!
//! egui removes the focus at the beginning of the frame in which Escape is pressed, so whether the
//! key was meant for a control follows from the focus in the last frame.

use egui::{Context, Id, Key, Modifiers};

/// Records whether a control has the focus; called after everything else in a frame is drawn.
pub fn note_focus(ctx: &Context) {
    let is_focused = ctx.memory(|memory| memory.focused().is_some());
    ctx.data_mut(|data| data.insert_temp(had_focus(), is_focused));
}

/// Key in egui's memory under which [`note_focus`] stores whether a control has the focus.
fn had_focus() -> Id {
    Id::unique("had anything the focus")
}

/// Returns whether a control had the focus at the end of the last frame. If Escape is pressed in
/// this frame, it belonged to that control, whose focus egui has already removed.
pub fn was_focused(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp(had_focus()).unwrap_or(false))
}

/// Consumes Escape and returns whether it was pressed; leaves the key, and returns false, if a
/// focused control has used it.
pub fn take_escape(ctx: &Context) -> bool {
    !was_focused(ctx) && ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
}
