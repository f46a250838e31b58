//! The ring around what has the keyboard's focus.

use egui::{Context, Stroke, StrokeKind};

use super::palette::Palette;

/// Width of the ring \[pt\].
const WIDTH: f32 = 2.0;
/// Between the ring and what it surrounds \[pt\].
const GAP: f32 = 1.0;

/// Draws the ring over all that was drawn before: the same around every control, list row, cell and plot.
pub fn focus_ring_ui(ctx: &Context, palette: &Palette) {
    let Some(focused) = ctx.memory(|memory| memory.focused()).and_then(|id| ctx.read_response(id)) else { return };
    let in_view = focused.interact_rect;
    if !in_view.is_positive() {
        return;
    }
    let painter = ctx.layer_painter(focused.layer_id).with_clip_rect(in_view.expand(GAP + WIDTH));
    painter.rect_stroke(focused.rect.expand(GAP), 3.0, Stroke::new(WIDTH, palette.accent), StrokeKind::Outside);
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Color32;

    /// Relative luminance as the Web Content Accessibility Guidelines 2.2 define it.
    fn luminance(color: Color32) -> f32 {
        let [r, g, b, _] = egui::Rgba::from(color).to_array();
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn the_ring_stands_out_from_every_surface_by_three_to_one() {
        for palette in [Palette::dark(), Palette::light()] {
            let ring = luminance(palette.accent);
            for surface in [palette.background, palette.panel, palette.raised, palette.selected] {
                let surface = luminance(surface);
                let contrast = (ring.max(surface) + 0.05) / (ring.min(surface) + 0.05);
                assert!(contrast >= 3.0, "{contrast} in {palette:?}");
            }
        }
    }
}
