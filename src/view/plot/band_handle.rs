//! The two ends of the band of comparison, to be dragged with the mouse.

use crate::view::plot::LogAxis;
use egui::{Align2, CursorIcon, Rect, Response, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};
use egui_plot::PlotTransform;

use super::axes::caption_font;
use super::log_axis::FrequencyUnit;
use crate::view::palette::Palette;

/// Half the width of the strip that takes hold of an end \[pt\].
const GRAB_RADIUS: f32 = 4.0;
/// Least ratio of the ends: a band is never empty.
const LEAST_RATIO: f64 = 1.05;

/// What dragging did to the band in this frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BandChange {
    /// An end is being dragged: the band is to be this \[rad/s\].
    Dragged {
        /// Lower end.
        min: f64,
        /// Upper end.
        max: f64,
    },
    /// The end was let go.
    Released,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    Lower,
    Upper,
}

impl End {
    fn of(self, band: (f64, f64)) -> f64 {
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

    /// The band with this end at `omega`, as far as the other end lets it.
    fn moved(self, band: (f64, f64), omega: f64) -> (f64, f64) {
        match self {
            Self::Lower => (omega.min(band.1 / LEAST_RATIO), band.1),
            Self::Upper => (band.0, omega.max(band.0 * LEAST_RATIO)),
        }
    }
}

/// Draws both ends of `band` over a plot and lets them be dragged. `place` tells the panes apart.
pub(super) fn band_handles_ui(
    ui: &Ui,
    place: &str,
    band: (f64, f64),
    transform: &PlotTransform,
    unit: FrequencyUnit,
    palette: &Palette,
) -> Option<BandChange> {
    let mut change = None;
    for end in [End::Lower, End::Upper] {
        let x = transform.position_from_point_x(end.of(band).log10());
        let frame = *transform.frame();
        if !x.is_finite() || !frame.x_range().contains(x) {
            continue;
        }
        let strip = Rect::from_x_y_ranges(x - GRAB_RADIUS..=x + GRAB_RADIUS, frame.y_range()).intersect(frame);
        let response = ui.interact(strip, ui.scope_id().with((place, end.name())), Sense::drag());
        let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        response
            .widget_info(|| WidgetInfo::slider(true, unit.of_omega(end.of(band)), format!("{}, {place}", end.name())));
        paint(ui, x, end, band, &response, (frame, unit, palette));
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let x = pointer.x.clamp(frame.left(), frame.right());
            let omega = 10f64.powf(transform.value_from_position(pos2(x, frame.center().y)).x);
            let (min, max) = end.moved(band, omega);
            change = Some(BandChange::Dragged { min, max });
        } else if response.drag_stopped() {
            change = Some(BandChange::Released);
        }
    }
    change
}

fn paint(
    ui: &Ui,
    x: f32,
    end: End,
    band: (f64, f64),
    response: &Response,
    (frame, unit, palette): (Rect, FrequencyUnit, &Palette),
) {
    let is_held = response.hovered() || response.dragged();
    let painter = ui.painter().with_clip_rect(frame);
    let stroke =
        if is_held { Stroke::new(2.0, palette.accent) } else { Stroke::new(1.0, palette.accent.gamma_multiply(0.65)) };
    painter.vline(x, frame.y_range(), stroke);
    if !is_held {
        return;
    }
    let text = unit.readout(end.of(band));
    let galley = painter.layout_no_wrap(text, caption_font(), palette.text);
    // Inside the band, level with the pointer.
    let pointer = response.interact_pointer_pos().or(response.hover_pos());
    let y = pointer.map_or(frame.center().y, |pointer| pointer.y).clamp(frame.top() + 12.0, frame.bottom() - 12.0);
    let (align, offset) = match end {
        End::Lower => (Align2::LEFT_CENTER, 8.0),
        End::Upper => (Align2::RIGHT_CENTER, -8.0),
    };
    let place = align.anchor_size(pos2(x + offset, y), galley.size() + vec2(10.0, 4.0));
    painter.rect(place, 3.0, palette.raised, Stroke::new(1.0, palette.line), StrokeKind::Inside);
    painter.galley(place.min + vec2(5.0, 2.0), galley, palette.text);
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
