//! Zooming and panning in a figure's panel, within limits.

use egui::Response;
use egui_plot::PlotTransform;

use gdcm_plot::figure::axis::Scale;
use gdcm_plot::figure::figure::Along;
use gdcm_plot::figure::{Panel, Range};

use super::viewed_range::ranges_of;
use super::zoom_gesture::ZoomGesture;
use super::zoom_limit::{ZoomLimit, zoomed_within};

/// Maximum visible range, relative to the panel's full range.
const FARTHEST: f64 = 10.0;
/// Minimum visible range, in axis coordinates: far finer than the values of a figure are known.
const LEAST_WIDTH: f64 = 1e-4;

/// Returns the visible ranges after this frame's gestures: the wheel zooms about the pointer.
/// Dragging has panned the bounds of `transform` already, which egui_plot does itself. `None` if a
/// range is not finite.
pub(super) fn navigated_ranges(
    panel: &Panel,
    response: &Response,
    transform: &PlotTransform,
) -> Option<[Range; 2]> {
    let whole = whole_ranges(panel);
    let limits = zoom_limits(panel);
    let mut shown = ranges_of(transform.bounds());
    if let Some(gesture) = ZoomGesture::find(&response.ctx, response) {
        let factor = gesture.along_one_axis();
        let fixed = transform.value_from_position(gesture.pointer);
        for (axis, fixed) in [fixed.x, fixed.y].into_iter().enumerate() {
            let limit = limits[axis].range(whole[axis]);
            // If there is no zoomed range, the axis was dragged beyond the limit; it then keeps its
            // range.
            if let Some(zoomed) = zoomed_within(shown[axis], factor, fixed, limit) {
                shown[axis] = zoomed;
            }
        }
        response.ctx.request_repaint();
    }
    let widths = whole.map(|whole| Range::new(LEAST_WIDTH, FARTHEST * whole.width()));
    let x = shown[0].limited(widths[0])?;
    let y = shown[1].limited(widths[1])?;
    Some([x, y])
}

/// Returns the limits for zooming out: the data range along a time axis, which is recognised by its
/// unit; a decade beyond the data range along a logarithmic axis; ten times the data range
/// otherwise.
fn zoom_limits(panel: &Panel) -> [ZoomLimit; 2] {
    let widths = ZoomLimit::TenWidths { least: LEAST_WIDTH };
    let across = match panel.x.scale {
        Scale::Logarithmic => ZoomLimit::Decade,
        Scale::Linear | Scale::Degrees if panel.x.label.ends_with("[s]") => ZoomLimit::Data,
        Scale::Linear | Scale::Degrees => widths,
    };
    [across, widths]
}

/// Returns a panel's full ranges in axis coordinates, which are logarithms on a logarithmic
/// horizontal axis.
pub(super) fn whole_ranges(panel: &Panel) -> [Range; 2] {
    let x = panel.shown(Along::X);
    let y = panel.shown(Along::Y);
    match panel.x.scale {
        Scale::Logarithmic => [Range::new(x.min.log10(), x.max.log10()), y],
        Scale::Linear | Scale::Degrees => [x, y],
    }
}
