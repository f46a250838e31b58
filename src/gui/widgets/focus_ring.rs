//! Focus ring: marks the control that has the keyboard focus.

use egui::{Context, Stroke, StrokeKind};

use super::palette::Palette;

/// Ring width \[pt\].
const RING_WIDTH: f32 = 2.0;

/// Gap between the ring and its control \[pt\].
const RING_GAP: f32 = 1.0;

/// Draws the ring around the focused control, be it a button, a list row, a cell or a plot. Called
/// last in a frame, it draws above the other content.
pub fn focus_ring_ui(ctx: &Context, palette: &Palette) {
    let focused = ctx.memory(|memory| memory.focused());
    let Some(focused) = focused.and_then(|id| ctx.read_response(id)) else {
        return;
    };
    let in_view = focused.interact_rect;
    if !in_view.is_positive() {
        return;
    }
    let painter = ctx
        .layer_painter(focused.layer_id)
        .with_clip_rect(in_view.expand(RING_GAP + RING_WIDTH));
    painter.rect_stroke(
        focused.rect.expand(RING_GAP),
        3.0,
        Stroke::new(RING_WIDTH, palette.accent),
        StrokeKind::Outside,
    );
}

#[cfg(test)]
mod tests {
    use egui::Color32;

    use super::*;

    /// Computes the relative luminance defined by the Web Content Accessibility Guidelines 2.2.
    fn luminance(color: Color32) -> f32 {
        let [r, g, b, _] = egui::Rgba::from(color).to_array();
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn the_ring_stands_out_from_every_surface_by_three_to_one() {
        for palette in [Palette::dark(), Palette::light()] {
            let ring = luminance(palette.accent);
            for surface in [
                palette.background,
                palette.panel,
                palette.raised,
                palette.selected,
            ] {
                let surface = luminance(surface);
                let contrast = (ring.max(surface) + 0.05) / (ring.min(surface) + 0.05);
                assert!(contrast >= 3.0, "{contrast} in {palette:?}");
            }
        }
    }
}
