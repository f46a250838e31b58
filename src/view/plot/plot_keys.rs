//! What the keyboard asks of the plot that has the focus.

use egui::{EventFilter, Key, Modifiers, Response, Ui, vec2};

use super::bode_view::BodeView;
use super::curve::Pane;

/// Part of what is in view that an arrow moves it by.
const STEP: f32 = 0.1;
/// How much closer + looks.
const CLOSER: f64 = 1.25;

/// Arrows pan a pane that has the focus, + and − zoom it (with Shift only its frequencies), Home fits the plot. Escape leaves it.
pub(super) fn plot_keys(ui: &Ui, pane: Pane, response: &Response, view: &mut BodeView) {
    if !response.has_focus() {
        return;
    }
    let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    let Some(frame) = view.transform(pane).map(|transform| *transform.frame()) else { return };
    let shift = ui.input(|input| input.modifiers.shift);
    let pressed = |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key)) as f32;
    // The view moves where the arrow points: what is drawn moves the other way.
    let along = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
    let up = pressed(Key::ArrowUp) - pressed(Key::ArrowDown);
    let closer = pressed(Key::Plus) + pressed(Key::Equals) - pressed(Key::Minus);
    let is_fitted = pressed(Key::Home) > 0.0;
    if along != 0.0 || up != 0.0 {
        view.pan(pane, STEP * vec2(-along * frame.width(), up * frame.height()));
    }
    if closer != 0.0 {
        let factor = CLOSER.powf(f64::from(closer));
        view.zoom(pane, frame.center(), factor, if shift { 1.0 } else { factor });
    }
    if is_fitted {
        view.request_fit();
    }
    if along != 0.0 || up != 0.0 || closer != 0.0 || is_fitted {
        ui.ctx().request_repaint();
    }
}
