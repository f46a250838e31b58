//! Draggable ends of the comparison band, the frequencies over which models are compared. An end is
//! a vertical line over each pane.
//!
//! ```text
//! 1. clamp the pointer to the frame, and convert its position to a frequency
//! 2. round it to three significant digits in the displayed unit (`FrequencyUnit::rounded_omega`),
//!    so that the displayed number is exactly the value
//! 3. limit it by the other end (`LEAST_RATIO`)
//! 4. report the new band as an event; the caller changes the band, and the end moves
//! ```

use egui::{CursorIcon, Rect, Response, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};

use gdcm_plot::figure::axis::FrequencyUnit;

use super::bode_event::BodeEvent;
use super::bode_view::BodeView;
use super::pane_scene::PaneScene;
use super::panel_text::caption_font;
use crate::gui::widgets::palette::Palette;

/// Half-width of the strip in which an end can be grabbed \[pt\].
const GRAB_RADIUS: f32 = 4.0;
/// Minimum ratio of upper to lower end, so that the band is never empty.
const LEAST_RATIO: f64 = 1.05;

#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    Lower,
    Upper,
}

impl End {
    /// Returns this end's frequency \[rad/s\].
    fn omega(self, band: (f64, f64)) -> f64 {
        match self {
            Self::Lower => band.0,
            Self::Upper => band.1,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Lower => "Lower end of the band",
            Self::Upper => "Upper end of the band",
        }
    }

    /// Returns the band with this end at `omega`, limited by the other end.
    fn moved(self, band: (f64, f64), omega: f64) -> (f64, f64) {
        match self {
            Self::Lower => (omega.min(band.1 / LEAST_RATIO), band.1),
            Self::Upper => (band.0, omega.max(band.0 * LEAST_RATIO)),
        }
    }
}

/// Draws the visible band ends over a pane and makes them draggable; returns the event of a drag.
pub(super) fn band_handles_ui(ui: &Ui, pane: PaneScene<'_>, view: &BodeView) -> Option<BodeEvent> {
    let PaneScene {
        pane,
        scene,
        palette,
        ..
    } = pane;
    let transform = view.transform(pane)?;
    let frame = *transform.frame();
    let plot = scene.quantity.name_in_sentence(pane);
    let mut change = None;
    for end in [End::Lower, End::Upper] {
        let omega = end.omega(scene.band);
        let x = transform.position_from_point_x(omega.log10());
        if !x.is_finite() || !frame.x_range().contains(x) {
            continue;
        }
        let strip = Rect::from_x_y_ranges(x - GRAB_RADIUS..=x + GRAB_RADIUS, frame.y_range())
            .intersect(frame);
        let id = ui.scope_id().with((plot.as_str(), end.name()));
        let response = ui
            .interact(strip, id, Sense::drag())
            .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        response.widget_info(|| {
            let name = format!("{}, {plot}", end.name());
            WidgetInfo::slider(true, scene.unit.of_omega(omega), name)
        });
        let handle = Handle { x, omega, frame };
        handle.paint(ui, is_held(&response), scene.unit, palette);
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            // Step 1.
            let x = pointer.x.clamp(frame.left(), frame.right());
            let at = transform.value_from_position(pos2(x, frame.center().y));
            // Step 2.
            let omega = scene.unit.rounded_omega(10f64.powf(at.x));
            // Steps 3 and 4.
            let (min, max) = end.moved(scene.band, omega);
            change = Some(BodeEvent::BandDragged { min, max });
        } else if response.drag_stopped() {
            change = Some(BodeEvent::BandReleased);
        }
    }
    change
}

fn is_held(response: &Response) -> bool {
    response.hovered() || response.dragged()
}

/// Band end on the screen.
struct Handle {
    x: f32,
    /// Frequency \[rad/s\].
    omega: f64,
    frame: Rect,
}

impl Handle {
    /// Paints the end, and its frequency above the plot while the pointer is on it or drags it.
    fn paint(&self, ui: &Ui, is_held: bool, unit: FrequencyUnit, palette: &Palette) {
        let stroke = if is_held {
            Stroke::new(2.0, palette.accent)
        } else {
            Stroke::new(1.0, palette.accent.gamma_multiply(0.65))
        };
        ui.painter()
            .with_clip_rect(self.frame)
            .vline(self.x, self.frame.y_range(), stroke);
        if is_held {
            self.paint_frequency(ui, unit, palette);
        }
    }

    /// Paints the frequency above the plot, where it does not cover the curves.
    fn paint_frequency(&self, ui: &Ui, unit: FrequencyUnit, palette: &Palette) {
        let painter = ui.painter();
        let text = unit.readout(self.omega);
        let galley = painter.layout_no_wrap(text, caption_font(), palette.text);
        let size = galley.size() + vec2(10.0, 2.0);
        let first = self.frame.left();
        let last = (self.frame.right() - size.x).max(first);
        let left = (self.x - 0.5 * size.x).clamp(first, last);
        let corner = pos2(left, self.frame.top() - size.y - 2.0);
        let line = Stroke::new(1.0, palette.line);
        painter.rect(
            Rect::from_min_size(corner, size),
            3.0,
            palette.raised,
            line,
            StrokeKind::Inside,
        );
        painter.galley(corner + vec2(5.0, 1.0), galley, palette.text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_never_passes_the_other() {
        assert_eq!(End::Lower.moved((0.5, 12.0), 2.0), (2.0, 12.0));
        assert_eq!(End::Upper.moved((0.5, 12.0), 2.0), (0.5, 2.0));
        let (min, max) = End::Lower.moved((0.5, 12.0), 40.0);
        assert!(min < max);
        let (min, max) = End::Upper.moved((0.5, 12.0), 0.1);
        assert!(min < max);
    }
}
