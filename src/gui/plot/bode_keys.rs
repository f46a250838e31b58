//! Keys for a focused Bode plot: they pan, zoom and fit a pane, and switch roles.

use egui::{EventFilter, Key, Modifiers, Response, Ui, vec2};

use super::bode_scene::BodeScene;
use super::bode_view::BodeView;
use super::chips::role_chips;
use super::curve_command::CurveCommand;
use super::drawn_curves::Pane;
use crate::gui::widgets::palette::Palette;

/// Pan step for an arrow key, as a share of the visible range.
const STEP: f32 = 0.1;
/// Zoom factor for a press of the + key; its inverse for the − key.
const CLOSER: f64 = 1.25;

/// Handles the keys if the pane has the focus: arrows pan, + and − zoom (with Shift only the
/// frequencies), Home fits both panes. Escape leaves the plot, by egui itself.
pub(super) fn handle_keys(ui: &Ui, pane: Pane, response: &Response, view: &mut BodeView) {
    if !response.has_focus() {
        return;
    }
    let arrows = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    let Some(frame) = view.frame(pane) else {
        return;
    };
    let is_shifted = ui.input(|input| input.modifiers.shift);
    // The view moves where the arrow points, the drawing in the opposite direction.
    let along = presses(ui, Key::ArrowRight) - presses(ui, Key::ArrowLeft);
    let up = presses(ui, Key::ArrowUp) - presses(ui, Key::ArrowDown);
    let closer = presses(ui, Key::Plus) + presses(ui, Key::Equals) - presses(ui, Key::Minus);
    let is_fitted = presses(ui, Key::Home) > 0.0;
    if along != 0.0 || up != 0.0 {
        let by = STEP * vec2(-along * frame.width(), up * frame.height());
        view.pan(pane, by);
    }
    if closer != 0.0 {
        let factor = CLOSER.powf(f64::from(closer));
        let value_factor = if is_shifted { 1.0 } else { factor };
        view.zoom(pane, frame.center(), factor, value_factor);
    }
    if is_fitted {
        view.request_fit();
    }
    if along != 0.0 || up != 0.0 || closer != 0.0 || is_fitted {
        ui.ctx().request_repaint();
    }
}

/// Removes a key's presses from the input and returns their number.
fn presses(ui: &Ui, key: Key) -> f32 {
    ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key)) as f32
}

/// Returns the request for a pressed digit, which toggles the role chip with this number.
pub(super) fn pressed_role(
    ui: &Ui,
    scene: &BodeScene<'_>,
    palette: &Palette,
) -> Option<CurveCommand> {
    let digit = pressed_digit(ui)?;
    let chips = role_chips(scene.curves, scene.hidden_roles, palette);
    let chip = chips.get(digit - 1)?;
    Some(CurveCommand::ToggleRole(chip.role))
}

/// Removes a pressed digit from 1 to 9 from the input and returns it.
fn pressed_digit(ui: &Ui) -> Option<usize> {
    const DIGITS: [Key; 9] = [
        Key::Num1,
        Key::Num2,
        Key::Num3,
        Key::Num4,
        Key::Num5,
        Key::Num6,
        Key::Num7,
        Key::Num8,
        Key::Num9,
    ];
    for (index, key) in DIGITS.into_iter().enumerate() {
        if ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)) {
            return Some(index + 1);
        }
    }
    None
}
