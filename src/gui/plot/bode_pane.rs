//! Pane of a Bode plot: axes, band, curves, labelled reference lines and cursor.

use egui::{
    Align2, Color32, Context, CursorIcon, FontId, Id, PointerButton, Rect, Response, Sense, Shape,
    Stroke, StrokeKind, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};
use egui_plot::{
    Axis, FilledArea, LineStyle, PlotBounds, PlotPoint, PlotTransform, PlotUi, Span, VLine,
};
pub use gdcm_plot::figure::responses::{BodeBand, Level, ReferenceKind, ReferenceLine};

use super::axes::{
    FrequencyUnit, TICKS_HEIGHT, Ticks, axis_hints, caption_font, keep_ground, quiet_plot,
};
use super::axis_strip::axis_strips_ui;
use super::bode::{BodeEvent, BodeScene, InvalidRegion};
use super::bode_view::{BodeView, DrawnPane};
use super::cached_raster::{CachedRaster, MANY, StillImage, StillScene};
use super::curve_style::Role;
use super::drawn_curves::{
    BodeCurve, CurveId, DrawnCurves, DrawnItem, Pane, curve_lines, pixel_of,
};
use super::navigation::{Turn, distance_to, drawn_box_ui, plot_keys, turned};
use crate::gui::widgets::controls::elided;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Width of the vertical axes \[pt\], equal in both panes so that the frequencies align.
pub(super) const VALUE_AXIS_WIDTH: f32 = 40.0;
/// Greatest distance of a drawn line from its curve \[pt\].
const TOLERANCE: f64 = 0.1;

/// Opacity of curves that are being recomputed.
const STALE: f32 = 0.5;

/// Transient elements of the panes in addition to the scene.
pub(super) struct Emphasis {
    /// Curve under the pointer.
    pub(super) curve: Option<CurveId>,
    /// `log10 omega` under the pointer, in either pane.
    pub(super) cursor: Option<f64>,
}

/// Draws a pane into `rect`, and pans and zooms it with the pointer.
pub(super) fn pane_ui(
    ui: &mut Ui,
    (pane, rect): (Pane, Rect),
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    emphasis: &Emphasis,
    palette: &Palette,
) -> Response {
    let name = scene.quantity.name(pane);
    let id = ui.make_persistent_id(&name);
    let builder = UiBuilder::new().id_salt(&name).max_rect(rect);
    let mut kept = std::mem::take(&mut view.drawn[pane as usize]);
    let DrawnPane {
        curves: drawn,
        image,
        ..
    } = &mut kept;
    let shown = ui.scope_builder(builder, |ui| {
        keep_ground(ui);
        let bounds = view.bounds(pane);
        pane_plot(id, pane, rect, scene, palette).show(ui, move |plot| {
            plot.set_plot_bounds(bounds);
            band_shade(plot, scene.band, palette);
            hatch(plot, scene, palette);
            let transform = PlotTransform::new(*plot.transform().frame(), bounds, false);
            let pixel = pixel_of(&transform, plot.ctx().pixels_per_point(), TOLERANCE);
            drawn.update(scene.curves, pane, (bounds, pixel), palette);
            let bands = scene
                .bands
                .iter()
                .filter(|_| scene.shows_bands != Some(false));
            bands
                .chain(scene.missing)
                .for_each(|band| draw_band(plot, band, pane, &bounds, palette));
            let image = image_of_many(plot.ctx(), scene, drawn, image, &transform, palette);
            draw_curves(plot, scene, drawn, image, emphasis, palette);
            outside_shade(plot, scene.band, palette);
            let marked = scene
                .pinned
                .iter()
                .chain(scene.crossings.iter().map(|(_, omega)| omega));
            draw_cursors(plot, marked, emphasis.cursor, palette);
        })
    });
    let shown = shown.inner;
    view.drawn[pane as usize] = DrawnPane {
        transform: Some(shown.transform),
        ..kept
    };
    drag(ui, pane, &shown.response, view, palette);
    zoom_by_scrolling(ui, pane, &shown.response, view);
    plot_keys(ui, pane, &shown.response, view);
    axis_strips_ui(ui, (pane, rect), scene, view, palette);
    rules_ui(ui, scene.rules, pane, &shown.transform, palette);
    strips_ui(ui, scene.strips, &shown.transform, palette);
    if let (Pane::Magnitude, Some(invalid)) = (pane, scene.invalid) {
        invalid_strip_ui(ui, (scene.band.1, invalid), &shown.transform, palette);
    }
    let description = format!(
        "{name} of {}, {} curves",
        scene.pair_title,
        scene.curves.len()
    );
    shown
        .response
        .widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, description.clone()));
    shown.response
}

/// Handles dragging: the primary button pans, with Shift it draws a box over curves; the secondary
/// button draws a box to zoom into.
fn drag(ui: &Ui, pane: Pane, response: &Response, view: &mut BodeView, palette: &Palette) {
    let Some(frame) = view.transform(pane).map(|transform| *transform.frame()) else {
        return;
    };
    if response.drag_started_by(PointerButton::Primary) {
        view.is_selecting = ui.input(|input| input.modifiers.shift);
    }
    if view.is_selecting {
        let area = drawn_box_ui(ui, response, frame, PointerButton::Primary, palette);
        view.selection = area.map(|area| (pane, area)).or(view.selection);
    } else if response.dragged_by(PointerButton::Primary) {
        view.pan(pane, response.drag_delta());
        ui.ctx().request_repaint();
    }
    if let Some(area) = drawn_box_ui(ui, response, frame, PointerButton::Secondary, palette) {
        view.zoom_to(pane, area);
        ui.ctx().request_repaint();
    }
}

fn pane_plot<'a>(
    id: Id,
    pane: Pane,
    rect: Rect,
    scene: &BodeScene<'_>,
    palette: &Palette,
) -> egui_plot::Plot<'a> {
    let unit = scene.unit;
    let frequencies = Ticks::Frequency(unit);
    // A single frequency axis, below both panes.
    let below = match pane {
        Pane::Magnitude => Vec::new(),
        Pane::Phase => vec![axis_hints(Axis::X, "", TICKS_HEIGHT, palette, frequencies)],
    };
    let values = scene.quantity.unit(pane).ticks();
    quiet_plot(id, palette)
        .width(rect.width())
        .height(rect.height())
        .x_grid_spacer(frequencies.spacer())
        .y_grid_spacer(values.spacer())
        .custom_x_axes(below)
        .custom_y_axes(vec![axis_hints(
            Axis::Y,
            "",
            VALUE_AXIS_WIDTH,
            palette,
            values,
        )])
}

fn band_shade(plot: &mut PlotUi<'_>, (min, max): (f64, f64), palette: &Palette) {
    let fill = palette
        .accent
        .gamma_multiply(if palette.is_dark { 0.055 } else { 0.075 });
    plot.span(
        Span::new("", min.log10()..=max.log10())
            .fill(fill)
            .border_width(0.0),
    );
}

/// Hatches the frequencies at which the model is invalid.
fn hatch(plot: &mut PlotUi<'_>, scene: &BodeScene<'_>, palette: &Palette) {
    /// Distance between two lines \[pt\].
    const STEP: f32 = 7.0;
    if scene.invalid.is_none() {
        return;
    }
    let from = scene.band.1.log10();
    let stroke = Stroke::new(1.0, palette.warning.gamma_multiply(0.14));
    plot.add(DrawnItem::new(move |transform, shapes| {
        let frame = *transform.frame();
        let left = transform
            .position_from_point(&PlotPoint::new(from, 0.0))
            .x
            .max(frame.left());
        let width = frame.right() - left;
        let height = frame.height();
        if width <= 0.0 {
            return;
        }
        for line in 1..=((width + height) / STEP) as usize {
            // A line descending to the left at 45 degrees, clipped to the region.
            let along = line as f32 * STEP;
            let top = along.min(width);
            let foot = (along - height).max(0.0);
            let point = |x: f32| pos2(left + x, frame.top() + along - x);
            shapes.push(Shape::line_segment([point(top), point(foot)], stroke));
        }
    }));
}

/// Draws a strip over the upper edge with the frequency above which the model is invalid, and the
/// increase of the magnitude by the leads.
fn invalid_strip_ui(
    ui: &Ui,
    (top, invalid): (f64, &InvalidRegion),
    transform: &PlotTransform,
    palette: &Palette,
) {
    let frame = *transform.frame();
    let at = |omega: f64, value: f64| {
        transform.position_from_point(&PlotPoint::new(omega.log10(), value))
    };
    let left = at(top, 0.0).x.max(frame.left());
    let strip = Rect::from_min_max(
        pos2(left, frame.top() + 1.0),
        pos2(frame.right() - 1.0, frame.top() + 17.0),
    );
    if strip.width() < 40.0 {
        return;
    }
    ui.painter().rect_filled(strip, 0.0, palette.warning_ground);
    let words = elided(ui, &invalid.words, strip.width() - 8.0, SMALL_SIZE);
    let font = FontId::proportional(SMALL_SIZE);
    ui.painter().text(
        strip.center(),
        Align2::CENTER_CENTER,
        words,
        font,
        palette.warning,
    );
    let Some([with, without]) = invalid.ends_db else {
        return;
    };
    let upper = at(invalid.up_to, with);
    let lower = at(invalid.up_to, without);
    if !frame.contains(upper - vec2(6.0, 0.0)) || !frame.contains(lower - vec2(6.0, 0.0)) {
        return;
    }
    let x = upper.x - 9.0;
    let stroke = Stroke::new(1.5, palette.warning);
    ui.painter().vline(x, upper.y..=lower.y, stroke);
    for y in [upper.y, lower.y] {
        ui.painter().hline(x - 3.0..=x + 3.0, y, stroke);
    }
}

/// Dims the frequencies outside the band: these are drawn but do not count.
fn outside_shade(plot: &mut PlotUi<'_>, (min, max): (f64, f64), palette: &Palette) {
    let veil = palette.background.gamma_multiply(0.4);
    for range in [f64::NEG_INFINITY..=min.log10(), max.log10()..=f64::INFINITY] {
        plot.span(Span::new("", range).fill(veil).border_width(0.0));
    }
}

/// Draws the curves, the most important on top. If a great many are at the bottom, these are drawn
/// as an image, and the curve under the pointer again as lines.
fn draw_curves<'a>(
    plot: &mut PlotUi<'a>,
    scene: &BodeScene<'_>,
    drawn: &'a DrawnCurves,
    image: Option<StillImage>,
    emphasis: &Emphasis,
    palette: &Palette,
) {
    let is_emphasized =
        |curve: &BodeCurve| curve.highlighted || emphasis.curve.as_ref() == Some(&curve.id);
    let mut curves: Vec<(usize, &BodeCurve)> = scene.curves.iter().enumerate().collect();
    if let Some(image) = image {
        let strength = if scene.stale { STALE } else { 1.0 };
        plot.add(DrawnItem::new(move |_, shapes| {
            shapes.push(image.shape(strength))
        }));
        curves.retain(|(_, curve)| !lies_at_the_bottom(curve) || is_emphasized(curve));
    }
    let is_raised = |curve: &BodeCurve| scene.raised == Some(curve.role.shown(curve.rejected));
    curves.sort_by_key(|(_, curve)| {
        (
            is_emphasized(curve),
            is_raised(curve),
            curve.role.layer(curve.rejected),
        )
    });
    for (index, curve) in curves {
        let mut look = palette.role_style(curve.role, curve.rejected);
        if is_emphasized(curve) {
            look = look.emphasized();
        } else if scene.stale {
            look.color = look.color.gamma_multiply(STALE);
        }
        plot.add(DrawnItem::new(move |transform, shapes| {
            curve_lines(drawn.runs(index), look, transform, shapes)
        }));
    }
}

/// Returns the image of the curves at the bottom, if there are a great many and they are static.
fn image_of_many(
    ctx: &Context,
    scene: &BodeScene<'_>,
    drawn: &DrawnCurves,
    image: &mut CachedRaster,
    transform: &PlotTransform,
    palette: &Palette,
) -> Option<StillImage> {
    let mut curves: Vec<_> = scene
        .curves
        .iter()
        .enumerate()
        .filter(|(_, curve)| lies_at_the_bottom(curve))
        .collect();
    if curves.len() < MANY {
        return None;
    }
    curves.sort_by_key(|(_, curve)| curve.role.layer(curve.rejected));
    let look = |curve: &BodeCurve| palette.role_style(curve.role, curve.rejected);
    let still = StillScene {
        frame: *transform.frame(),
        pixels_per_point: ctx.pixels_per_point(),
        curves: curves
            .iter()
            .map(|(index, curve)| (drawn.serial(*index), look(curve)))
            .collect(),
    };
    image.of(ctx, still, || {
        let mut shapes = Vec::new();
        curves.iter().for_each(|(index, curve)| {
            curve_lines(drawn.runs(*index), look(curve), transform, &mut shapes)
        });
        shapes
    })
}

/// Returns whether a curve is one of many that only show the spread of their bundle.
fn lies_at_the_bottom(curve: &BodeCurve) -> bool {
    curve.role.layer(curve.rejected) <= Role::Perturbed.layer(false)
}

fn draw_cursors<'a>(
    plot: &mut PlotUi<'_>,
    pinned: impl Iterator<Item = &'a f64>,
    cursor: Option<f64>,
    palette: &Palette,
) {
    for omega in pinned {
        plot.vline(
            VLine::new("", omega.log10())
                .color(palette.text.gamma_multiply(0.7))
                .width(1.0),
        );
    }
    if let Some(log_omega) = cursor {
        let color = palette.text.gamma_multiply(0.55);
        plot.vline(
            VLine::new("", log_omega)
                .color(color)
                .width(0.8)
                .style(LineStyle::Dotted { spacing: 4.0 }),
        );
    }
}

/// The wheel and pinching zoom about the pointer; the sideways wheel zooms only the frequency axis.
fn zoom_by_scrolling(ui: &Ui, pane: Pane, response: &Response, view: &mut BodeView) {
    if let Some((Turn { both, sideways }, pointer)) = turned(ui.ctx(), response) {
        view.zoom(
            pane,
            pointer,
            f64::from(both.x * sideways),
            f64::from(both.y),
        );
        ui.ctx().request_repaint();
    }
}

/// Half-width of the strip that grabs an end \[pt\].
const GRAB_RADIUS: f32 = 4.0;
/// Least ratio of the ends, so that the band is never empty.
const LEAST_RATIO: f64 = 1.05;

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

    /// Returns the band with this end at `omega`, limited by the other end.
    fn moved(self, band: (f64, f64), omega: f64) -> (f64, f64) {
        match self {
            Self::Lower => (omega.min(band.1 / LEAST_RATIO), band.1),
            Self::Upper => (band.0, omega.max(band.0 * LEAST_RATIO)),
        }
    }
}

/// Draws both ends of the band over a pane and makes them draggable.
pub(super) fn band_handles_ui(
    ui: &Ui,
    pane: Pane,
    scene: &BodeScene<'_>,
    view: &BodeView,
    palette: &Palette,
) -> Option<BodeEvent> {
    let transform = view.transform(pane)?;
    let place = scene.quantity.place(pane);
    let band = scene.band;
    let unit = scene.unit;
    let mut change = None;
    for end in [End::Lower, End::Upper] {
        let x = transform.position_from_point_x(end.of(band).log10());
        let frame = *transform.frame();
        if !x.is_finite() || !frame.x_range().contains(x) {
            continue;
        }
        let strip = Rect::from_x_y_ranges(x - GRAB_RADIUS..=x + GRAB_RADIUS, frame.y_range())
            .intersect(frame);
        let response = ui.interact(
            strip,
            ui.scope_id().with((place.as_str(), end.name())),
            Sense::drag(),
        );
        let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        response.widget_info(|| {
            WidgetInfo::slider(
                true,
                unit.of_omega(end.of(band)),
                format!("{}, {place}", end.name()),
            )
        });
        paint(ui, x, end, band, &response, (frame, unit, palette));
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let x = pointer.x.clamp(frame.left(), frame.right());
            let omega = 10f64.powf(transform.value_from_position(pos2(x, frame.center().y)).x);
            let (min, max) = end.moved(band, omega);
            change = Some(BodeEvent::BandDragged { min, max });
        } else if response.drag_stopped() {
            change = Some(BodeEvent::BandReleased);
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
    let stroke = if is_held {
        Stroke::new(2.0, palette.accent)
    } else {
        Stroke::new(1.0, palette.accent.gamma_multiply(0.65))
    };
    painter.vline(x, frame.y_range(), stroke);
    if !is_held {
        return;
    }
    let text = unit.readout(end.of(band));
    let galley = painter.layout_no_wrap(text, caption_font(), palette.text);
    // In the line above the plot, where it does not cover the curves.
    let size = galley.size() + vec2(10.0, 2.0);
    let left = (x - 0.5 * size.x).clamp(frame.left(), (frame.right() - size.x).max(frame.left()));
    let place = Rect::from_min_size(pos2(left, frame.top() - size.y - 2.0), size);
    let painter = ui.painter();
    painter.rect(
        place,
        3.0,
        palette.raised,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
    painter.galley(place.min + vec2(5.0, 1.0), galley, palette.text);
}

/// Draws the rules of a pane into a plot with this `transform`.
pub(super) fn rules_ui(
    ui: &Ui,
    rules: &[ReferenceLine],
    pane: Pane,
    transform: &PlotTransform,
    palette: &Palette,
) {
    let painter = ui.painter().with_clip_rect(transform.frame().shrink(1.0));
    let mut shapes = Vec::new();
    for rule in rules.iter().filter(|rule| rule.pane == pane) {
        palette
            .curve_style(rule.kind.line())
            .add_shapes(path(&rule.level, transform), &mut shapes);
    }
    painter.extend(shapes);
}

/// Returns the distance of the nearest rule of a pane from `pointer` \[pt\]; `None` if none is
/// near.
pub(super) fn distance_to_rules(
    rules: &[ReferenceLine],
    pane: Pane,
    pointer: egui::Pos2,
    transform: &PlotTransform,
) -> Option<f32> {
    let mut least: Option<f32> = None;
    for rule in rules.iter().filter(|rule| rule.pane == pane) {
        let points = rule
            .level
            .points(transform.bounds().min()[0], transform.bounds().max()[0]);
        if let Some((distance, _)) = distance_to(points.into_iter(), pointer, transform) {
            least = Some(least.map_or(distance, |known| known.min(distance)));
        }
    }
    least
}

/// Returns the labels of the rules of a pane, each at the height where its line leaves the plot,
/// with any further text below.
pub(super) fn rule_ends(
    rules: &[ReferenceLine],
    pane: Pane,
    transform: &PlotTransform,
    palette: &Palette,
) -> Vec<(f32, String, Color32)> {
    let frame = *transform.frame();
    let mut ends = Vec::new();
    for rule in rules.iter().filter(|rule| rule.pane == pane) {
        let path = path(&rule.level, transform);
        let Some(end) = path.iter().rev().find(|at| frame.contains(**at)) else {
            continue;
        };
        let color = palette.name_of(palette.curve_style(rule.kind.line()).color.to_opaque());
        ends.push((end.y, rule.label.clone(), color));
        let note = rule.note.trim_start_matches([',', ':', ' ']);
        ends.extend((!note.is_empty()).then(|| (end.y + 0.1, note.to_owned(), palette.dim_text)));
    }
    ends
}

fn path(level: &Level, transform: &PlotTransform) -> Vec<egui::Pos2> {
    let points = level.points(transform.bounds().min()[0], transform.bounds().max()[0]);
    let position = |[x, y]: [f64; 2]| transform.position_from_point(&PlotPoint::new(x, y));
    // Lines far outside the frame are skipped, because their many dashes would take time.
    let frame = transform.frame();
    let is_near = |at: &egui::Pos2| (at.y - frame.center().y).abs() < 2.0 * frame.height();
    points.into_iter().map(position).filter(is_near).collect()
}

/// Draws the frequencies of `ranges` \[rad/s\] as strips along the lower edge of a plot.
pub(super) fn strips_ui(
    ui: &Ui,
    ranges: &[(f64, f64)],
    transform: &PlotTransform,
    palette: &Palette,
) {
    let frame = *transform.frame();
    let x = |omega: f64| transform.position_from_point_x(omega.log10());
    for (from, to) in ranges {
        let strip = Rect::from_x_y_ranges(
            x(*from)..=x(*to),
            frame.bottom() - STRIP_HEIGHT..=frame.bottom(),
        );
        ui.painter().with_clip_rect(frame).rect_filled(
            strip.shrink2(vec2(0.0, 1.0)),
            0.0,
            palette.warning,
        );
    }
}

/// Height of a strip along the lower edge \[pt\].
const STRIP_HEIGHT: f32 = 5.0;

/// Draws the visible part of a band in a pane, in segments: non-finite values and jumps of a
/// wrapped phase leave a gap.
pub(super) fn draw_band(
    plot: &mut PlotUi<'_>,
    band: &BodeBand,
    pane: Pane,
    view: &PlotBounds,
    palette: &Palette,
) {
    let values = match pane {
        Pane::Magnitude => &band.magnitude_db,
        Pane::Phase => &band.phase_deg,
    };
    let points: Vec<[f64; 3]> = band
        .omega
        .iter()
        .zip(values)
        .map(|(omega, [lower, upper])| [omega.log10(), *lower, *upper])
        .collect();
    for run in points
        .chunk_by(|from, to| is_in_view(from, to, view))
        .filter(|run| run.len() > 1)
    {
        let column = |index: usize| run.iter().map(|point| point[index]).collect::<Vec<f64>>();
        let fill = palette.identified.gamma_multiply(0.22);
        plot.add(
            FilledArea::new("", &column(0), &column(1), &column(2))
                .fill_color(fill)
                .allow_hover(false),
        );
    }
}

/// Returns whether part of the band between two points, each a place with its lower and upper
/// value, is visible.
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
    fn an_end_never_passes_the_other() {
        assert_eq!(End::Lower.moved((0.5, 12.0), 2.0), (2.0, 12.0));
        assert_eq!(End::Upper.moved((0.5, 12.0), 2.0), (0.5, 2.0));
        let (min, max) = End::Lower.moved((0.5, 12.0), 40.0);
        assert!(min < max);
        let (min, max) = End::Upper.moved((0.5, 12.0), 0.1);
        assert!(min < max);
    }

    #[test]
    fn a_stretch_counts_where_it_reaches_into_the_view() {
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
