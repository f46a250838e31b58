//! Bode pane: layers from bottom to top, and gestures.
//!
//! A pane is the magnitude or the phase plot; `BodeView` keeps its visible ranges and what was last
//! drawn. The comparison band is the range of frequencies over which models are compared.

use egui::{Color32, PointerButton, Rect, Response, Stroke, Ui, vec2};
use egui_plot::{PlotBounds, PlotTransform, PlotUi};

use gdcm_model::number_format::counted;
use gdcm_plot::figure::responses::BodeBand;

use super::axis_strip::axis_strips_ui;
use super::bode_keys::handle_keys;
use super::bode_layout::VALUE_AXIS_WIDTH;
use super::bode_scene::BodeScene;
use super::bode_view::{BodeView, SelectionBox};
use super::cached_raster::RasterImage;
use super::curve_layer::{STALE, add_curve_lines, lies_at_the_bottom};
use super::drawn_box::drawn_box_ui;
use super::drawn_curves::{BodeCurve, DrawnCurves, Pane, VisiblePart};
use super::drawn_pane::DrawnPane;
use super::invalid_region::{InvalidStrip, add_hatching};
use super::layers::{DrawnItem, add_area, add_dotted_vertical, add_shade, add_vertical};
use super::pane_scene::PaneScene;
use super::panel_axis::{PanelAxis, TICKS_HEIGHT};
use super::panel_painter::{Gestures, PanelPainter};
use super::reference_lines::PaneLines;
use super::ticks::Ticks;
use super::zoom_gesture::ZoomGesture;
use crate::gui::widgets::palette::Palette;

/// Maximum deviation between a drawn line and its curve \[pt\].
const TOLERANCE: f64 = 0.1;
/// Minimum number of labels on a value axis, where they fit.
const LEAST_LABELS: usize = 5;
/// Height of the marks along the lower edge, at the noticed ranges \[pt\].
const NOTICED_HEIGHT: f32 = 5.0;
/// Opacity of the comparison band's shade in the dark theme.
const COMPARISON_SHADE_DARK: f32 = 0.055;
/// Opacity of the comparison band's shade in the light theme.
const COMPARISON_SHADE_LIGHT: f32 = 0.075;
/// Opacity of the veil outside the comparison band.
const VEIL: f32 = 0.4;
/// Opacity of an area between two curves, such as an uncertainty band.
const AREA_FILL: f32 = 0.22;
/// Opacity of the lines at marked frequencies.
const MARKED: f32 = 0.7;
/// Opacity of the line at the frequency under the pointer.
const POINTED: f32 = 0.55;

/// Draws a pane, and pans and zooms it with the pointer and the keys:
///
/// 1. draw the panel with its layers ([`PaneScene::add_layers`]);
/// 2. handle dragging, wheel, keys, and gestures on the axes; they take effect in the next frame;
/// 3. paint over the frame: reference lines, the ranges at which a pilot would notice the error,
///    and above the magnitudes the strip where the corrected model is not valid.
pub(super) fn pane_ui(ui: &mut Ui, pane: PaneScene<'_>, view: &mut BodeView) -> Response {
    let scene = pane.scene;
    let name = scene.quantity.name(pane.pane);
    let description = format!(
        "{name} of {}, {}",
        scene.pair_title,
        counted(scene.curves.len(), "curve")
    );
    // Step 1.
    let values = scene.quantity.unit(pane.pane).ticks();
    let panel = PanelPainter {
        id: ui.make_persistent_id(&name),
        rect: pane.rect,
        name: &description,
        across: PanelAxis {
            // The frequency axis is drawn once, below both panes.
            is_drawn: pane.pane == Pane::Phase,
            ..PanelAxis::new(Ticks::Frequency(scene.unit), TICKS_HEIGHT)
        },
        values: PanelAxis {
            least_labels: LEAST_LABELS,
            ..PanelAxis::new(values, VALUE_AXIS_WIDTH)
        },
        gestures: Gestures::Reported,
        is_transparent: true,
        palette: pane.palette,
    };
    // The content borrows the cached lines, so they are taken out of the view while the panel is
    // drawn, and put back at the end.
    let bounds = view.bounds(pane.pane);
    let mut drawn = std::mem::take(&mut view.drawn[pane.pane as usize]);
    let cached = &mut drawn;
    let shown = panel.show(ui, move |plot| pane.add_layers(plot, bounds, cached));
    drawn.transform = Some(shown.transform);
    view.drawn[pane.pane as usize] = drawn;
    // Step 2.
    handle_drag(ui, pane, &shown.response, view);
    zoom_by_scrolling(pane.pane, &shown.response, view);
    handle_keys(ui, pane.pane, &shown.response, view);
    axis_strips_ui(ui, pane, view);
    // Step 3.
    let lines = PaneLines {
        lines: scene.reference_lines,
        pane: pane.pane,
        transform: &shown.transform,
    };
    lines.paint(ui, pane.palette);
    paint_noticed_ranges(ui, scene, &shown.transform, pane.palette);
    if let (Pane::Magnitude, Some(invalid)) = (pane.pane, scene.invalid) {
        let strip = InvalidStrip {
            band_end: scene.band.1,
            invalid,
            transform: &shown.transform,
        };
        strip.paint(ui, pane.palette);
    }
    shown.response
}

/// Handles dragging: the primary button pans, or with Shift draws a box that selects curves; the
/// secondary button draws a box to zoom into.
fn handle_drag(ui: &Ui, scene: PaneScene<'_>, response: &Response, view: &mut BodeView) {
    let PaneScene { pane, palette, .. } = scene;
    let Some(frame) = view.frame(pane) else {
        return;
    };
    if response.drag_started_by(PointerButton::Primary) {
        view.is_selecting = ui.input(|input| input.modifiers.shift);
    }
    if view.is_selecting {
        if let Some(area) = drawn_box_ui(ui, response, frame, PointerButton::Primary, palette) {
            view.selection = Some(SelectionBox { pane, area });
        }
    } else if response.dragged_by(PointerButton::Primary) {
        view.pan(pane, response.drag_delta());
        ui.ctx().request_repaint();
    }
    if let Some(area) = drawn_box_ui(ui, response, frame, PointerButton::Secondary, palette) {
        view.zoom_to(pane, area);
        ui.ctx().request_repaint();
    }
}

/// Zooms about the pointer by wheel and pinching; the sideways wheel zooms the frequency axis only.
fn zoom_by_scrolling(pane: Pane, response: &Response, view: &mut BodeView) {
    if let Some(gesture) = ZoomGesture::find(&response.ctx, response) {
        view.zoom(pane, gesture.pointer, gesture.across(), gesture.upward());
        response.ctx.request_repaint();
    }
}

/// Marks the frequency ranges at which a pilot would notice the remaining error, along the lower
/// edge.
fn paint_noticed_ranges(
    ui: &Ui,
    scene: &BodeScene<'_>,
    transform: &PlotTransform,
    palette: &Palette,
) {
    let frame = *transform.frame();
    let painter = ui.painter().with_clip_rect(frame);
    let top = frame.bottom() - NOTICED_HEIGHT;
    for (from, to) in scene.noticed_ranges {
        let [left, right] = [from, to].map(|omega| transform.position_from_point_x(omega.log10()));
        let mark = Rect::from_x_y_ranges(left..=right, top..=frame.bottom());
        painter.rect_filled(mark.shrink2(vec2(0.0, 1.0)), 0.0, palette.warning);
    }
}

impl<'a> PaneScene<'a> {
    /// Adds the layers to a panel with these `bounds`, from bottom to top:
    ///
    /// 1. shade over the comparison band, and hatching where the corrected model is not valid;
    /// 2. areas between two curves: uncertainty bands unless switched off, remaining phase error,
    ///    range of the conditions' optima;
    /// 3. curves, if many partly as an image;
    /// 4. veil outside the comparison band;
    /// 5. lines at the marked frequencies, at those of the bandwidth, and at the cursor.
    fn add_layers(self, plot: &mut PlotUi<'a>, bounds: PlotBounds, drawn: &'a mut DrawnPane) {
        let scene = self.scene;
        plot.set_plot_bounds(bounds);
        // Step 1.
        self.shade_comparison_band(plot);
        if scene.invalid.is_some() {
            add_hatching(plot, scene.band.1, self.palette);
        }
        // Step 2 draws only what `bounds` show; the panel's own transform still has the bounds of
        // the last frame.
        let transform = PlotTransform::new(*plot.transform().frame(), bounds, false);
        let visible = VisiblePart::new(&transform, plot.ctx().pixels_per_point(), TOLERANCE);
        drawn
            .curves
            .update(scene.curves, self.pane, visible, self.palette);
        if scene.shows_uncertainty != Some(false) {
            for uncertainty in scene.uncertainty_bands {
                self.add_area_between(plot, uncertainty, &bounds, self.palette.identified);
            }
        }
        if let Some(remaining) = scene.remaining_phase {
            self.add_area_between(plot, remaining, &bounds, self.palette.identified);
        }
        if let Some(optima) = scene.optima_range {
            self.add_area_between(plot, optima, &bounds, self.palette.corrected);
        }
        // Step 3.
        let image = drawn.image_of_many(
            plot.ctx(),
            scene.curves,
            &transform,
            self.looks,
            self.palette,
        );
        self.add_curves(plot, &drawn.curves, image);
        // Steps 4 and 5.
        self.veil_outside(plot);
        self.add_cursors(plot);
    }

    fn shade_comparison_band(self, plot: &mut PlotUi<'_>) {
        let strength = if self.palette.is_dark {
            COMPARISON_SHADE_DARK
        } else {
            COMPARISON_SHADE_LIGHT
        };
        let (min, max) = self.scene.band;
        let fill = self.palette.accent.gamma_multiply(strength);
        add_shade(plot, min.log10()..=max.log10(), fill);
    }

    /// Dims the frequencies outside the comparison band, which do not count.
    fn veil_outside(self, plot: &mut PlotUi<'_>) {
        let veil = self.palette.background.gamma_multiply(VEIL);
        let (min, max) = self.scene.band;
        add_shade(plot, f64::NEG_INFINITY..=min.log10(), veil);
        add_shade(plot, max.log10()..=f64::INFINITY, veil);
    }

    /// Fills the visible part of the area between two curves, in segments; non-finite values, as at
    /// the jumps of a wrapped phase, leave a gap.
    fn add_area_between(
        self,
        plot: &mut PlotUi<'_>,
        area: &BodeBand,
        view: &PlotBounds,
        color: Color32,
    ) {
        let values = match self.pane {
            Pane::Magnitude => &area.magnitude_db,
            Pane::Phase => &area.phase_deg,
        };
        let mut points = Vec::with_capacity(values.len());
        for (omega, [lower, upper]) in area.omega.iter().zip(values) {
            points.push([omega.log10(), *lower, *upper]);
        }
        let fill = color.gamma_multiply(AREA_FILL);
        for run in points.chunk_by(|from, to| is_in_view(from, to, view)) {
            if run.len() > 1 {
                add_area(plot, run, fill);
            }
        }
    }

    /// Draws the curves, the most important on top. If `image` holds the curves at the bottom, it
    /// is drawn instead of their lines; the emphasized curves among them are drawn on top as lines.
    fn add_curves(self, plot: &mut PlotUi<'a>, drawn: &'a DrawnCurves, image: Option<RasterImage>) {
        let looks = self.looks;
        let mut curves: Vec<(usize, &BodeCurve)> = self.scene.curves.iter().enumerate().collect();
        if let Some(image) = image {
            let strength = if looks.is_stale { STALE } else { 1.0 };
            plot.add(DrawnItem::new(move |_, shapes| {
                shapes.push(image.shape(strength));
            }));
            curves.retain(|(_, curve)| !lies_at_the_bottom(curve) || looks.is_emphasized(curve));
        }
        looks.sort(&mut curves);
        for (index, curve) in curves {
            let style = looks.style(curve, self.palette);
            plot.add(DrawnItem::new(move |transform, shapes| {
                add_curve_lines(drawn.runs(index), style, transform, shapes);
            }));
        }
    }

    /// Draws lines at the marked frequencies and at those of the bandwidth, and a dotted line at
    /// the cursor.
    fn add_cursors(self, plot: &mut PlotUi<'_>) {
        let scene = self.scene;
        let marked = Stroke::new(1.0, self.palette.text.gamma_multiply(MARKED));
        let crossings = scene.crossings.iter().map(|(_, omega)| omega);
        for omega in scene.pinned.iter().chain(crossings) {
            add_vertical(plot, omega.log10(), marked);
        }
        if let Some(log_omega) = self.cursor {
            let pointed = Stroke::new(0.8, self.palette.text.gamma_multiply(POINTED));
            add_dotted_vertical(plot, log_omega, pointed);
        }
    }
}

/// Returns whether any part of the area between two points `[log10 omega, lower, upper]` is
/// visible; false if a value is not finite.
fn is_in_view(from: &[f64; 3], to: &[f64; 3], view: &PlotBounds) -> bool {
    let [min_x, min_y] = view.min();
    let [max_x, max_y] = view.max();
    let is_finite = from.iter().chain(to).all(|value| value.is_finite());
    is_finite
        && to[0] >= min_x
        && from[0] <= max_x
        && from[2].max(to[2]) >= min_y
        && from[1].min(to[1]) <= max_y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_of_a_band_is_drawn_if_part_of_it_is_visible() {
        let view = PlotBounds::from_min_max([0.0, 0.0], [1.0, 10.0]);
        let is_seen = |from, to| is_in_view(&from, &to, &view);
        assert!(is_seen([0.2, 1.0, 2.0], [0.3, 1.0, 2.0]));
        assert!(
            is_seen([-1.0, -5.0, -3.0], [2.0, 12.0, 15.0]),
            "it may pass through"
        );
        assert!(
            !is_seen([-2.0, 1.0, 2.0], [-1.0, 1.0, 2.0])
                && !is_seen([2.0, 1.0, 2.0], [3.0, 1.0, 2.0])
        );
        assert!(
            !is_seen([0.2, 11.0, 12.0], [0.3, 11.0, 12.0])
                && !is_seen([0.2, -2.0, -1.0], [0.3, -2.0, -1.0])
        );
        assert!(
            !is_seen([0.2, f64::NAN, 2.0], [0.3, 1.0, 2.0]),
            "there is a gap"
        );
    }
}
